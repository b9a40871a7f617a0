"""What was done to a table of few cells is named: it makes a density that jumps, of which smooth hypotheses explain nothing."""

import re

import numpy as np
import pytest

from fogproof import Interval, UnitSphere, UnitSquare, check_sampler

N = 40_000
H, W = 4, 8
AREA = np.outer(-np.diff(np.cos(np.pi * np.arange(H + 1) / H)), np.full(W, 2 * np.pi / W))


def table(*shape):
    """Return weights of cells, each of the digits once or more, in an order by chance."""
    w = np.arange(1.0, 1 + np.prod(shape))
    np.random.default_rng().shuffle(w)
    return (w / w.mean()).reshape(shape)


def drawn(w, u):
    """Return row and column of a cell with the probabilities w."""
    cell = np.minimum(np.searchsorted(np.cumsum(w.ravel()) / w.sum(), u, side="right"), w.size - 1)
    return np.divmod(cell, w.shape[1])


def at(w, row, column):
    h, k = w.shape
    return w[np.clip((row * h).astype(int), 0, h - 1), np.clip((column * k).astype(int), 0, k - 1)]


def on_the_square(done):
    w = table(4, 4)

    def sample(u):
        row, column = drawn(done(w), u[:, 0])
        return (np.stack([column, row], axis=-1) + u[:, 1:]) / 4

    return sample, lambda x: at(w, x[:, 1], x[:, 0]), UnitSquare()


def on_the_line(done):
    w = table(1, 16)

    def sample(u):
        return (drawn(done(w), u[:, 0])[1] + u[:, 1]) / 16

    return sample, lambda x: at(w, np.zeros(len(x)), x), Interval(0, 1)


def on_the_sphere(done):
    """`done` gives the probabilities of cells; H rows of theta, W columns of phi."""
    w = table(H, W)
    w /= np.sum(w * AREA)
    chances = done(w)

    def sample(u):
        h, k = chances.shape
        row, column = drawn(chances, u[:, 0])
        top, bottom = (np.cos(np.pi * (row + i) / h) for i in (0, 1))
        z, phi = top + (bottom - top) * u[:, 1], 2 * np.pi * (column + u[:, 2]) / k
        s = np.sqrt(np.maximum(1 - z * z, 0))
        return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)

    def pdf(x):
        return at(w, np.arccos(np.clip(x[:, 2], -1, 1)) / np.pi, np.arctan2(x[:, 1], x[:, 0]) / (2 * np.pi) % 1)

    return sample, pdf, UnitSphere()


def transposed(w):
    area = np.outer(-np.diff(np.cos(np.pi * np.arange(W + 1) / W)), np.full(H, 2 * np.pi / H))
    return w.T * area


@pytest.mark.parametrize(
    ("where", "done", "cause", "words"),
    [
        (on_the_square, lambda w: np.roll(w, 1, axis=1), "shifted", "0.2[45].* along axis 0"),
        (on_the_square, lambda w: np.roll(w, -1, axis=0), "shifted", "-0.2[45].* along axis 1"),
        (on_the_square, np.transpose, "swapped axes", "in the order 1, 0"),
        (on_the_line, lambda w: np.roll(w, 1, axis=1), "shifted", "0.06[23]"),
        (on_the_sphere, lambda w: w, "missing Jacobian", "each of 4 rows leaves out its area"),
        (on_the_sphere, lambda w: w * AREA**2, "missing Jacobian", "area of each of 4 rows counts twice"),
        (on_the_sphere, lambda w: np.roll(w, 1, axis=1) * AREA, "rotated frame", "about z by 0.12[45]"),
        (on_the_sphere, lambda w: np.roll(w, 1, axis=0) * AREA, "shifted", "0.2[45].* in theta"),
        (on_the_sphere, lambda w: w[:, ::-1] * AREA, "sign convention", "y mirrored"),
        (on_the_sphere, transposed, "swapped axes", "its table is transposed"),
    ],
)
def test_what_was_done_to_a_small_table_is_named(where, done, cause, words):
    sample, pdf, domain = where(done)
    dimensions = 2 if where is on_the_line else 3
    verdict = check_sampler(sample, pdf, domain, dimensions=dimensions, samples=N)
    assert (verdict.outcome, verdict.cause) == ("rejected", cause), verdict
    assert re.search(words, verdict.diagnosis), verdict.diagnosis


@pytest.mark.parametrize("where", [on_the_square, on_the_sphere])
def test_a_right_table_passes(where):
    sample, pdf, domain = where(lambda w: w * AREA if where is on_the_sphere else w)
    verdict = check_sampler(sample, pdf, domain, dimensions=3, samples=N, alpha=1e-7)
    assert verdict.outcome != "rejected", verdict
