"""Checks that others draw for end in the verdict of one process, whatever is interrupted, killed, lost or damaged on the way."""

import json
import os
import signal
from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest

from fogproof import HalfLine, InvalidValueError, check_distributed, distributed, sampler_check
from fogproof.errors import InvalidInputError, SubjectError

SAMPLES = 1_400_000


@dataclass(frozen=True)
class FreePath:
    """Free paths of a unit medium; the rate of the pdf is right if it is 1, and `what` happens in large calls."""

    rate: float = 1.0
    what: str = ""
    at: str = ""

    def sample(self, u):
        if self.what:
            self._misbehave(u)
        return -np.log1p(-u[:, 0])

    def pdf(self, x):
        return self.rate * np.exp(-self.rate * x)

    def _misbehave(self, u):
        if len(u) < 60_000:  # not in the questions beforehand
            return
        if self.what == "dies once":
            try:
                os.mkdir(self.at)
            except FileExistsError:
                return
            os.kill(os.getpid(), signal.SIGKILL)
        if self.what == "dies":
            os.kill(os.getpid(), signal.SIGKILL)
        raise ZeroDivisionError("in a worker")


def check_of(path, seed=7, samples=SAMPLES, **options):
    return sampler_check(path.sample, path.pdf, HalfLine(0), dimensions=1, samples=samples, seed=seed, **options)


def said(verdict):
    return [(f.check, f.outcome, f.p_value, f.effect) for f in verdict.findings]


@pytest.fixture(scope="module")
def whole():
    return check_of(FreePath()).run()


@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_the_verdict_is_that_of_one_process(whole, executor):
    verdict = check_distributed(partial(check_of, FreePath()), executor, workers=2)
    assert said(verdict) == said(whole)
    assert (verdict.outcome, verdict.samples) == ("not rejected", SAMPLES)


def test_an_interrupted_one_goes_on_and_draws_nothing_twice(tmp_path, monkeypatch, whole):
    keep, drawn, stops = tmp_path / "kept.json", [], [True]

    def tally(self, batches, of=distributed.SamplerCheck.tally):
        drawn.extend(batches)
        if len(drawn) > 12 and stops.pop():
            raise KeyboardInterrupt
        return of(self, batches)

    monkeypatch.setattr(distributed.SamplerCheck, "tally", tally)
    monkeypatch.setattr(distributed, "PART", 2)
    make = partial(check_of, FreePath())
    with pytest.raises(KeyboardInterrupt):
        check_distributed(make, "threads", workers=1, keep=keep)
    kept = json.loads(json.loads(keep.read_text())["tally"])["batches"]
    assert kept == list(range(len(kept)))
    assert 2 <= len(kept) <= 12
    drawn.clear()
    stops[:] = [False] * 100
    assert said(check_distributed(make, "threads", workers=1, keep=keep)) == said(whole)
    assert drawn == list(range(len(kept), make().batches))
    drawn.clear()
    assert said(check_distributed(make, "threads", workers=1, keep=keep)) == said(whole)
    assert drawn == []


def test_a_rejection_is_kept_like_any_other(tmp_path, whole):
    make = partial(check_of, FreePath(1.5))
    first = check_distributed(make, "threads", keep=tmp_path / "kept.json")
    assert (first.outcome, first.samples < SAMPLES) == ("rejected", True)
    assert said(check_distributed(make, "threads", keep=tmp_path / "kept.json")) == said(first)


def test_a_worker_that_is_killed_costs_nothing(tmp_path, whole):
    path = FreePath(what="dies once", at=str(tmp_path / "died"))
    verdict = check_distributed(partial(check_of, path), "processes", workers=2)
    assert (tmp_path / "died").exists()
    assert said(verdict) == said(whole)


@pytest.mark.parametrize(
    ("what", "words"), [("dies", "exit code -9"), ("raises", r"^sample\(u\) raised ZeroDivisionError: in a worker")]
)
def test_what_a_sampler_does_to_its_worker_is_told(tmp_path, what, words):
    with pytest.raises(SubjectError, match=words):
        check_distributed(partial(check_of, FreePath(what=what)), "processes", workers=1, keep=tmp_path / "kept.json")


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (partial(check_of, FreePath(), seed=8), "another subject, seed"),
        (partial(check_of, FreePath(1.01)), "another subject, seed"),
        (partial(check_of, FreePath(), alpha=1e-5), "another subject, seed"),
        (partial(check_of, FreePath(), samples=2 * SAMPLES), "another subject, seed"),
    ],
)
def test_samples_of_another_check_are_refused(tmp_path, make, words):
    check_distributed(partial(check_of, FreePath()), "threads", keep=tmp_path / "kept.json")
    before = (tmp_path / "kept.json").read_bytes()
    with pytest.raises(InvalidInputError, match=words):
        check_distributed(make, "threads", keep=tmp_path / "kept.json")
    assert (tmp_path / "kept.json").read_bytes() == before


def test_a_file_that_is_damaged_or_somebody_elses_is_refused(tmp_path):
    make, keep = partial(check_of, FreePath(), samples=100_000), tmp_path / "kept.json"
    check_distributed(make, "threads", keep=keep)
    good = json.loads(keep.read_text())
    for content, words in (
        ("", "keeps no samples"),
        ('{"mine": 1}', "keeps no samples"),
        ("[" * 10_000, "keeps no samples"),
        (json.dumps({**good, "schema": "fogproof tally 0"}), "another version"),
        (json.dumps({**good, "tally": good["tally"].replace('"drawn": 100000', '"drawn": 200000')}), "damaged"),
        (json.dumps({**good, "tally": good["tally"][:-9]}), "damaged"),
    ):
        keep.write_text(content)
        with pytest.raises(InvalidInputError, match=words):
            check_distributed(make, "threads", keep=keep)
        assert keep.read_text() == content


def test_what_makes_the_check_must_be_the_same_everywhere():
    unseeded = partial(check_of, FreePath(), seed=None)
    assert check_distributed(unseeded, "threads").outcome == "not rejected"
    with pytest.raises(InvalidValueError, match="give the check a seed"):
        check_distributed(unseeded, "processes", workers=1)
    with pytest.raises(InvalidValueError, match='a lambda goes with executor="threads"'):
        check_distributed(lambda: check_of(FreePath()), "processes")
    with pytest.raises(InvalidValueError, match=r"what sampler_check\(...\) returns, got 'FreePath'"):
        check_distributed(FreePath, "threads")
    with pytest.raises(InvalidValueError, match="threads, processes or dask://host:port"):
        check_distributed(unseeded, "cluster")


def test_a_cluster(whole, cluster):
    address, _ = cluster
    path = FreePath()
    make = partial(sampler_check, path.sample, path.pdf, HalfLine(0), dimensions=1, samples=SAMPLES, seed=7)
    assert said(check_distributed(make, f"dask://{address}")) == said(whole)
