"""Random walks through layers over grounds of every kind, against adding and doubling."""

from __future__ import annotations

import numpy as np

from fogproof import analytic
from fogproof.catalogue.cases import EstimatorCase
from fogproof.catalogue.multiple.builders import paths_case
from fogproof.contracts import Reference
from fogproof.estimators import LayeredWalks
from fogproof.scene import HenyeyGreenstein, LambertGround, LommelSeeligerGround, MinnaertGround, Rayleigh, SlabLayer
from fogproof.scene.grounds import Ground

HAZE, AIR = SlabLayer(0.5, 0.99, HenyeyGreenstein(0.4)), SlabLayer(1.0, 0.7, Rayleigh())
LAYERS = (HAZE, AIR)
SUN, VIEW = 0.5, (0.7, 1.0)
SOURCE = "van de Hulst 1980, Multiple Light Scattering, section 4.3"
SNOW = LambertGround(0.8)
REGOLITH = LommelSeeligerGround(0.95, HenyeyGreenstein(-0.3))
DESERT = MinnaertGround(0.8, 2.5)


def _all_of_it(ground: Ground | None) -> Reference:
    """What comes back, what arrives below, and the BRDF towards the eye."""
    parts = [
        analytic.layered_reflectance(LAYERS, SUN, ground),
        analytic.layered_transmittance(LAYERS, SUN, ground),
        analytic.layered_brdf(LAYERS, SUN, *VIEW, ground),
    ]
    value, error = (np.array([float(getattr(part, name)) for part in parts]) for name in ("value", "error"))
    return Reference(value, error, parts[0].method, parts[0].source)


def cases() -> list[EstimatorCase]:
    """Return the cases of layers."""
    oracle = "layered_reflectance, layered_transmittance, layered_brdf"
    return [
        paths_case(
            name="layers/no-ground",
            title="Haze above air",
            make=lambda: LayeredWalks(LAYERS, SUN, None, VIEW),
            reference=lambda: _all_of_it(None),
            oracle=oracle,
            error="the lower layer is the uppermost",
            twin=lambda: LayeredWalks((AIR, HAZE), SUN, None, VIEW),
            source=SOURCE,
        ),
        paths_case(
            name="layers/snow",
            title="Haze above air above snow",
            make=lambda: LayeredWalks(LAYERS, SUN, SNOW, VIEW),
            reference=lambda: _all_of_it(SNOW),
            oracle=oracle,
            error="an albedo of 0.7 instead of 0.8",
            twin=lambda: LayeredWalks(LAYERS, SUN, LambertGround(0.7), VIEW),
            source=SOURCE,
        ),
        paths_case(
            name="layers/desert",
            title="Haze above air above a ground that is darker at grazing angles",
            make=lambda: LayeredWalks(LAYERS, SUN, DESERT, VIEW),
            reference=lambda: _all_of_it(DESERT),
            oracle=oracle,
            error="Minnaert's exponent is taken for Lambert's",
            twin=lambda: LayeredWalks(LAYERS, SUN, MinnaertGround(0.8, 1.0), VIEW),
            source="Minnaert 1941",
        ),
        paths_case(
            name="layers/regolith",
            title="Haze above air above grains that scatter backwards",
            make=lambda: LayeredWalks(LAYERS, SUN, REGOLITH, VIEW),
            reference=lambda: _all_of_it(REGOLITH),
            oracle=oracle,
            error="the sign of the grains' scattering cosine",
            twin=lambda: LayeredWalks(LAYERS, SUN, LommelSeeligerGround(0.95, HenyeyGreenstein(0.3)), VIEW),
            source="Seeliger 1884; Hapke 2012",
        ),
    ]
