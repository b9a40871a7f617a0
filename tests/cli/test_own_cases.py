"""One's own file of cases in a run: its faults are sentences, its subjects cannot cost another's result, alpha is shared."""

import json
import multiprocessing
import textwrap
import time
from functools import partial

import pytest
from fuzz_commands import Run, here

from fogproof import verify
from fogproof.catalogue import SamplerCase, all_cases, own
from fogproof.checks import limits
from fogproof.checks.limits import within
from fogproof.checks.streams import batch_generator
from fogproof.errors import FogproofError, InvalidInputError
from fogproof.verify import Result, running

HEAD = """
    import os, time
    import numpy as np
    import fogproof
    from fogproof.catalogue import EstimatorCase, SamplerCase, Twin

    class Exponential:
        domain, dimensions = fogproof.HalfLine(0.0), 1
        def __init__(self, sigma=1.0):
            self.sigma = sigma
        def sample(self, u):
            return -np.log1p(-u[:, 0]) / self.sigma
        def pdf(self, t):
            return np.exp(-t)

    class Estimator:
        def __init__(self, draw):
            self.draw = draw
"""
MINE = (
    HEAD
    + """
    print("printed on the way")
    def cases():
        dead = lambda: Estimator(lambda rng, n: os._exit(3))
        slow = lambda: Estimator(lambda rng, n: time.sleep(1000))
        return [
            SamplerCase(name="right", make=Exponential, samples=20_000, twin=Twin("rate", lambda: Exponential(2.0))),
            SamplerCase(name="wrong", make=lambda: Exponential(2.0), samples=20_000),
            SamplerCase(name="none", make=lambda: 3),
            EstimatorCase(name="mean", make=lambda: Estimator(lambda rng, n: rng.random(n)), reference=0.5, samples=10_000),
            EstimatorCase(name="dead", make=dead, reference=0.5),
            EstimatorCase(name="slow", make=slow, reference=0.5, weight=3),
        ]
"""
)


def written(folder, text, name="my_cases.py"):
    path = folder / name
    path.write_text(textwrap.dedent(text))
    return str(path)


def test_own_cases_run_beside_the_catalogue_and_none_costs_another_its_result(tmp_path):
    path = written(tmp_path, MINE)
    chosen = [case for case in verify.select([path, "fog/analog/haze"]) if case.name != "my_cases/slow"]
    results = {r.case.name: r for r in verify.run(chosen, seed=3, alpha=1e-6, workers=2, twins=True)}
    statuses = {name: result.status for name, result in results.items()}
    assert statuses == {
        "fog/analog/haze": "passed",
        "my_cases/right": "passed",
        "my_cases/wrong": "rejected",
        "my_cases/none": "error",
        "my_cases/mean": "passed",
        "my_cases/dead": "error",
    }
    assert results["my_cases/right"].twin.outcome == "rejected"
    assert results["my_cases/wrong"].twin is None
    assert "has no sample and no pdf" in results["my_cases/none"].reason
    assert "ended the process, exit code 3" in results["my_cases/dead"].reason
    record = verify.record(results.values(), seed=3, alpha=1e-6, command="", started="", seconds=1.0, asked=chosen)
    assert [case["name"] for case in record["cases"]][:2] == ["fog/analog/haze", "my_cases/right"]
    # The command that is said reaches the same verdict.
    (told,) = [case["reproduce"] for case in record["cases"] if case["name"] == "my_cases/right"]
    _, _, quoted, _, seed, _, alpha = told.split()
    (case,) = verify.select([quoted.strip("'")])
    (again,) = verify.run([case], seed=int(seed), alpha=float(alpha), workers=1)
    assert again.verdict.alpha == pytest.approx(results["my_cases/right"].verdict.alpha, rel=1e-15)
    assert [f.p_value for f in again.verdict.findings] == [
        f.p_value for f in results["my_cases/right"].verdict.findings
    ]


def test_a_subject_that_hangs_is_ended(tmp_path):
    chosen = verify.select([written(tmp_path, MINE) + "::slow"])
    (result,) = verify.run(chosen, seed=3, alpha=1e-6, workers=2, time_limit=2)
    assert result.status == "error"
    assert "did not return within 2 s" in result.reason


def test_alpha_is_shared_with_the_file(tmp_path):
    path = written(tmp_path, MINE)
    alone = verify.shares(verify.select([path]), 1e-6)
    assert alone == {path: 1e-6}
    both = verify.shares(verify.select([path, "fog"]), 1e-6)
    assert sum(both.values()) == pytest.approx(1e-6)
    assert both[path] == pytest.approx(1e-6 * 8 / (8 + sum(c.weight for c in all_cases())))


def test_the_command_line_takes_a_file(tmp_path):
    path = written(tmp_path, MINE)
    end = here(Run(["list", path, "--json"]))
    rows = [json.loads(line) for line in end.out.splitlines()]  # nothing that the file prints is in between
    assert [row["name"] for row in rows][:2] == ["my_cases/right", "my_cases/wrong"]
    end = here(Run(["verify", f"{path}::right", "--json", "--seed", "1"]))
    assert json.loads(end.out)["cases"][0]["status"] == "passed"
    assert end.code == 0


FAULTS = {
    "nothing there": (None, "there is no file"),
    "syntax": ("def cases(:\n    pass", "line 1: invalid syntax"),
    "no cases": ("x = 1", "has no function cases()"),
    "none": ("def cases(): return []", "cases() returned none"),
    "no list": ("def cases(): return 3", "TypeError: 'int' object is not iterable"),
    "wrong type": ("def cases(): return [3]", "cases() must return SamplerCase and EstimatorCase"),
    "raises": ("import math\nmath.sqrt(-1)\n", "line 2: ValueError: math domain error"),
    "exits": ("raise SystemExit(3)", "line 1: the code ends the process, exit code 3"),
    "exits at once": ("import os\nos._exit(0)", "line 2: the code ends the process, exit code 0"),
    "exits in cases": ("import os\ndef cases(): os._exit(0)", "line 2: the code ends the process, exit code 0"),
    "lines": ("def cases():\n    raise ValueError('a\\nb')", "line 2: ValueError: a b"),
    "twice": (HEAD + "    def cases(): return 2 * [SamplerCase(name='a', make=Exponential)]\n", "two cases are called 'a'"),
    "make": (HEAD + "    def cases(): return [SamplerCase(name='a', make=Exponential())]\n", "must be a function without"),
    "weight": (HEAD + "    def cases(): return [SamplerCase(name='a', make=Exponential, weight=0)]\n", "must be finite and > 0"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_a_fault_of_the_file_is_one_sentence(tmp_path, name):
    text, words = FAULTS[name]
    path = written(tmp_path, text) if text is not None else str(tmp_path / "none.py")
    with pytest.raises(FogproofError) as caught:
        verify.select([path])
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)
    assert path in str(caught.value)


def test_names_are_told_apart(tmp_path):
    one = written(
        tmp_path, HEAD + "    def cases(): return [SamplerCase(name='analog/haze', make=Exponential)]\n", "fog.py"
    )
    with pytest.raises(InvalidInputError, match="both have a case 'fog/analog/haze'; rename one of them"):
        verify.select(["fog", one])
    with pytest.raises(InvalidInputError, match=r"did you mean .*fog\.py::analog/haze\?"):
        verify.select([f"{one}::analog/hase"])


def test_an_installed_package_offers_cases(monkeypatch):
    class Point:
        name = "lobes"

        def load(self):
            return lambda: [SamplerCase(name="a", make=lambda: None), SamplerCase(name="b", make=lambda: None)]

    monkeypatch.setattr(own.importlib.metadata, "entry_points", lambda **_: [Point()])
    assert [case.name for case in verify.select(["lobes"])] == ["lobes/a", "lobes/b"]
    assert [case.name for case in verify.select(["lobes/b"])] == ["lobes/b"]
    assert [case.origin for case in verify.select(["lobes/b", "fog/analog/haze"])] == ["", "lobes"]


def test_a_generator_of_cases_may_be_endless_only_until_it_is_looked_at(tmp_path):
    path = written(tmp_path, "def cases():\n    while True:\n        yield 1\n", "endless.py")
    with pytest.raises(InvalidInputError, match="cases\\(\\) must return SamplerCase"):
        own.own_cases(path)


def test_a_run_that_is_given_up_ends_what_was_about_to_start(monkeypatch):
    def late(case, seed, share, twins):
        if case.name == first.name:
            return Result(case, "skipped", None, "", 0.0)
        time.sleep(0.3)  # as long as a server of processes may take
        return within(60, partial(time.sleep, 60))

    first, *others = list(all_cases())[:4]
    monkeypatch.setattr(running, "run_case", late)
    started = time.monotonic()
    results = running.run([first, *others], seed=1, alpha=1e-6, workers=2)
    assert next(results).case is first
    results.close()
    assert time.monotonic() - started < 20


def test_no_process_to_be_had_is_the_system_s_fault_not_the_subject_s(monkeypatch):
    class Exhausted:
        Pipe = staticmethod(multiprocessing.Pipe)

        class Process:
            def __init__(self, **_):
                pass

            def start(self):
                raise EOFError

    monkeypatch.setattr(multiprocessing, "get_context", lambda name: Exhausted)
    with pytest.raises(OSError, match=r"no process could be started; end some"):
        within(1, int)


def test_a_file_may_have_any_name_that_a_system_allows():
    draws = [batch_generator(1, name, 0, 0).random() for name in ("a\udcffb/m", "a\udcfeb/m", "\ud800")]
    assert len(set(draws)) == 3


def test_a_name_and_a_file_have_bounds(tmp_path, monkeypatch):
    with pytest.raises(FogproofError, match="at most 200 characters"):
        SamplerCase(name="x" * 201, make=int)
    (tmp_path / "mine.py").write_text("x")
    monkeypatch.setattr(own, "TEXT", 0)
    with pytest.raises(InvalidInputError, match="1 bytes; a file of cases has at most 0"):
        own.own_cases(str(tmp_path / "mine.py"))


LOOPS = {
    "import": "while True: pass",
    "cases": "def cases():\n    while True: pass",
    "end": "import os; os.kill(os.getpid(), 9)",
}


@pytest.mark.parametrize("where", LOOPS)
def test_a_time_limit_bounds_the_listing_of_cases(tmp_path, where):
    """Nor does what ends its process then end ours, which no guard in it could see."""
    path = written(tmp_path, LOOPS[where])
    end = here(Run(["verify", path, "--time-limit", "0.3"]))
    words = "ended the process, exit code -9" if where == "end" else "did not return within 0.3 s"
    assert (end.code, f"its cases cannot be listed: the subject {words}" in end.err.decode()) == (2, True), end.err


MEANS = """
from fogproof.catalogue import EstimatorCase
def cases():
    return [EstimatorCase(name=name, make=lambda by=by: Mean(by), reference=0.5, samples=2000) for name, by in %s]
class Mean:
    def __init__(self, by):
        self.by = by
    def draw(self, rng, n):
        return rng.random(n) + self.by
"""


@pytest.mark.parametrize(("by", "code"), [(0.0, 2), (0.4, 1)])
def test_verdicts_are_kept_where_no_process_starts_for_a_case(tmp_path, monkeypatch, by, code):
    def started(preload, work, *arguments):
        if "my_cases/b" in str(arguments):
            raise limits.UnstartedError(11, "no process could be started")
        return fresh_process(preload, work, *arguments)

    fresh_process = limits.fresh_process
    monkeypatch.setattr(limits, "fresh_process", started)
    path = written(tmp_path, MEANS % [("a", 0.0), ("b", 0.0), ("c", by)])
    end = here(Run(["verify", path, "--workers", "1", "--report", str(tmp_path / "page")]))
    assert (end.code, b"no process could be started\nstopped after 2 of 3 cases" in end.err) == (code, True), end.err
    record = json.loads((tmp_path / "page" / "results.json").read_text())
    assert (record["exit_code"], record["state"], record["title"]) == (code, "interrupted", "Unfinished: 2 of 3")
    assert [case["name"] for case in record["cases"] if case["verdict"]] == ["my_cases/a", "my_cases/c"]
