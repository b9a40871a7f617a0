"""Wrong arguments and wrong answers get one sentence with the fix; what is plainly meant simply works."""

import numpy as np
import pytest

from fogproof import Draw, HalfLine, Interval, UnitSphere, check_sampler
from fogproof.errors import FogproofError, InvalidValueError, SubjectError

UNIT = Interval(0, 1)


def line(u):
    return u[:, 0]


def ones(x):
    return np.ones(len(x))


def sphere(u):
    mu, phi = 2 * u[:, 0] - 1, 2 * np.pi * u[:, 1]
    return np.stack([np.sqrt(1 - mu * mu) * np.cos(phi), np.sqrt(1 - mu * mu) * np.sin(phi), mu], axis=-1)


def even(x):
    return np.full(len(x), 0.25 / np.pi)


ARGUMENTS = {
    "seed=-1": ({"seed": -1}, "seed must be a whole number >= 0, got -1"),
    "seed=1.5": ({"seed": 1.5}, "seed must be a whole number >= 0, got 1.5"),
    "alpha=1e-320": ({"alpha": 1e-320}, r"alpha must lie in \[1e-100, 1\)"),
    "alpha=0": ({"alpha": 0}, "alpha must lie in"),
    "mean_cosine=2": ({"mean_cosine": 2, "axis": (0, 0, 1)}, r"mean_cosine must lie in \[-1, 1\], got 2"),
    "mean_cosine alone": ({"mean_cosine": 0.5}, "axis must be given with mean_cosine"),
    "axis=(0, 0, 0)": ({"axis": (0, 0, 0)}, "axis must have unit length"),
    "axis of two": ({"axis": (0, 1)}, "axis must have three coordinates"),
    "samples=1e2 and a half": ({"samples": 100.5}, "samples must be a whole number >= 100"),
    "samples=inf": ({"samples": np.inf}, "samples must be a whole number"),
    "samples=True": ({"samples": True}, "samples must be a whole number"),
    "dimensions=0": ({"dimensions": 0}, "dimensions must be a whole number >= 1, got 0; or None"),
    "events": ({"events": {0: 0.7, 1: 0.2}}, "events must have probabilities that sum to 1"),
    "precision": ({"precision": "single"}, "precision must be 'float64' or 'float32'"),
    "uniform_bits": ({"uniform_bits": 0}, "uniform_bits must be a whole number >= 8"),
}


@pytest.mark.parametrize("name", ARGUMENTS)
def test_wrong_arguments_are_named_with_the_rule(name):
    options, message = ARGUMENTS[name]
    with pytest.raises(InvalidValueError, match=message):
        check_sampler(sphere, even, UnitSphere(), **{"dimensions": 2, "samples": 1000, **options})


def test_a_class_is_not_yet_a_domain():
    with pytest.raises(InvalidValueError, match=r"write HalfLine\(\.\.\.\)"):
        check_sampler(line, ones, HalfLine, dimensions=1)


def test_whole_numbers_of_any_type_are_whole_numbers():
    options = {"dimensions": np.int64(1), "samples": 2e4, "seed": 3.0}
    verdict = check_sampler(line, ones, UNIT, **options)
    assert verdict.outcome == "not rejected", str(verdict)
    assert (verdict.samples, verdict.seed) == (20_000, 3)
    assert isinstance(verdict.samples, int)


class OnlyDlpack:
    """An array of a library that offers nothing but the exchange protocol."""

    def __init__(self, array):
        self.array = array

    def __dlpack__(self, **options):
        return self.array.__dlpack__(**options)

    def __dlpack_device__(self):
        return self.array.__dlpack_device__()


class Unwilling:
    def __array__(self, *args, **kwargs):
        raise RuntimeError("requires grad")


ANSWERS = {
    "x and pdf": (lambda u: (line(u), ones(u)), r"fogproof\.Draw\(x, pdf=\.\.\., weight=\.\.\.\)"),
    "float32": (lambda u: line(u).astype(np.float32), r'x is float32 where .* say precision="float32"'),
    "masked": (lambda u: np.ma.masked_less(line(u), 0.5), r"masked array with \d+ entries hidden; .*valid=~mask"),
    "a column": (lambda u: u[:, :1], r"drop the last axis: x\[:, 0\]"),
    "unwilling": (lambda u: Unwilling(), r"RuntimeError: requires grad\); return a NumPy array"),
    "words": (lambda u: ["a"] * len(u), "must return numbers"),
    "None": (lambda u: None, "must return numbers"),
    "ragged": (lambda u: [[1.0], [1.0, 2.0]], "sample: x"),
    "complex": (lambda u: line(u) * 1j, "must return numbers, got dtype complex128"),
}


@pytest.mark.parametrize("name", ANSWERS)
def test_wrong_answers_are_named_with_the_fix(name):
    sample, message = ANSWERS[name]
    with pytest.raises(SubjectError, match=message):
        check_sampler(sample, ones, UNIT, dimensions=1, samples=1000)


POINTS = {
    "(3, n)": (lambda u: sphere(u).T, "transpose it"),
    "three arrays": (lambda u: tuple(np.ascontiguousarray(sphere(u).T)), r"np\.stack\(parts, axis=-1\)"),
}


@pytest.mark.parametrize("name", POINTS)
def test_points_lie_in_rows(name):
    sample, message = POINTS[name]
    with pytest.raises(SubjectError, match=message):
        check_sampler(sample, even, UnitSphere(), dimensions=2, samples=1000)


def test_a_constant_density_needs_one_value_a_point():
    with pytest.raises(SubjectError, match=r"np\.full\(len\(x\), value\)"):
        check_sampler(line, lambda x: 1.0, UNIT, dimensions=1, samples=1000)


@pytest.mark.parametrize("wrap", [OnlyDlpack, np.ma.array, list])
def test_anything_that_holds_numbers_is_an_array(wrap):
    verdict = check_sampler(lambda u: wrap(line(u)), ones, UNIT, dimensions=1, samples=5000)
    assert verdict.outcome == "not rejected", str(verdict)
    verdict = check_sampler(lambda u: Draw(line(u), pdf=wrap(ones(u))), ones, UNIT, dimensions=1, samples=5000)
    assert verdict.outcome == "not rejected", str(verdict)


def test_every_error_is_ours():
    assert issubclass(InvalidValueError, FogproofError)
    assert issubclass(SubjectError, FogproofError)


@pytest.mark.parametrize(("integral", "told"), [(1.0, True), (0.9, False)])
def test_lost_samples_that_nothing_tells_are_unchecked(integral, told):
    """A pdf that integrates to the share of valid samples says how many may be lost; one of the valid ones alone does not."""
    verdict = check_sampler(
        lambda u: Draw(u[:, 0], valid=u[:, 1] >= 0.1),
        lambda x: np.full(len(x), integral),
        UNIT,
        dimensions=2,
        samples=20_000,
    )
    assert verdict.outcome == "not rejected", str(verdict)
    assert any("are given up" in what for what in verdict.unchecked) == told, str(verdict)
