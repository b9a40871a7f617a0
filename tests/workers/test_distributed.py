"""Checks that others draw for end in the verdict of one process, whatever is interrupted, killed, lost or damaged on the way."""

import json
import os
import signal
from concurrent.futures import Future
from dataclasses import dataclass
from functools import partial

import numpy as np
import pytest

from fogproof import HalfLine, InvalidValueError, check_distributed, distributed, sampler_check
from fogproof.errors import InvalidInputError, SubjectError
from fogproof.workers import executors
from fogproof.workers.executors import ClusterError

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


class Hidden:
    """A sampler that draws what it likes, whatever its uniforms are."""

    def sample(self, u):
        return np.random.default_rng().exponential(size=len(u))

    def pdf(self, x):
        return np.exp(-x)


def test_a_sampler_that_ignores_its_uniforms_is_rejected_wherever_it_is_drawn():
    for executor in ("threads", "processes"):
        verdict = check_distributed(partial(check_of, Hidden(), samples=100_000), executor, workers=1)
        rejected = {finding.check for finding in verdict.findings if finding.outcome == "rejected"}
        assert "function of its uniforms" in rejected


def check_by_place(place):
    """Of another rate in every process but the first: as if the code there were another version."""
    return check_of(FreePath(1.0 if os.getpid() == place else 1.01), samples=100_000)


def test_workers_of_another_version_are_told():
    with pytest.raises(InvalidValueError, match="give the workers the same versions of your code"):
        check_distributed(partial(check_by_place, os.getpid()), "processes", workers=1)


def test_what_cannot_be_kept_any_more_is_judged_all_the_same(tmp_path, monkeypatch):
    make, keep = partial(check_of, FreePath(1.5)), tmp_path / "kept.json"
    written = distributed.write_file

    def full(path, content):
        if keep.exists():
            raise InvalidInputError(f"cannot write {path}: No space left on device", str(path))
        return written(path, content)

    monkeypatch.setattr(distributed, "write_file", full)
    with pytest.warns(RuntimeWarning, match="No space left on device; what is drawn is judged, and not kept"):
        assert check_distributed(make, "threads", keep=keep).outcome == "rejected"


def test_what_could_never_be_kept_is_told_before_anything_is_drawn(tmp_path, monkeypatch):
    (tmp_path / "file").write_text("")
    monkeypatch.setattr(distributed.SamplerCheck, "run", None)
    with pytest.raises(InvalidInputError, match="is a file, no folder"):
        check_distributed(partial(check_of, FreePath()), "threads", keep=tmp_path / "file" / "kept.json")


def test_a_cluster_without_workers_is_told(monkeypatch):
    """At the beginning, and when the last one is lost: nobody waits for ever."""
    distributed_package = pytest.importorskip("distributed")

    class Scheduler:
        def __init__(self, *address, **options):
            pass

        def nthreads(self):
            return {}

        def close(self, timeout):
            pass

    monkeypatch.setattr(distributed_package, "Client", Scheduler)
    with pytest.raises(ClusterError, match="has no worker; start one: dask worker tcp://here:1"):
        check_distributed(partial(check_of, FreePath()), "dask://here:1")

    monkeypatch.setattr(distributed, "PATIENCE", 0.01)
    drawing = distributed._Drawing(None, executors.Workers(lambda: None, 1, lambda: 0), None, None)
    with pytest.raises(ClusterError, match="has lost its last worker"):
        drawing._waited_for(Future())


@pytest.mark.parametrize("workers", [0, -1, 1.5])
def test_how_many_workers_there_are_is_a_whole_number(workers):
    with pytest.raises(InvalidValueError, match="workers must"):
        check_distributed(partial(check_of, FreePath()), "threads", workers=workers)
