"""Evidence for what checks found in surfaces and warps: hair, masking, microfacets from below, the centre of a disk."""

from __future__ import annotations

import mpmath
import numpy as np
from findings_of_phases import sphere, uniforms, vector

from fogproof.adapters.mitsuba import MitsubaBSDF, MitsubaWarp, load
from fogproof.catalogue.mitsuba.builders import direction
from fogproof.domains import UnitDisk, UnitHemisphere, UnitSphere, UnitSquare


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
    told = f"Integral of pdf() by a product rule, at 50 degrees: {'; '.join(rows)}."
    return f"{told} The largest pdf() of the variant scalar_rgb at these directions is {scalar_pdf(below[::97]):g}."


def scalar_pdf(x: np.ndarray) -> float:
    """Return the largest density of roughplastic at directions (n, 3), one by one in a scalar variant."""
    mi = load()
    mi.set_variant("scalar_rgb")
    try:
        bsdf = mi.load_dict({"type": "roughplastic", "distribution": "ggx", "alpha": 0.4})
        surface, context = mi.SurfaceInteraction3f(), mi.BSDFContext()
        surface.wi = list(direction(50.0, 25.0))
        return max(float(bsdf.pdf(context, surface, list(wo))) for wo in x)
    finally:
        load()


def rim_of_visible_normals() -> str:
    """Sample visible GGX normals at one point of the rim, and by the paper's formula in double precision."""
    mi, rows = load(), []
    microfacets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, 0.3, True)
    for degrees in (10.0, 50.0, 80.0):
        wi = direction(degrees, 25.0)
        got, beside = (microfacets.sample(mi.Vector3f(wi), mi.Point2f(u, 0.5))[0] for u in (0.0, 1e-6))
        got, beside = (np.array(normal, dtype=float).reshape(3) for normal in (got, beside))
        rows.append(
            f"{degrees:g} degrees: {vector(got, 4)} there, {vector(beside, 4)} at u = (1e-6, 1/2), the paper's"
            f" {vector(visible_normal(np.array(wi), 0.3, (-1.0, 0.0)), 4)}"
        )
    warp = MitsubaWarp("square_to_uniform_disk_concentric", UnitDisk()).sample(np.array([[0.0, 0.5]]))[0]
    bsdf = MitsubaBSDF({"type": "roughconductor", "distribution": "ggx", "alpha": 0.3}, direction(50.0, 25.0))
    drawn = bsdf.sample(np.array([[0.5, 0.0, 0.5]], dtype=np.float32))
    assert drawn.weight is not None
    return (
        f"The concentric map takes u = (0, 1/2) to {vector(warp)}. Normals from there, and those of Heitz (2018, listing 1),"
        f" written anew in double precision: {'; '.join(rows)}. roughconductor then returns the direction {vector(drawn.x[0])}"
        f" with the weight {drawn.weight[0, 0]:g}."
    )


def visible_normal(wi: np.ndarray, alpha: float, disk: tuple[float, float]) -> np.ndarray:
    """Return the visible normal of Heitz (2018), "Sampling the GGX Distribution of Visible Normals", of a point of the disk."""
    v = wi * (alpha, alpha, 1)
    v /= np.linalg.norm(v)
    across = np.array((v[1], -v[0], 0.0)) / np.hypot(v[0], v[1])  # either sign will do: this one is Mitsuba's
    s = 0.5 * (1 + v[2])
    x, y = disk[0], (1 - s) * np.sqrt(max(1 - disk[0] ** 2, 0.0)) + s * disk[1]
    normal = x * across + y * np.cross(v, across) + np.sqrt(max(1 - x * x - y * y, 0.0)) * v
    normal *= (alpha, alpha, 1)
    return np.asarray(normal / np.linalg.norm(normal))


def centre() -> str:
    """Evaluate two warps at the centre of the square."""
    middle = np.full((1, 2), 0.5)
    square = MitsubaWarp("square_to_uniform_square_concentric", UnitSquare()).sample(middle)[0]
    beckmann = MitsubaWarp("square_to_beckmann", UnitHemisphere(), later=(0.3,)).sample(middle)[0]
    return f"At u = (1/2, 1/2) they return {vector(square)} and {vector(beckmann)}, and finite points all around."
