"""Invariant: a kind of medium that gives its extinction and a majorant is tracked, answered, planned, or refused by name.

sigma_t = density (1 + cos(2 pi z/period))/2: three files, found by their name; no table and no list of the package knows them.
"""

import importlib
import sys

import numpy as np
import pytest

from fogproof.analytic import transmittance, transmittance_lookups, transmittance_variance
from fogproof.capabilities import capabilities
from fogproof.checks import check_estimator, fresh_seed
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.estimators import Airlight, DeltaTransmittance, RatioTransmittance, RegularTransmittance
from fogproof.plan import plan
from fogproof.scene import PointLight, Ray, Scene
from fogproof.scene_estimator import estimator_for

FILES = {
    "scene": """
from dataclasses import dataclass, field
from fogproof.scene.media.common import channels_with, set_common
from fogproof.scene.phase import Isotropic

@dataclass(frozen=True, eq=False)
class Stripes:
    density: float
    period: float
    albedo: object = 0.0
    phase: object = field(default_factory=Isotropic)
    emission: object = 0.0

    def __post_init__(self):
        set_common(self)

    @property
    def channels(self):
        return channels_with(self)
""",
    "analytic": """
import numpy as np
from fogproof.analytic.media.coefficients import by_albedo

def coefficients(medium, at):
    sigma = medium.density * (1 + np.cos(2 * np.pi * at.x[..., 2] / medium.period)) / 2
    return by_albedo(sigma if len(at.shape) == sigma.ndim else sigma[..., None], medium.albedo, medium.emission)
""",
    "estimators": """
import numpy as np

def extinction(medium, x, w):
    return (medium.density * (1 + np.cos(2 * np.pi * x[:, 2] / medium.period)) / 2)[:, None]

def bounds(medium, origin, direction, length):
    return np.zeros(len(origin)), np.full(len(origin), medium.density)
""",
}
DENSITY, PERIOD, ALPHA = 1.5, 0.7, 1e-9
RAY, LIGHT = Ray((0.3, 0, -2), (0.6, 0, 0.8), 4.0), PointLight((1.0, 1.0, 0.0), 3.0)


@pytest.fixture(scope="module")
def medium(tmp_path_factory):
    """One of the new kind."""
    packages = {side: importlib.import_module(f"fogproof.{side}.media") for side in FILES}
    for side, text in FILES.items():
        folder = tmp_path_factory.mktemp(side)
        (folder / "stripes.py").write_text(text)
        packages[side].__path__.append(str(folder))
    yield importlib.import_module("fogproof.scene.media.stripes").Stripes(DENSITY, PERIOD, 0.8)
    for side, package in packages.items():
        package.__path__.pop()
        sys.modules.pop(f"fogproof.{side}.media.stripes", None)


def test_the_oracle_integrates_it(medium):
    ends = np.array([-2.0, -2.0 + 0.8 * 4.0])
    depth = np.diff(DENSITY / 2 * (ends + PERIOD / (2 * np.pi) * np.sin(2 * np.pi * ends / PERIOD)))[0] / 0.8
    found = transmittance(medium, RAY)
    assert abs(found.value - np.exp(-depth)) <= found.error + 1e-15
    assert found.error < 1e-12


@pytest.mark.parametrize(("kind", "tracking"), [(DeltaTransmittance, "delta"), (RatioTransmittance, "ratio")])
def test_it_is_tracked(medium, kind, tracking):
    check_estimator(
        kind(medium, RAY, 2.0).draw,
        transmittance(medium, RAY),
        variance=transmittance_variance(medium, RAY, tracking, 2.0),
        cost=transmittance_lookups(medium, RAY, tracking, 2.0),
        samples=30_000,
        alpha=ALPHA,
        seed=fresh_seed(),
    ).raise_if_rejected()
    with pytest.raises(InvalidValueError, match="majorant"):
        kind(medium, RAY, 0.3).draw(np.random.default_rng(1), 100)


def test_what_it_does_not_give_is_refused_where_it_is_planned(medium):
    lit = Scene(medium, RAY, "single", LIGHT)
    assert "how fine a Stripes is (feature_size) is not known" in capabilities(lit).refused
    for ask in (
        lambda: estimator_for(lit),
        lambda: Airlight(medium, RAY, LIGHT, "uniform", shadow_rays="ratio").draw(RNG, 9),
    ):
        with pytest.raises(UnsupportedError, match="how fine a Stripes is"):
            ask()
    with pytest.raises(UnsupportedError, match="needs a VoxelGrid"):
        RegularTransmittance(medium, RAY).draw(RNG, 9)
    fog = Scene(medium, RAY, "ambient", ambient=1.0, background=2.0)
    assert plan(fog).to_dict()["solver"]
    assert np.isfinite(estimator_for(fog).draw(RNG, 9).value).all()


RNG = np.random.default_rng(1)
