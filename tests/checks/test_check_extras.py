"""Subjects that never return are ended, and phase functions that are not reciprocal are found."""

import os
import time

import numpy as np
import pytest

from fogproof import Draw, Interval, check_sampler
from fogproof.checks import check_reciprocity
from fogproof.checks.limits import within
from fogproof.errors import SubjectError


def stuck(u):
    while True:
        time.sleep(0.01)


def test_a_sampler_that_never_returns_is_ended():
    with pytest.raises(SubjectError, match=r"did not return within 0.5 s"):
        within(0.5, lambda: check_sampler(stuck, lambda x: np.ones(len(x)), Interval(0, 1), dimensions=1))


def test_a_check_within_its_time_answers_as_ever():
    def check():
        return check_sampler(
            lambda u: u[:, 0], lambda x: np.ones(len(x)), Interval(0, 1), dimensions=1, samples=1000, seed=3
        )

    limited, free = within(60, check), check()
    assert [(f.check, f.p_value) for f in limited.findings] == [(f.check, f.p_value) for f in free.findings]


def test_errors_and_crashes_come_back_as_errors():
    with pytest.raises(SubjectError, match="raised ZeroDivisionError"):
        within(60, lambda: check_sampler(lambda u: 1 / 0, lambda x: x, Interval(0, 1), dimensions=1))
    with pytest.raises(SubjectError, match="exit code 3"):
        within(60, lambda: os._exit(3))
    with pytest.raises(SubjectError, match="KeyError"):
        within(60, lambda: {}["x"])


def henyey_greenstein(g):
    def f(a, b):
        half_chord = 0.5 * np.sum((a - b) ** 2, axis=1)
        return (1 - g * g) / (4 * np.pi * ((1 - g) ** 2 + 2 * g * half_chord) ** 1.5)

    return f


FUNCTIONS = [
    ("Henyey-Greenstein", henyey_greenstein(0.9), {}, set()),
    ("fibres along z", lambda a, b: 1 + 0.3 * a[:, 2] ** 2 * b[:, 2] ** 2, {"isotropic": False}, set()),
    ("fibres along z, called isotropic", lambda a, b: 1 + 0.3 * a[:, 2] ** 2 * b[:, 2] ** 2, {}, {"rotation"}),
    ("wi and wo exchanged", lambda a, b: 1 + 0.1 * a[:, 2] ** 2, {"isotropic": False}, {"reciprocity"}),
    ("about the z axis", lambda a, b: henyey_greenstein(0.5)(np.tile([0.0, 0.0, 1.0], (len(a), 1)), b), {},
     {"reciprocity", "rotation"}),
]  # fmt: skip


@pytest.mark.parametrize(("name", "f", "options", "rejecting"), FUNCTIONS, ids=[c[0] for c in FUNCTIONS])
def test_reciprocity_and_rotation(name, f, options, rejecting):
    verdict = check_reciprocity(f, samples=2000, **options)
    assert {g.check for g in verdict.findings if g.outcome == "rejected"} == rejecting, str(verdict)


def test_what_decides_about_weights_is_something_that_a_sampler_can_declare():
    verdict = check_sampler(
        lambda u: Draw(u[:, 0], weight=np.full(len(u), 0.6)),
        lambda x: np.ones(len(x)), Interval(0, 1), dimensions=1, albedo=0.61, samples=1000,
    )  # fmt: skip
    assert verdict.outcome == "inconclusive"
    (said,) = [f.message for f in verdict.findings if f.outcome == "inconclusive"]
    assert "eval" in said
    assert "variance" not in said
