"""Checks collected in a run: every check that fogproof has may be among them, and they share one false-alarm probability."""

import functools

import numpy as np
import pytest

import fogproof
from fogproof.errors import InvalidValueError


def uniform(rng, n):
    return rng.random(n)


LINE = (lambda u: u[:, 0], lambda x: np.ones(len(x)), 1)
CHECKS = [
    (fogproof.check_estimator, (uniform, 0.5), {"samples": 2000}),
    (fogproof.compare_estimators, (uniform, uniform), {"samples": 2000}),
    (fogproof.check_mis, ([LINE, LINE], lambda x: np.full((len(x), 2), 0.5)), {}),
    (fogproof.check_bound, (lambda x: x, 1.0, fogproof.Interval(0.0, 1.0)), {}),
    (fogproof.check_convergence, (lambda rng, n: rng.random(n).mean(), [10, 100]), {"reference": 0.5}),
    (fogproof.check_streams, (np.random.default_rng, 64), {}),
    (fogproof.check_reciprocity, (lambda a, b: 1 + (a * b).sum(axis=-1),), {}),
]


def test_every_check_is_run_with_what_it_takes():
    run = fogproof.Run(seed=3)
    for check, arguments, options in CHECKS:
        assert run.check(check.__name__, check, *arguments, **options).outcome == "not rejected"
    assert run.exit_code == 0


class Own:
    """A check that is an object."""

    def __call__(self, alpha):
        return fogproof.check_estimator(uniform, 0.5, samples=2000, alpha=alpha)


def test_a_check_need_not_be_a_plain_function():
    run = fogproof.Run(seed=3)
    parts = functools.partial(fogproof.check_estimator, uniform, samples=2000)
    first = run.check("arguments given in part", parts, 0.5)
    second = run.check("an object", Own())
    third = run.check("passed on", fogproof.check_gradient, uniform, 0.5, samples=2000)
    assert [v.alpha for v in (first, second, third)] == [1e-6 / 2, 1e-6 / 6, 1e-6 / 12]
    assert [case["title"] for case in run.record()["cases"]] == ["check_estimator", "Own", "check_gradient"]


def test_what_a_run_cannot_share_or_keep_is_explained():
    run = fogproof.Run()
    with pytest.raises(InvalidValueError, match="Run"):
        run.check("own alpha", fogproof.check_estimator, uniform, 0.5, alpha=0.1)
    with pytest.raises(InvalidValueError, match="Verdict"):
        run.check("no check", lambda: 3)
    assert run.exit_code == 1
