"""Causes that sounded sure and were not so: samples of no volume, cones, clamps amid an axis, factors, lost samples, tables."""

import numpy as np
import pytest
from laws_by_hand import TURN, about, even

from fogproof import Discrete, Draw, HalfLine, Interval, Rotations, UnitSphere, UnitSquare, check_sampler
from fogproof.checks.diagnosis import directions, frames, holes
from fogproof.checks.diagnosis.explaining import setting_of
from fogproof.checks.diagnosis.half_vectors import hypotheses as half_vectors
from fogproof.checks.diagnosis.shape import unexplained
from fogproof.checks.subject import Subject

N = 60_000


def verdict_of(sample, pdf, domain, dimensions=None, samples=N, **options):
    verdict = check_sampler(sample, pdf, domain, dimensions=dimensions, samples=samples, **options)
    assert verdict.outcome == "rejected", str(verdict)
    return verdict


def about_x(rng, n):
    """Rotations about the x axis alone, as quaternions (x, y, z, w)."""
    half = np.pi * rng.random(n)
    return np.stack([np.sin(half), 0 * half, 0 * half, np.cos(half)], axis=-1)


def on_a_circle(rng, n):
    return about(np.full(n, 0.6), TURN * rng.random(n)) @ np.array([[0.6, 0, 0.8], [0, 1, 0], [-0.8, 0, 0.6]])


FLAT = {
    "rotations about one axis": (
        about_x,
        even(Rotations().measure),
        Rotations(),
        "x[1] = 0 and x[2] = 0",
        "lower dimension",
    ),
    "one uniform used twice": (
        lambda rng, n: np.repeat(rng.random((n, 1)), 2, axis=1),
        even(1),
        UnitSquare(),
        "x[0] - x[1] = 0",
        "correlation",
    ),
    "one circle": (on_a_circle, even(2 * TURN), UnitSphere(), "x[0] - 0.75 x[2] = -0.75", "lower dimension"),
}


@pytest.mark.parametrize("name", FLAT)
def test_samples_of_no_volume_are_told_as_such(name):
    sample, pdf, domain, equation, cause = FLAT[name]
    verdict = verdict_of(sample, pdf, domain)
    assert verdict.cause == cause, str(verdict)
    assert f"all samples lie where {equation}: " in verdict.diagnosis, verdict.diagnosis


AXES = np.array([[2, 1, -2], [2, -2, 1], [1, 2, 2]]) / 3
LEAST = np.sqrt(1 - 1 / 36)  # cosine to the last axis, in a cone


def in_a_cone(x):
    return (x @ AXES[2] >= LEAST) / (TURN * (1 - LEAST))


def test_an_even_angle_in_a_cone_is_no_reflection():
    def sample(u):
        return about(np.cos(u[:, 0] * np.arccos(LEAST)), TURN * u[:, 1]) @ AXES

    verdict = verdict_of(sample, in_a_cone, UnitSphere(), 2)
    assert verdict.cause == "missing Jacobian", str(verdict)
    assert verdict.diagnosis.startswith("a sine is missing: "), verdict.diagnosis
    assert "about (0.333, 0.667, 0.667)" in verdict.diagnosis, verdict.diagnosis


def setting_in_a_cone():
    def sample(u):
        return about(np.cos(u[:, 0] * np.arccos(LEAST)), TURN * u[:, 1]) @ AXES

    setting = setting_of(Subject(sample, in_a_cone, UnitSphere(), 2), N, 3)
    assert setting is not None
    return setting


def test_an_even_claim_has_its_axis_from_its_edge():
    near = AXES[2] + 0.03 * AXES[0]
    axis = frames.axis_of_symmetry(setting_in_a_cone(), near / np.linalg.norm(near))
    assert np.allclose(axis, AXES[2], atol=1e-9)


def test_no_view_is_opposite_to_the_claim():
    """Half of such directions and the view, h, would be at right angles to it."""
    assert not list(half_vectors(setting_in_a_cone()))


def test_a_cone_that_is_too_narrow_is_told_by_its_angle():
    """The tangent stands for the sine: 2.7 % of the claim lie beyond, where known points are few."""

    def sample(u):
        return about(1 - u[:, 0] * (1 - 1 / np.sqrt(1 + 1 / 36)), TURN * u[:, 1]) @ AXES

    verdict = verdict_of(sample, in_a_cone, UnitSphere(), 2, samples=100_000)
    assert verdict.cause == "missing tail", str(verdict)
    assert "no sample lies farther than 9.46" in verdict.diagnosis, verdict.diagnosis


@pytest.mark.parametrize(
    ("power", "cause"), [(2.0, "missing square root"), (1.063, "wrong power"), (0.5, "wrong power")]
)
def test_only_a_whole_power_is_a_missing_root(power, cause):
    raised = [each for each in directions.hypotheses(setting_in_a_cone()) if "raised to the power" in each.words]
    assert raised[0].caused(power, 0.006) == cause


EDGES, SLOPES = np.array([0, 0.5, 0.7, 2.0]), np.array([1, 12, 0.2])
DEPTHS = np.concatenate([[0.0], np.cumsum(SLOPES * np.diff(EDGES))])
BREAKS = {"x": EDGES}


def layer(at, edges):
    return np.clip(np.searchsorted(edges, at, side="right") - 1, 0, 2)


def layers(u):
    """Free paths in three layers that end within the last one."""
    depth = -np.log1p(u[:, 0] * np.expm1(-DEPTHS[-1]))
    i = layer(depth, DEPTHS)
    return EDGES[i] + (depth - DEPTHS[i]) / SLOPES[i]


def layered(x):
    i = layer(x, EDGES)
    return SLOPES[i] * np.exp(-(DEPTHS[i] + SLOPES[i] * (x - EDGES[i]))) / -np.expm1(-DEPTHS[-1])


def test_a_clamp_where_the_pdf_jumps_is_told():
    verdict = verdict_of(lambda u: np.minimum(layers(u), 0.7), layered, Interval(0, 2), 1, breaks=BREAKS)
    assert verdict.cause == "clamped", str(verdict)
    assert "of the samples have x = 0.7, and the pdf has 0.013" in verdict.diagnosis, verdict.diagnosis


def test_a_clamp_to_where_the_pdf_is_none_is_told_beside_a_shift():
    """A cell off, of a density that ends in a hole: samples lie there, and many at the end of the axis."""

    def sample(u):
        return np.minimum(np.sqrt(u[:, 0]) * 0.9 + 0.2, 1.0)

    verdict = verdict_of(sample, lambda x: np.where(x < 0.9, 2 * x / 0.81, 0.0), Interval(0, 1), 1, breaks={"x": [0.9]})
    assert "of the samples are 1.0" in verdict.diagnosis, str(verdict)
    assert "shifted by 0.2" in verdict.diagnosis, verdict.diagnosis


def test_a_region_that_is_never_reached_is_told_where():
    def sample(rng, n):
        x = rng.random((2 * n, 2))
        return x[(np.abs(x[:, 0] - 0.375) > 0.125) | (np.abs(x[:, 1] - 0.5) > 0.25)][:n]

    setting = setting_of(Subject(sample, even(1), UnitSquare(), None), N, 3)
    assert setting is not None
    words = [each.words for each in holes.hypotheses(setting) if "is never reached" in each.words]
    assert len(words) == 1
    low, high = (float(end) for end in words[0].partition("where ")[2].partition(" and ")[0].split(" < x[0] < "))
    assert 0.2 < low < high < 0.55, words


def test_a_small_factor_may_be_one_place():
    """Beyond .7 the pdf is 1.15 of what it should be, and 1.3 % of the samples lie there."""
    verdict = verdict_of(layers, lambda x: np.where(x > 0.7, 1.15, 1) * layered(x), Interval(0, 2), 1, breaks=BREAKS)
    assert verdict.cause == "normalisation", str(verdict)
    assert "or it is right but in one place, and too large by 0.00197" in verdict.diagnosis, verdict.diagnosis


def test_a_factor_that_samples_tell_is_one():
    verdict = verdict_of(layers, lambda x: 1.03 * layered(x), Interval(0, 2), 1, breaks=BREAKS)
    assert verdict.diagnosis == "the samples fit the pdf but for a constant factor 1.03", verdict.diagnosis


def thinned(u):
    return Draw(-np.log1p(-u[:, 0]), valid=u[:, 1] < 0.6)


def test_more_valid_samples_than_the_pdf_has_are_none_lost():
    verdict = verdict_of(thinned, lambda x: 0.6 / 2.25 * np.exp(-x), HalfLine(0), 2)
    assert verdict.cause == "normalisation", str(verdict)
    assert "but for a constant factor 0.44" in verdict.diagnosis, verdict.diagnosis


def test_fewer_valid_samples_than_the_pdf_has_are_lost_or_it_has_a_factor():
    verdict = verdict_of(thinned, lambda x: 0.8 * np.exp(-x), HalfLine(0), 2)
    assert verdict.cause == "lost samples", str(verdict)
    assert "; or the pdf has a constant factor 1.3" in verdict.diagnosis, verdict.diagnosis


WEIGHTS = np.array([5, 0, 0, 1, 2.5, 0.01, 7, 3]) / 18.51


def entries(weights, used=1.0):
    return lambda u: np.minimum(np.searchsorted(np.cumsum(weights), used * u[:, 0], side="right"), len(weights) - 1)


def weight(k):
    return WEIGHTS[np.asarray(k, dtype=int)]


def test_one_entry_that_comes_too_seldom_is_one():
    """What it lacks the others share: they are a factor too frequent, the largest of them visibly."""
    verdict = verdict_of(entries(WEIGHTS, 0.97), weight, Discrete(8), 1)
    assert verdict.cause == "few entries", str(verdict)
    assert "but for the entry 7: 0.8" in verdict.diagnosis, verdict.diagnosis


@pytest.mark.parametrize("seed", range(4))
def test_equal_odds_leave_nothing_unexplained(seed):
    """A table gives many points the same odds: ranks among them that follow the labels seem to tell something."""
    setting = setting_of(Subject(entries(WEIGHTS), weight, Discrete(8), 1), N, seed)
    assert setting is not None
    assert unexplained(setting.contrast, setting.values) < 1.0


def test_square_roots_of_weights_are_told():
    verdict = verdict_of(entries(np.sqrt(WEIGHTS) / np.sqrt(WEIGHTS).sum()), weight, Discrete(8), 1)
    assert verdict.cause == "wrong power", str(verdict)
    assert "the square roots of the weights" in verdict.diagnosis, verdict.diagnosis
