"""Checks collected in a run: every check that fogproof has may be among them, and they share one false-alarm probability."""

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


def test_what_a_run_cannot_share_or_keep_is_explained():
    run = fogproof.Run()
    with pytest.raises(InvalidValueError, match="Run"):
        run.check("own alpha", fogproof.check_estimator, uniform, 0.5, alpha=0.1)
    with pytest.raises(InvalidValueError, match="Verdict"):
        run.check("no check", lambda: 3)
    assert run.exit_code == 1
