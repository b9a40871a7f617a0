"""Hints make a check sharper where a density jumps; one that is wrong is told, and changes no verdict."""

import numpy as np
import pytest

from fogproof import (
    Ball,
    Discrete,
    HalfLine,
    Interval,
    InvalidValueError,
    Triangle,
    UnitDisk,
    UnitSphere,
    UnitSquare,
    check_sampler,
)

SAMPLES = 100_000
COLUMNS, ROWS = 12, 7
WEIGHTS = np.random.default_rng(5).random((COLUMNS, ROWS)) + 0.01
WEIGHTS[5, 3] = 40.0
WEIGHTS /= WEIGHTS.sum()
SUMS = np.cumsum(WEIGHTS.ravel())
EDGES = {"x": np.arange(COLUMNS + 1) / COLUMNS, "y": np.arange(ROWS + 1) / ROWS}


def texel(x):
    return tuple(np.clip((x[:, k] * n).astype(int), 0, n - 1) for k, n in enumerate((COLUMNS, ROWS)))


def environment(u):
    k = np.minimum(np.searchsorted(SUMS, u[:, 0], side="right"), WEIGHTS.size - 1)
    return np.stack([(k // ROWS + u[:, 1]) / COLUMNS, (k % ROWS + u[:, 2]) / ROWS], axis=-1)


def shifted(u):
    x = environment(u)
    x[:, 0] = (x[:, 0] + 1 / COLUMNS) % 1
    return x


def environment_pdf(x):
    return WEIGHTS[texel(x)] * WEIGHTS.size


def environment_inverse(x):
    i, j = texel(x)
    column = WEIGHTS.sum(axis=1)
    before = np.concatenate([[0.0], np.cumsum(column)])[i]
    below = (np.cumsum(WEIGHTS, axis=1) - WEIGHTS)[i, j]
    first = before + (x[:, 0] * COLUMNS - i) * column[i]
    return np.stack([first, (below + (x[:, 1] * ROWS - j) * WEIGHTS[i, j]) / column[i]], axis=-1)


def check(sample=environment, pdf=environment_pdf, domain=None, dimensions=3, **hints):
    domain = UnitSquare() if domain is None else domain
    return check_sampler(sample, pdf, domain, dimensions=dimensions, samples=SAMPLES, **hints)


HINTS = {"breaks": {"breaks": EDGES}, "inverse": {"inverse": environment_inverse}}
WRONG = {
    "breaks elsewhere": {"breaks": {"x": [0.31], "y": [0.5]}},
    "breaks of no coordinate": {"breaks": {"mu": [0.5]}},
    "breaks by the million": {"breaks": {"x": np.arange(1000) / 1000, "y": np.arange(1000) / 1000}},
    "inverse of another law": {"inverse": np.square},
    "inverse that leaves the cube": {"inverse": lambda x: 2 * x},
    "inverse that raises": {"inverse": lambda x: x[:, 7]},
    "inverse of one column": {"inverse": lambda x: x[:, 0]},
    "support too small": {"support": Triangle((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))},
}


@pytest.mark.parametrize("name", HINTS)
def test_a_right_hint_is_used_and_errors_are_found_with_it(name):
    assert check(**HINTS[name]).unchecked == ()
    assert check(**HINTS[name]).outcome == "not rejected"
    assert check(shifted, **HINTS[name]).outcome == "rejected"
    factor = 0.97 if name == "breaks" else 0.9  # an inverse that contradicts the pdf is no use: labels see 4 %
    assert check(pdf=lambda x: factor * environment_pdf(x), **HINTS[name]).outcome == "rejected"


def test_between_breaks_an_integral_is_known_to_seven_digits():
    almost = lambda x: environment_pdf(x) * (1 + 1e-5)  # noqa: E731
    assert check(pdf=almost).outcome == "not rejected"
    verdict = check(pdf=almost, breaks=EDGES)
    assert [f.check for f in verdict.findings if f.outcome == "rejected"] == ["normalisation"]


@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_hint_is_told_and_not_believed(name):
    right = check(**WRONG[name])
    assert right.outcome == "not rejected", str(right)
    assert len(right.unchecked) == 1
    assert "not used" in right.unchecked[0]
    assert right.unchecked[0].startswith(next(iter(WRONG[name])))
    assert "not used" in str(right)
    assert check(shifted, **WRONG[name]).outcome == "rejected"


def test_a_sampler_that_follows_its_inverse_and_not_its_pdf_is_rejected():
    verdict = check(pdf=lambda x: np.ones(len(x)), inverse=environment_inverse)
    assert verdict.outcome == "rejected"
    assert "inverse (not used" in str(verdict)


def ball(u):
    r, z, phi = np.cbrt(u[:, 0]), 1 - 2 * u[:, 1], 2 * np.pi * u[:, 2]
    s = np.sqrt(1 - z * z)
    return r[:, None] * np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)


def ball_inverse(x):
    r = np.linalg.norm(x, axis=1)
    return np.stack([r**3, 0.5 * (1 - x[:, 2] / r), np.arctan2(x[:, 1], x[:, 0]) / (2 * np.pi) % 1], axis=-1)


def disk(u):
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)


DOMAINS = {
    "line": (lambda u: -np.log1p(-u[:, 0]), lambda x: np.exp(-x), HalfLine(), 1, lambda x: np.exp(-x)),
    "disk": (disk, lambda x: np.full(len(x), 1 / np.pi), UnitDisk(), 2,
             lambda x: np.stack([np.sum(x * x, axis=1), np.arctan2(x[:, 1], x[:, 0]) / (2 * np.pi) % 1], axis=-1)),
    "ball": (ball, lambda x: np.full(len(x), 3 / (4 * np.pi)), Ball(1.0), 3, ball_inverse),
}  # fmt: skip


@pytest.mark.parametrize("name", DOMAINS)
def test_an_inverse_serves_every_domain(name):
    sample, pdf, domain, k, inverse = DOMAINS[name]
    right = check(sample, pdf, domain, k, inverse=inverse)
    assert right.outcome == "not rejected", str(right)
    assert right.unchecked == ()
    uneven = lambda u: sample(np.concatenate([u[:, :1] ** 1.06, u[:, 1:]], axis=1))  # noqa: E731
    wrong = check(uneven, pdf, domain, k, inverse=inverse)
    assert wrong.outcome == "rejected"
    assert name == "line" or any("inverse, 1 of" in f.check and f.outcome == "rejected" for f in wrong.findings)


def test_an_inverse_is_of_what_lies_between_the_atoms():
    sample = lambda u: np.where(u[:, 0] < 0.25, 1.0, u[:, 1])  # noqa: E731
    verdict = check(sample, lambda x: np.full(len(x), 0.75), Interval(0, 1), 2, atoms={1.0: 0.25}, inverse=lambda x: x)
    assert verdict.outcome == "not rejected", str(verdict)
    assert verdict.unchecked == ()


def test_single_points_have_no_inverse():
    verdict = check(
        lambda u: np.floor(6 * u[:, 0]), lambda i: np.full(len(i), 1 / 6), Discrete(6), 1, inverse=lambda i: i / 6
    )
    assert verdict.outcome == "not rejected"
    assert "single points" in verdict.unchecked[0]


def corner(u):
    r = np.sqrt(u[:, 0])
    return np.stack([r * (1 - u[:, 1]), r * u[:, 1]], axis=-1)


def corner_pdf(x):
    return 2.0 * (x.sum(axis=1) <= 1 + 1e-12)


def test_a_support_takes_the_place_of_the_domain():
    half = Triangle((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    verdict = check(corner, corner_pdf, dimensions=2, support=half)
    assert verdict.outcome == "not rejected", str(verdict)
    assert verdict.unchecked == ()
    assert repr(half) in verdict.reproduce
    small = lambda u: 0.9 * corner(u)  # noqa: E731
    assert check(small, corner_pdf, dimensions=2, support=half).outcome == "rejected"


@pytest.mark.parametrize(
    ("hint", "words"),
    [
        ({"breaks": [0.5]}, "breaks must be"),
        ({"breaks": {"x": ["a"]}}, r"breaks\['x'\] must be numbers"),
        ({"breaks": {"x": [np.nan]}}, r"breaks\['x'\] must be finite"),
        ({"support": lambda x: x > 0}, "support must be a domain"),
        ({"support": UnitSphere()}, "support must have points like"),
        ({"inverse": 3}, "inverse must be a function"),
    ],
)
def test_bad_hints_are_explained(hint, words):
    with pytest.raises(InvalidValueError, match=words):
        check(**hint)


@pytest.mark.parametrize("first", [0.0, -np.pi])
def test_azimuths_may_be_counted_from_anywhere(first):
    """A map of sectors: what jumps between pi and 2 pi jumps between -pi and 0."""
    shares = np.random.default_rng(8).random(48) + 0.05
    shares[40] = 9.0
    shares /= shares.sum()
    sums = np.concatenate([[0.0], np.cumsum(shares)])
    edges = np.linspace(0, 2 * np.pi, 49)

    def sample(u):
        mu, phi = 2 * u[:, 0] - 1, np.interp(u[:, 1], sums, edges)
        s = np.sqrt(1 - mu * mu)
        return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=1)

    def pdf(x):
        sector = np.minimum((np.arctan2(x[:, 1], x[:, 0]) % (2 * np.pi) / (2 * np.pi) * 48).astype(int), 47)
        return shares[sector] * 48 / (4 * np.pi)

    breaks = {"phi": edges + first}
    verdict = check_sampler(sample, pdf, UnitSphere(), dimensions=2, samples=50_000, breaks=breaks)
    assert verdict.outcome == "not rejected", str(verdict)
    assert not verdict.unchecked, verdict.unchecked
