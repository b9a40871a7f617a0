"""Path tracers at the extremes: what they cut off they say, and neither batches nor workers change a bit."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from path_scenes import (
    ABOVE,
    ALPHA,
    ASIDE,
    BALL,
    BLACK,
    COLOURS,
    FOG,
    SKY,
    SLAB,
    unit,
)

from fogproof.analytic import (
    slab_reflectance,
)
from fogproof.checks import fresh_seed
from fogproof.estimators import (
    PathTracer,
    Roulette,
    SpectralPathTracer,
)
from fogproof.scene import (
    HenyeyGreenstein,
    Medium,
)
from fogproof.scene.lights import PointLight
from fogproof.scene.shapes import Ball
from fogproof.verify import run, select

ALBEDO = 1 - 1e-9
EXTREMES = {
    "albedo": st.sampled_from([0.0, ALBEDO, 1.0]) | st.floats(0, 1),
    "tau": st.sampled_from([1e-6, 1e4]) | st.floats(-6, 4).map(lambda x: 10.0**x),
    "g": st.sampled_from([0.0, 0.99, -0.99]) | st.floats(-0.99, 0.99),
    "index": st.sampled_from([0.7, 1.0, 1.5, 2.5]),
}


@given(**EXTREMES)
@settings(max_examples=60, deadline=None)
def test_at_extremes_each_path_and_what_was_cut_of_it_make_the_furnace_whole(albedo, tau, g, index):
    medium = Medium(tau * (1 - albedo), tau * albedo, HenyeyGreenstein(g), emission=1.0)
    tracer = PathTracer(
        medium, SLAB, ABOVE, SKY, light_sampling="bsdf", refractive_index=index, roulette=None, events=2000
    )
    paths = tracer.paths(np.random.default_rng(fresh_seed()), 50)
    assert np.abs(paths.value[:, 0] + paths.cut - 1).max() <= 1e-11


@given(**EXTREMES)
@settings(max_examples=20, deadline=None)
def test_extremes_with_everything_else_stay_finite(albedo, tau, g, index):
    medium = Medium(tau * (1 - albedo), tau * albedo, HenyeyGreenstein(g), emission=1.0)
    rng = np.random.default_rng(fresh_seed())
    for how in ({"refractive_index": index}, {"light_sampling": "mis"}, {"light_sampling": "nee"}):
        paths = PathTracer(medium, SLAB, ABOVE, SKY, BLACK, **how, events=2000).paths(rng, 30)
        assert np.isfinite(paths.value).all()
        assert paths.value.min() >= 0
        assert np.isfinite(paths.cut).all()


HARD = {  # albedo, tau, g, refractive index, paths, events
    "thin": (ALBEDO, 1e-3, 0.0, 1.0, 1_000_000, 1000),
    "thin glass": (ALBEDO, 1e-6, 0.0, 1.5, 200_000, 1000),
    "forward": (ALBEDO, 100.0, 0.99, 1.0, 5_000, 10_000),
    "backward": (0.9, 100.0, -0.99, 1.0, 50_000, 10_000),
    "backward, nothing absorbed": (ALBEDO, 100.0, -0.99, 1.0, 50_000, 10_000),
    "thick": (ALBEDO, 1e4, 0.0, 1.0, 50_000, 10_000),
    "thick glass": (ALBEDO, 1e4, 0.0, 1.5, 50_000, 10_000),
    "thick, forward": (ALBEDO, 1e3, 0.99, 1.0, 10_000, 10_000),
}


@pytest.mark.parametrize("name", HARD)
def test_hard_slabs_are_unbiased_but_for_what_is_cut(name):
    """Values lie in [0, 1]: the bounds are Maurer & Pontil's (2009), which hold for every law."""
    albedo, tau, g, index, n, events = HARD[name]
    medium = Medium(tau * (1 - albedo), tau * albedo, HenyeyGreenstein(g))
    tracer = PathTracer(medium, SLAB, ABOVE, SKY, BLACK, "bsdf", refractive_index=index, roulette=None, events=events)
    seed = fresh_seed()
    paths = tracer.paths(np.random.default_rng(seed), n)
    exact = slab_reflectance(albedo, tau, 0.5, HenyeyGreenstein(g) if g else None, index)
    low, high = paths.value[:, 0], paths.value[:, 0] + paths.cut
    assert high.max() <= 1 + 1e-12
    assert low.mean() - reach(low) <= exact.value + exact.error, f"seed {seed}"
    assert high.mean() + reach(high) >= exact.value - exact.error, f"seed {seed}"


def reach(x):
    """How far the mean of numbers in [0, 1] may lie from its expectation, but for ALPHA."""
    log = np.log(2 / ALPHA)
    return np.sqrt(2 * x.var(ddof=1) * log / len(x)) + 7 * log / (3 * (len(x) - 1))


def test_survivors_of_the_roulette_weigh_that_much_more():
    tracer = PathTracer(unit(), BALL, ASIDE, SKY, light_sampling="bsdf", roulette=Roulette(1, 0.5))
    value, _, scatterings, _ = tracer.paths(np.random.default_rng(5), 5000)
    left = value[:, 0] > 0
    assert np.array_equal(value[left, 0], 2.0 ** scatterings[left])
    assert 0 < left.mean() < 1


def test_what_is_cut_is_told():
    tracer = PathTracer(unit(), Ball((0, 0, 0), 3.0), ASIDE, SKY, light_sampling="bsdf", roulette=None, events=5)
    paths = tracer.paths(np.random.default_rng(5), 20_000)
    assert set(np.unique(paths.cut)) == {0.0, 1.0}
    # Cut paths would have seen the furnace's 1 as well: value and cut make it whole.
    assert np.all(paths.value[:, 0] + paths.cut == 1)
    assert paths.scatterings.max() == 5


def test_batches_do_not_prefer_short_paths():
    """What a path is worth depends on the paths before it alone: neither on how many follow, nor on which end first."""
    for tracer in (
        PathTracer(FOG, SLAB, ABOVE, SKY, BLACK, "bsdf", roulette=None),
        PathTracer(FOG, BALL, ASIDE, PointLight((0, 2, 0), 1.0), columns=4),
        SpectralPathTracer(COLOURS, SLAB, ABOVE, SKY, BLACK),
    ):
        few, many = (tracer.paths(np.random.default_rng(9), n) for n in (1000, 5000))
        for part, whole in zip(few, many, strict=True):
            assert np.array_equal(part, whole[:1000])


def test_workers_do_not_change_a_bit():
    cases = select(["paths/slab/met", "paths/slab/colours", "paths/box/voxels", "paths/walks"])
    one, two = (
        {r.case.name: r.verdict.to_dict()["findings"] for r in run(cases, seed=9, alpha=1e-6, workers=n)}
        for n in (1, 2)
    )
    assert one == two
    assert len(one) == len(cases)
