"""Invariant: what a scene does not use costs it nothing, or exactly as much as is said: random numbers and look-ups are counted."""

import numpy as np
import pytest

from fogproof.estimators import (
    AnalogFog,
    DeltaTransmittance,
    FreePath,
    HomogeneousSpectralFreePath,
    PathTracer,
    SpectralPathTracer,
)
from fogproof.scene import Ball, CompositeMedium, Medium, PointLight, Ray, Scene, VoxelGrid
from fogproof.scene.lights import Environment
from fogproof.scene_estimator import estimator_for

N = 300
ALONG = Ray((0.0, 0.0, 0.0), (0.0, 0.0, 1.0), 2.0)
LAMP = PointLight((0.4, 0.9, 1.1), 3.0)
BALL, ASIDE, ABOVE = (
    Ball((0.0, 0.0, 0.0), 1.0),
    Ray((0.3, 0.0, 3.0), (0.0, 0.0, -1.0)),
    PointLight((0.0, 2.0, 0.5), 3.0),
)


@pytest.fixture
def counted():
    """Return a function: what an estimator draws, and how many 64-bit words of the generator it took, from one seed a test."""
    seed = int(np.random.SeedSequence().generate_state(1)[0])

    def draw(estimator, n=N):
        rng, ahead = np.random.Generator(np.random.PCG64(seed)), np.random.PCG64(seed)
        drawn = estimator.draw(rng, n)
        words = 0
        while ahead.state["state"] != rng.bit_generator.state["state"]:
            ahead.random_raw()
            words += 1
            assert words < 10**7
        return drawn, words

    return draw


def paths(medium, **options):
    return PathTracer(medium, BALL, ASIDE, ABOVE, **options)


@pytest.mark.parametrize(
    "with_emission",
    [
        lambda **x: AnalogFog(Medium(0.5, 0.3, **x), ALONG, 0.5, 1.0),
        lambda **x: estimator_for(Scene(Medium(0.5, 0.3, **x), ALONG, "single", LAMP)),
        lambda **x: paths(Medium(0.5, 4.5, **x)),
    ],
    ids=["fog", "single", "paths"],
)
def test_emission_that_is_0_is_no_emission(counted, with_emission):
    (none, words), (zero, again) = counted(with_emission()), counted(with_emission(emission=0.0))
    assert np.array_equal(none.value, zero.value)
    assert np.array_equal(none.cost, zero.cost)
    assert words == again
    glowing, more = counted(with_emission(emission=1.0))
    assert more == words, "it is looked up where the path is anyway"
    assert not np.array_equal(glowing.value, none.value)


def test_what_is_not_random_draws_nothing(counted):
    for scene in (
        Scene(Medium(0.5, 0.0), ALONG, background=1.0),
        Scene(Medium(0.5, 0.3, emission=0.7), ALONG, background=1.0),
        Scene(Medium(0.5, 0.3), ALONG, "ambient", ambient=0.5, background=1.0),
    ):
        drawn, words = counted(estimator_for(scene))
        assert words == 0
        assert np.ptp(drawn.value) == 0
        assert np.all(drawn.cost == 1)


def test_single_scattering_draws_one_number_and_looks_twice(counted):
    without, words = counted(estimator_for(Scene(Medium(0.5, 0.3), ALONG, "single", LAMP)))
    assert words == N
    both, again = counted(estimator_for(Scene(Medium(0.5, 0.3), ALONG, "single", LAMP, background=1.0)))
    assert again == N, "the background is attenuated in closed form"
    assert np.all(both.cost - without.cost == 1)


def test_orders_that_are_not_followed_draw_nothing(counted):
    """To the last order wanted a path flies, and looks for the lamp; it draws no direction that leads nowhere."""
    drawn = {deepest: counted(paths(Medium(0.5, 4.5), deepest=deepest, roulette=None)) for deepest in (0, 1, 2)}
    words = {deepest: count / N for deepest, (_, count) in drawn.items()}
    assert 1.0 <= words[0] < 1.2, "one exponential deviate, which takes more than a word now and then"
    assert words[1] == words[0]
    assert words[2] < words[1] + 4.5
    assert np.all(drawn[0][0].cost == 1)
    assert np.all(drawn[1][0].cost <= 2)


def test_paths_go_on_after_the_last_order_where_there_is_light_to_meet(counted):
    """Emission, a wall or a sky may be met behind it: their light is there, at its own price."""
    several = CompositeMedium((Medium(0.5, 4.5, emission=1.0),), (BALL,))
    for more in ({"medium": Medium(0.5, 4.5, emission=1.0)}, {"medium": several}, {"light": Environment(1.0)}):
        given = {"medium": Medium(0.5, 4.5), "light": ABOVE, **more}
        once, words = counted(PathTracer(given["medium"], BALL, ASIDE, given["light"], deepest=1, roulette=None))
        assert words > 3 * N
        assert np.mean(once.cost) > 2


def test_columns_and_roulette_far_away_change_no_path(counted):
    plain, words = counted(paths(Medium(0.5, 4.5), roulette=None))
    split, again = counted(paths(Medium(0.5, 4.5), roulette=None, columns=8))
    assert words == again
    assert np.array_equal(plain.cost, split.cost)
    assert np.allclose(split.value.sum(axis=1), plain.value, rtol=1e-14)


def test_three_equal_channels_are_one_path(counted):
    grey, _ = counted(paths(Medium(0.5, 4.5)), 1500)
    three, _ = counted(SpectralPathTracer(Medium((0.5,) * 3, (4.5,) * 3), BALL, ASIDE, ABOVE), 1500)
    assert np.ptp(three.value, axis=1).max() == 0
    spread = np.hypot(grey.cost.std(), three.cost.std()) / np.sqrt(1500)
    assert abs(grey.cost.mean() - three.cost.mean()) < 6 * spread, "no look-up for each channel"
    one, two = FreePath(0.8).dimensions, HomogeneousSpectralFreePath((0.8,) * 3).dimensions
    assert (one, two) == (1, 2), "the second chooses the channel"


def test_a_scene_of_three_channels_costs_three_of_one(counted):
    """Each channel has an estimator of its own: that is the factor."""
    grey, words = counted(estimator_for(Scene(Medium(0.5, 0.3), ALONG, "single", LAMP)))
    three, thrice = counted(
        estimator_for(
            Scene(Medium((0.5,) * 3, (0.3,) * 3), ALONG, "single", PointLight((0.4, 0.9, 1.1), (3.0, 3.0, 3.0)))
        )
    )
    assert thrice == 3 * words
    assert np.array_equal(three.cost, 3 * grey.cost)


def test_a_constant_grid_under_its_majorant_collides_for_real_each_time(counted):
    """The majorant is the extinction: no fictitious collision, so that a path looks once if it collides and never if not."""
    grid = VoxelGrid(np.full((4, 4, 4), 1.5), (-2, -2, -2), (2, 2, 2), "nearest")
    drawn, words = counted(DeltaTransmittance(grid, ALONG), 1500)
    collided = drawn.value == 0
    assert np.all(drawn.cost[collided] == 1)
    assert np.all(drawn.cost[~collided] == 0)
    assert abs(np.mean(~collided) - np.exp(-3.0)) < 6 * np.sqrt(np.exp(-3.0) / 1500)
    assert words < 1500 * 2.2
