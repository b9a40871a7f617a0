"""Write docs/findings.md: what the checks found in Mitsuba 3, each with evidence that does not come from a check.

    python tools/findings.py            # needs fogproof[mitsuba] and mpmath; a few minutes

Every number of the page is computed here, by quadrature, by mpmath, or from the paper's formula; the checks only pointed there.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import mpmath
import numpy as np
from findings_of_volumes import missing_thickness

from fogproof.adapters.mitsuba import MitsubaBSDF, MitsubaPhase, MitsubaWarp, load
from fogproof.catalogue.mitsuba.builders import direction
from fogproof.catalogue.mitsuba.phases import sggx, sggx_plugin
from fogproof.domains import UnitHemisphere, UnitSphere, UnitSquare

PAGE = Path(__file__).resolve().parents[1] / "docs" / "findings.md"
SEED = 20


@dataclass(frozen=True)
class Found:
    """One finding: what is wrong and how much, the evidence as a function that measures it, the likely cause, and the command."""

    title: str
    what: str
    evidence: Callable[[], str]
    cause: str
    command: str


def sphere(mu_points: int = 400, phi_points: int = 400, low: float = -1.0) -> tuple[np.ndarray, np.ndarray]:
    """Return directions and weights of a product rule, Gauss-Legendre in mu on [low, 1], midpoints in phi."""
    mu, weight = np.polynomial.legendre.leggauss(mu_points)
    mu, weight = low + (mu + 1) * (1 - low) / 2, weight * (1 - low) / 2
    phi = (np.arange(phi_points) + 0.5) * 2 * np.pi / phi_points
    sine = np.sqrt(1 - mu[:, None] ** 2)
    x = np.stack(np.broadcast_arrays(sine * np.cos(phi), sine * np.sin(phi), mu[:, None]), -1).reshape(-1, 3)
    return x, np.repeat(weight, phi_points) * 2 * np.pi / phi_points


def uniforms(n: int, k: int) -> np.ndarray:
    """Return (n, k) single-precision uniforms."""
    return np.random.default_rng(SEED).random((n, k), dtype=np.float32)


def frame_of_sggx() -> str:
    """Compare the mean sampled direction with that of the paper's density."""
    flake, axis = (1.0, 0.6, 0.3, 0.2, 0.1, -0.15), (2 / 7, -3 / 7, 6 / 7)
    x, weight = sphere()
    density = sggx(flake, axis)(x + 1e-12).value
    exact = (weight * density) @ x
    drawn = MitsubaPhase(sggx_plugin(flake), axis).sample(uniforms(1_000_000, 3)).x
    z = (drawn.mean(0) - exact) / (drawn.std(0) / 1000)
    pdf = MitsubaPhase(sggx_plugin(flake), axis).pdf(x)
    return (
        f"The density of Heitz et al. (2015), written anew, integrates to {weight @ density:.5f} and agrees with `eval_pdf` to"
        f" {np.max(np.abs(pdf / density - 1)):.1g}. Its mean direction is {vector(exact)}; that of 10^6 samples is"
        f" {vector(drawn.mean(0))}, off by {vector(z, 0)} standard errors."
    )


def ahead_of_sggx() -> str:
    """Ask for the density exactly straight ahead."""
    phase = MitsubaPhase(sggx_plugin((1.0, 1.0, 0.1, 0.0, 0.0, 0.0)))
    ahead, beside = phase.pdf(np.array([[0.0, 0.0, 1.0], [1e-3, 0.0, 1.0]]))
    return (
        f"`eval_pdf` is {ahead:g} at wo = -wi and {beside:.4g} at an angle of 0.001; `sample` returns such directions."
    )


def spike_of_hair() -> str:
    """Count samples whose azimuth is 0 exactly."""
    wi = np.array((0.9, 0.1, 0.3)) / np.linalg.norm((0.9, 0.1, 0.3))
    hair = MitsubaBSDF({"type": "hair"}, tuple(wi.tolist()))
    draw = hair.sample(uniforms(2_000_000, 3))
    exactly = np.abs(np.arctan2(draw.x[:, 1], draw.x[:, 0])) < 1e-6
    x, weight = sphere(2000, 4)
    mu = x[::4, 2]
    sine = np.sqrt(1 - mu * mu)
    band = 2e-6 * float(np.sum(weight[::4] * 4 / (2 * np.pi) * hair.pdf(np.stack([sine, 0 * mu, mu], -1))))
    return f"Of 2 10^6 samples {np.count_nonzero(exactly)} have |azimuth| < 1e-6; the pdf's mass there is {band:.1g}."


def fiber() -> str:
    """Compare the warp's integral with mpmath's, with the true Bessel function and with a term halved."""
    rows = []
    for kappa in (20.0, 200.0):
        warp = MitsubaWarp(
            "square_to_rough_fiber", UnitSphere(), later=((0.6, 0.0, 0.8), (1.0, 0.0, 0.0), kappa), dimensions=3
        )
        x, weight = sphere(600, 600)
        true, halved = (fiber_integral(kappa, bad) for bad in (False, True))
        rows.append(
            f"kappa = {kappa:g}: {weight @ warp.pdf(x):.5f}, true {true:.6f}, with the term halved {halved:.5f}"
        )
    return f"Integral of the pdf, by a product rule, and by mpmath over the latitude: {'; '.join(rows)}."


def fiber_integral(kappa: float, halved: bool) -> float:
    """Return the integral of the longitudinal scattering function of d'Eon et al. (2011), by mpmath."""
    across, along = mpmath.mpf("0.8"), mpmath.mpf("0.6")

    def value(theta: mpmath.mpf) -> mpmath.mpf:
        x = kappa * across * mpmath.cos(theta)
        bessel = mpmath.besseli(0, x)
        if halved and x > 12:
            bessel = mpmath.exp(x + (-mpmath.log(2 * mpmath.pi * x) + 1 / (8 * x)) / 2)
        return (
            kappa
            / (2 * mpmath.sinh(kappa))
            * mpmath.exp(-kappa * along * mpmath.sin(theta))
            * bessel
            * mpmath.cos(theta)
        )

    cuts = np.linspace(-np.pi / 2, np.pi / 2, 41).tolist()
    return float(mpmath.quad(value, cuts))


def masking() -> str:
    """Compare integral over share of valid samples with the ratio of the two masking functions."""
    rows = []
    for degrees, alpha in ((80.0, 0.3), (50.0, 0.7), (80.0, 0.7)):
        plugin = {"type": "roughconductor", "distribution": "beckmann", "alpha": alpha}
        bsdf = MitsubaBSDF(plugin, direction(degrees, 25.0))
        x, weight = sphere(400, 400, 0.0)
        n = 4_000_000
        valid = float(np.mean(bsdf.sample(uniforms(n, 3)).valid))
        a = 1 / (mpmath.mpf(alpha) * mpmath.tan(mpmath.radians(degrees)))
        exact = 1 / (1 + (mpmath.erf(a) - 1) / 2 + mpmath.exp(-a * a) / (2 * a * mpmath.sqrt(mpmath.pi)))
        walter = (3.535 * a + 2.181 * a**2) / (1 + 2.276 * a + 2.577 * a**2) if a < 1.6 else mpmath.mpf(1)
        error = np.sqrt((1 - valid) / valid / n)
        measured = float(weight @ bsdf.pdf(x)) / valid
        rows.append(
            f"{degrees:g} degrees, alpha {alpha:g}: {measured:.5f} +- {error:.5f}, predicted {float(walter / exact):.5f}"
        )
    return (
        "Integral of the pdf over the share of valid samples, and the ratio of Walter et al.'s rational approximation to the exact"
        f" masking function (mpmath): {'; '.join(rows)}."
    )


def widened() -> str:
    """Compare eval / pdf / weight where the microfacet is the surface with the squared factor of widening."""
    rows = []
    for degrees in (50.0, 80.0):
        plugin = {
            "type": "roughdielectric",
            "distribution": "ggx",
            "alpha": 0.4,
            "sample_visible": False,
            "int_ior": 1.5,
        }
        bsdf = MitsubaBSDF(plugin, direction(degrees, 25.0))
        draw = bsdf.sample(np.array([[0.0, 0.0, 0.0], [0.999, 0.0, 0.0]], dtype=np.float32))
        assert draw.weight is not None
        ratio = bsdf.eval(draw.x)[:, 0] / bsdf.pdf(draw.x) / draw.weight[:, 0]
        predicted = (1.2 - 0.2 * np.sqrt(np.cos(np.radians(degrees)))) ** 2
        rows.append(
            f"{degrees:g} degrees: {ratio[0]:.4f} reflected, {ratio[1]:.4f} refracted, predicted {predicted:.4f}"
        )
    return (
        "eval / pdf over the weight that `sample` returns, at u = 0 where the microfacet is the surface, and"
        f" (1.2 - 0.2 sqrt(cos theta))^2, by which D exceeds its widened copy there: {'; '.join(rows)}."
    )


def underground() -> str:
    """Integrate the density of roughplastic below the surface."""
    rows = []
    for distribution in ("beckmann", "ggx"):
        bsdf = MitsubaBSDF({"type": "roughplastic", "distribution": distribution, "alpha": 0.4}, direction(50.0, 25.0))
        x, weight = sphere(400, 400, 0.0)
        below = x * (1, 1, -1)
        drawn = bsdf.sample(uniforms(1_000_000, 3))
        wrong = np.count_nonzero(drawn.x[drawn.valid, 2] < 0)
        rows.append(
            f"{distribution}: {weight @ bsdf.pdf(x):.4f} above and {weight @ bsdf.pdf(below):.4f} below the surface,"
            f" where {wrong} of 10^6 samples fall and eval is {np.max(bsdf.eval(below)):g}"
        )
    return f"Integral of pdf() by a product rule, at 50 degrees: {'; '.join(rows)}."


def centre() -> str:
    """Evaluate two warps at the centre of the square."""
    middle = np.full((1, 2), 0.5)
    square = MitsubaWarp("square_to_uniform_square_concentric", UnitSquare()).sample(middle)[0]
    beckmann = MitsubaWarp("square_to_beckmann", UnitHemisphere(), later=(0.3,)).sample(middle)[0]
    return f"At u = (1/2, 1/2) they return {vector(square)} and {vector(beckmann)}, and finite points all around."


def vector(x: np.ndarray, digits: int = 4) -> str:
    """Return a vector in words."""
    return f"({', '.join(f'{float(c):.{digits}f}' for c in x)})"


FINDINGS = (
    Found(
        "sggx samples in a transposed frame",
        "Sampled directions do not follow the density unless the incident direction is an axis of S.",
        frame_of_sggx,
        "the rows of the frame about wi are used as its columns",
        "fogproof verify mitsuba/phase/sggx",
    ),
    Found(
        "sggx has no density straight ahead",
        "NaN where wo = -wi.",
        ahead_of_sggx,
        "the half-way vector (0, 0, 0) is normalised",
        "fogproof verify mitsuba/phase/sggx/plate/axis-0",
    ),
    Found(
        "hair: a spike at azimuth 0",
        "One sample in about 1200 falls on a single azimuth, which has no mass.",
        spike_of_hair,
        "the inverse of the trimmed logistic distribution leaves its range, is clipped, or the rest of sample1 is used up",
        "fogproof verify mitsuba/bsdf/hair/spike",
    ),
    Found(
        "rough_fiber is not normalised",
        "The pdf integrates to 0.996 and 0.9995 where it should to 1, for arguments of I0 above 12.",
        fiber,
        "log I0(x) ~ x - log(2 pi x)/2 + 1/(8x): the factor 1/2 stands before the last term too, as in pbrt, which"
        " explains most of it",
        "fogproof verify 'mitsuba/warp/rough_fiber*'",
    ),
    Found(
        "Beckmann microfacets: pdf and samples differ by 0.1 to 0.3 %",
        "roughconductor and roughdielectric with Beckmann's distribution and sample_visible: the integral of the pdf is not the"
        " share of samples that succeed.",
        masking,
        "the pdf has the rational approximation of Smith's masking function (Walter et al. 2007, error up to 0.35 %), the sampled"
        " visible normals follow the exact one",
        "fogproof verify mitsuba/bsdf/roughconductor/masking",
    ),
    Found(
        "roughdielectric without sample_visible: wrong weights",
        "Weights are off by D / D_widened, a quarter at 80 degrees of incidence: biased renders, not only noise.",
        widened,
        "sample() draws from a widened distribution (alpha times 1.2 - 0.2 sqrt(cos)), pdf() knows it, and the weight lacks"
        " D / D_widened",
        "fogproof verify 'mitsuba/bsdf/roughdielectric/*/whole/*'",
    ),
    Found(
        "roughplastic has a density below the surface",
        "pdf() is positive where no sample falls and eval() is 0: MIS weights with it are too small.",
        underground,
        "pdf() does not look at the sign of cos(theta_o)",
        "fogproof verify 'mitsuba/bsdf/roughplastic/*'",
    ),
    Found(
        "warps without a centre",
        "square_to_uniform_square_concentric and square_to_beckmann give NaN at one point.",
        centre,
        "0 / 0 in the polar coordinates of the concentric map's centre",
        "fogproof verify mitsuba/warp/uniform_square_concentric 'mitsuba/warp/beckmann/*'",
    ),
    Found(
        "media are thinner far from the origin, and where they are small",
        "A ray that enters a medium starts 9e-5 m times 1 + the largest coordinate inside it, and nothing attenuates before: 4.5 cm"
        " at 500 m, and 4.5 % of a slab of 2 mm. Ball, slab and voxel grid show it.",
        missing_thickness,
        "offset_p, which keeps a spawned ray off its own surface, moves the start of the segment in the medium as well",
        "fogproof relations scenes/images/absorbing-slab.toml --with mitsuba --only 'moved/*' --only 'scaled/*' -o build/relations",
    ),
)


def main() -> int:
    """Measure everything and write the page."""
    version = load().__version__
    lines = [
        "# What the checks found in Mitsuba 3",
        "",
        f"Mitsuba {version}, variant {load().variant()}. Written by `python tools/findings.py`, which measures every number below"
        " without the checks that pointed there: by quadrature, by mpmath, or from the paper's formula.",
    ]
    for found in FINDINGS:
        print(found.title, file=sys.stderr, flush=True)
        evidence = found.evidence()
        lines += [
            "",
            f"## {found.title}",
            "",
            found.what,
            "",
            f"* Evidence: {evidence}",
            f"* Suspected cause: {found.cause}.",
        ]
        lines += [f"* To repeat: `{found.command}`"]
    PAGE.write_text("\n".join(lines) + "\n")
    return 0


if __name__ == "__main__":
    sys.exit(main())
