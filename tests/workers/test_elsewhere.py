"""`fogproof verify --executor processes --keep DIR`: large cases are drawn by others and kept, and no verdict depends on it."""

import json

import pytest
from fuzz_commands import Run, here

from fogproof.errors import InvalidInputError
from fogproof.reports.files import locked
from fogproof.verify import select
from fogproof.verify.elsewhere import LEAST, Elsewhere
from fogproof.workers import executors

CASES = """
import numpy as np
from fogproof import HalfLine
from fogproof.catalogue import EstimatorCase, SamplerCase

class FreePath:
    domain, dimensions = HalfLine(0), 1
    def sample(self, u):
        return -np.log1p(-u[:, 0])
    def pdf(self, x):
        return np.exp(-x)

class Analog:
    def draw(self, rng, n):
        return (rng.random(n) < 0.5).astype(float)

def cases():
    yield SamplerCase(name="large", make=FreePath, samples=4_200_000)
    yield SamplerCase(name="small", make=FreePath, samples=100_000)
    yield EstimatorCase(name="estimator", make=Analog, reference=0.5, samples=5_000_000)
"""


@pytest.fixture
def mine(tmp_path, monkeypatch):
    (tmp_path / "large.py").write_text(CASES)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def verdicts(*words):
    end = here(Run(["verify", "large.py", "--json", *words]))
    assert end.code == 0, end.err
    record = json.loads(end.out)
    return {case["name"]: [(f["check"], f["p_value"]) for f in case["verdict"]["findings"]] for case in record["cases"]}


def test_no_verdict_depends_on_who_draws_or_on_what_is_kept(mine):
    plain = verdicts("--seed", "5")
    assert len(plain) == 3
    assert verdicts("--executor", "processes", "--keep", "kept", "--seed", "5") == plain
    assert json.loads((mine / "kept" / "seed.json").read_text())["seed"] == 5
    (large,) = (mine / "kept").glob("large-large-*.json")
    tally = json.loads(json.loads(large.read_text())["tally"])
    assert tally["drawn"] == 4_200_000
    assert verdicts("--keep", "kept") == plain  # in threads, of the seed that is kept
    end = here(Run(["verify", "large.py", "--keep", "kept", "--seed", "6"]))
    assert (end.code, b"kept keeps samples of seed 5, not 6; leave --seed out" in end.err) == (2, True)


def test_which_cases_are_worth_it(mine):
    others = Elsewhere("processes", 2)
    assert {case.name for case in select(["large.py"]) if others.draws_for(case)} == {"large/large"}
    assert LEAST <= 4_200_000


@pytest.mark.parametrize(
    "content",
    [
        "",
        "[]",
        '{"seed": 1}',
        '{"schema": "fogproof seed 1", "seed": true}',
        '{"schema": "fogproof seed 1", "seed": -1}',
    ],
)
def test_a_folder_of_somebody_elses_is_left_alone(mine, content):
    (mine / "kept").mkdir()
    (mine / "kept" / "seed.json").write_text(content)
    with pytest.raises(InvalidInputError, match="is no seed of a run; choose another folder"):
        Elsewhere("threads", 1, str(mine / "kept")).seed(None)
    end = here(Run(["verify", "large.py", "--keep", "kept"]))
    assert (end.code, (mine / "kept" / "seed.json").read_text()) == (2, content)


def test_an_executor_that_there_is_not(mine):
    end = here(Run(["verify", "large.py", "--executor", "proc", "--keep", "kept"]))
    assert (end.code, b"must be threads, processes or dask://host:port" in end.err) == (2, True)
    assert not (mine / "kept").exists()


@pytest.mark.parametrize("where", ["dask://", "dask://host", "dask://:1"])
def test_a_cluster_without_an_address(mine, where):
    end = here(Run(["verify", "large.py", "--executor", where]))
    assert (end.code, b"must be threads, processes or dask://host:port" in end.err) == (2, True)


def test_a_cluster_that_does_not_answer_is_told_before_anything_is_drawn(mine, monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr(executors, "PATIENCE", 0.5)
    end = here(Run(["verify", "large.py", "--executor", "dask://127.0.0.1:9"]))
    assert (end.code, b"no Dask scheduler answers" in end.err, b"not rejected" in end.out) == (2, True, False)


@pytest.mark.parametrize("content", ["", "{}", '{"schema": "fogproof tally 1"}'])
def test_kept_samples_that_are_damaged_are_told_before_anything_is_drawn(mine, content):
    (case,) = select(["large.py::large"])
    path = Elsewhere("threads", 1, "kept")._file(case.name)
    path.parent.mkdir()
    path.write_text(content)
    end = here(Run(["verify", "large.py", "--keep", "kept"]))
    assert (end.code, b"remove it, and all is drawn anew" in end.err, b"not rejected" in end.out) == (2, True, False)
    assert path.read_text() == content


def test_two_runs_do_not_keep_samples_in_one_folder(mine):
    (mine / "kept").mkdir()
    with locked(mine / "kept"):
        end = here(Run(["verify", "large.py::small", "--keep", "kept"]))
    assert (end.code, b"another run of fogproof writes into kept" in end.err) == (2, True)
