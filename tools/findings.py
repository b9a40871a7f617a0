"""Write docs/findings.md: what the checks found in Mitsuba 3, each with evidence that does not come from a check.

    python tools/findings.py            # needs fogproof[mitsuba] and mpmath; a few minutes

Every number of the page is computed here, by quadrature, by mpmath, or from the paper's formula; the checks only pointed there.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from findings_of_phases import ahead_of_sggx, frame_of_sggx
from findings_of_surfaces import centre, fiber, masking, rim_of_visible_normals, spike_of_hair, underground, widened
from findings_of_volumes import missing_thickness

from fogproof.adapters.mitsuba import load

PAGE = Path(__file__).resolve().parents[1] / "docs" / "findings.md"


@dataclass(frozen=True)
class Found:
    """One finding: what is wrong and how much, the evidence as a function that measures it, the likely cause, and the command."""

    title: str
    what: str
    evidence: Callable[[], str]
    cause: str
    command: str


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
        "pdf() tests the sign of cos(theta_o), but only the scalar variants return 0 for it: the others do not mask",
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
        "visible GGX normals are NaN at one point of the rim",
        "MicrofacetDistribution with GGX and sample_visible gives NaN at u = (0, 1/2), whatever the incidence. The surfaces that"
        " use it return a weight of 0 and a direction of NaN.",
        rim_of_visible_normals,
        "the point of the disk has z = 0, and the slope is divided by sin(theta) y + cos(theta) z = 0",
        "python tools/findings.py",
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
