"""Checks collected in a run: every check that fogproof has may be among them, and they share one false-alarm probability."""

import copy
import functools
import os
import pickle
import tempfile
import threading
from concurrent.futures import ThreadPoolExecutor

import numpy as np
import pytest

import fogproof
from fogproof.errors import InvalidValueError, UnsupportedError


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


def test_threads_share_alpha_too():
    run = fogproof.Run(seed=1)
    start = threading.Barrier(16)

    def one(i):
        start.wait()
        return run.check(f"case {i}", lambda alpha: fogproof.check_estimator(uniform, 0.5, samples=200, alpha=alpha))

    with ThreadPoolExecutor(16) as pool:
        shares = [verdict.alpha for verdict in pool.map(one, range(16))]
    assert sorted(shares, reverse=True) == pytest.approx([1e-6 / (k * (k + 1)) for k in range(1, 17)])


def test_an_alpha_beside_the_run_is_counted():
    run = fogproof.Run(alpha=1e-4, seed=1)
    run.check("its own", lambda: fogproof.check_estimator(uniform, 0.5, samples=2000, alpha=1e-5))
    run.add("elsewhere", fogproof.check_estimator(uniform, 0.5, samples=2000, alpha=1e-3))
    assert run.record()["alpha"] == pytest.approx(1e-4 + 1e-5 + 1e-3)


def test_an_interrupted_check_is_not_judged(interruptible):
    def interrupted(rng, n):
        raise KeyboardInterrupt

    run = fogproof.Run(seed=1)
    with pytest.raises(KeyboardInterrupt):
        run.check("interrupted", fogproof.check_estimator, interrupted, 0.5)
    assert run.exit_code == 1
    assert run.record()["cases"][0]["reason"] == "it did not end"


@pytest.mark.parametrize(
    ("wrong", "word"),
    [
        (lambda: fogproof.Run(seed=-1), "seed"),
        (lambda: fogproof.Run().check(3, fogproof.check_estimator, uniform, 0.5), "name must be a string"),
        (lambda: fogproof.Run().check("x" * 201, fogproof.check_estimator, uniform, 0.5), "must have at most 200"),
        (lambda: fogproof.Run().add("x" * 201, fogproof.check_estimator(uniform, 0.5, samples=100)), "at most 200"),
        (lambda: fogproof.Run().add("x", 3), "verdict must be a Verdict"),
        (lambda: fogproof.Run().add(fogproof.check_estimator(uniform, 0.5, samples=100), "x"), "must be a"),
    ],
)
def test_wrong_arguments_are_explained(wrong, word):
    with pytest.raises(InvalidValueError, match=word):
        wrong()


@pytest.mark.skipif(not hasattr(os, "memfd_create"), reason="needs a system with files in memory")
def test_a_rejection_in_a_forked_process_needs_no_folder(monkeypatch):
    monkeypatch.setattr(tempfile, "tempdir", "/nowhere")
    test_a_rejection_in_a_forked_process_is_the_runs()


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs a system that can fork")
def test_a_rejection_in_a_forked_process_is_the_runs():
    run = fogproof.Run(seed=1)
    child = os.fork()
    if not child:
        try:
            run.check(
                "wrong",
                fogproof.check_sampler,
                lambda u: -np.log1p(-u[:, 0]),
                lambda t: np.exp(-t) / 2,
                fogproof.HalfLine(0.0),
                dimensions=1,
            )
        finally:
            os._exit(0)
    os.waitpid(child, 0)
    assert run.exit_code == 1
    assert [(case["name"], case["status"]) for case in run.record()["cases"]] == [("wrong", "rejected")]


@pytest.mark.parametrize("another", [copy.copy, copy.deepcopy, pickle.dumps])
def test_there_is_no_copy_of_a_run_to_judge_into_nothing(another):
    with pytest.raises(UnsupportedError, match=r"for what the copy finds would be lost: .*run.add"):
        another(fogproof.Run(seed=1))


def test_a_verdict_of_another_process_can_be_added():
    run = fogproof.Run(seed=1)
    run.add("wrong", pickle.loads(pickle.dumps(fogproof.check_estimator(uniform, 0.9, samples=2000))))
    assert run.exit_code == 1
