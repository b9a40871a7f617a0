"""Scores of labels: errors that are small everywhere, in several dimensions."""

import math

import numpy as np
import pytest
from scipy.linalg import eigh

from fogproof import Box, check_sampler
from fogproof.checks.statistics.label_scores import Basis, scores


def in_ball(power):
    """Points of the ball in five dimensions whose distance from the centre is u^(1 / power); 5 makes them uniform."""

    def sample(rng, n):
        direction = rng.normal(size=(n, 5))
        return direction * (rng.random(n) ** (1 / power) / np.linalg.norm(direction, axis=1))[:, None]

    return sample


def uniform_in_ball(x):
    return np.where(np.sum(x * x, axis=1) <= 1, 15 / (8 * np.pi**2), 0.0)


@pytest.mark.parametrize("power", [5.0, 4.75])
def test_smooth_errors_in_five_dimensions_are_seen(power):
    """The law of the radius is off by Kolmogorov's .02; no cell has points enough to show it."""
    verdict = check_sampler(
        in_ball(power), uniform_in_ball, Box((-1.0,) * 5, (1.0,) * 5), dimensions=None, samples=300_000, alpha=1e-6
    )
    rejecting = {f.check for f in verdict.findings if f.outcome == "rejected"}
    assert ("labels along smooth functions" in rejecting) == (power != 5.0), str(verdict)
    assert (verdict.outcome == "rejected") == (power != 5.0)


def _score_of(shift, batches, n, rng):
    """Return what scores find of `n` coins at points of [0, 1]^3 with probability 1/2, shifted along the first coordinate."""
    basis = Basis.of(rng.random((4096, 3)))
    found = []
    for _ in range(batches):
        u = rng.random((n, 3))
        told = rng.random(n) < 0.5 + 0.25 * shift * math.sqrt(3) * (2 * u[:, 0] - 1)
        found.append(scores("", *basis.weighed(u, told.astype(float), np.full(n, 0.5)), 1e-6))
    return found


def test_scores_find_an_error_of_the_stated_size():
    """A ratio of densities 1 + shift f, with f of mean square 1, moves a coin's probability by w (1 - w) shift f."""
    rng = np.random.default_rng()
    stated = _score_of(0.0, 1, 1 << 14, rng)[0].resolution.value
    for shift, least, most in ((stated, 0.9, 1.0), (-stated, 0.9, 1.0), (stated / 2, 0.0, 0.5)):
        caught = np.mean([each.outcome == "rejected" for each in _score_of(shift, 60, 1 << 14, rng)])
        assert least <= caught <= most, f"{shift}: {caught}"


def _mixed_with_uniform_points(basis, delta, n, rng):
    """Return coins of samples of p (1 + delta), p = 2 x 2 y on the square, among uniform points; the check knows p alone."""
    x = np.sqrt(rng.random((4 * n, 2)))
    x = x[rng.random(4 * n) < 0.5 * (1 + delta(x))][:n]
    u = np.concatenate([x, rng.random((n, 2))])
    p = 4 * u[:, 0] * u[:, 1]
    return basis.weighed(u, np.repeat([1.0, 0.0], n), p / (p + 1))


def test_the_stated_size_is_that_under_the_claim_in_the_direction_that_shows_least():
    """Where samples and known points lie apart, functions that live there move few coins: the size stated holds for these too."""
    rng, n = np.random.default_rng(), 1 << 14
    basis = Basis.of(np.sqrt(rng.random((4096, 2))))
    total, products = _mixed_with_uniform_points(basis, lambda u: np.zeros(len(u)), n, rng)
    stated = scores("", total, products, 1e-6).resolution.value
    covariance, gram = products[0, :-1, :-1], products[1, :-1, :-1] / products[1, -1, -1]
    shares, directions = eigh(gram, covariance)
    assert shares[-1] > 1.5 * shares[0], "directions that show alike test nothing"
    least = directions[:, -1] / np.sqrt(shares[-1])  # of mean square 1

    def caught(size):
        wrong = [_mixed_with_uniform_points(basis, lambda u: size * (least @ basis.at(u)), n, rng) for _ in range(40)]
        return np.mean([scores("", *each, 1e-6).outcome == "rejected" for each in wrong])

    assert caught(stated) >= 0.9
    assert caught(stated / 2) <= 0.5


def test_scores_follow_where_the_points_are():
    """Coordinates that fill a millionth of an axis are told apart as well as those that fill it."""
    rng = np.random.default_rng()
    u = 0.3 + 1e-6 * rng.random((4096, 2))
    functions = Basis.of(u).at(u)
    assert np.allclose(functions @ functions.T / len(u), np.eye(5), atol=0.15)
    everywhere = Basis.of(np.zeros((10, 2))).at(np.array([[0.0, 0.0], [1.0, 0.5]]))
    assert np.isfinite(everywhere).all(), "a pilot that knows one point"
    assert Basis.of(rng.random((100, 30))).size == 80
