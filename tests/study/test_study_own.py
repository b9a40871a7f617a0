"""One's own estimator in a study: judged like any other, never mixed with what an older state of its source drew."""

import json
import os
import signal
import subprocess
import sys
import textwrap
import time

import pytest
from study_fixtures import RAY, toml

from fogproof.cli.commands import cli as command
from fogproof.errors import FogproofError
from fogproof.study import read_study, run_study
from fogproof.study.batches import draw_batch
from fogproof.study.cells import cells_of, prepare
from fogproof.study.files import differences
from fogproof.study.methods import own as own_methods
from fogproof.study.plan import batches_of
from fogproof.study.trial import try_own

MINE = """
    import numpy as np
    from helper import FACTOR

    class Analog:
        dimensions = 1

        def __init__(self, scene, scale=1.0):
            self.tau = (scene.built_medium.sigma_a + scene.built_medium.sigma_s) * float(scene.ray.length)
            self.scale = scale
            p = np.exp(-self.tau)
            self.variance = (scale * FACTOR) ** 2 * p * (1 - p)

        def draw(self, rng, n):
            u = rng.random((n, 1))[:, 0]
            return self.scale * FACTOR * (-np.log1p(-u) > self.tau)
"""
SCENE = {"name": "fog", "quantity": "transmittance", "medium": {"sigma_a": 0.2, "sigma_s": 0.3}, "ray": RAY}


def study_file(folder, estimators, text=MINE, factor="1.0", **more):
    folder.mkdir(exist_ok=True)
    (folder / "my_module.py").write_text(textwrap.dedent(text))
    (folder / "helper.py").write_text(f"FACTOR = {factor}\n")
    scenes = [{**SCENE, "estimators": estimators}]
    table = {"samples": [64, 512], "replicates": 8, "batch": 512, "scenes": scenes, **more}
    (folder / "study.toml").write_text(toml(table))
    return folder / "study.toml"


@pytest.mark.parametrize("executor", ["threads", "processes"])
def test_it_is_judged_like_any_other(tmp_path, executor):
    own = [{"kind": "my_module:Analog"}, {"kind": "my_module:Analog", "scale": 2.0}]
    path = study_file(tmp_path / "s", [*own, {"kind": "analog"}], samples=[512, 4096])
    record = run_study(read_study(path), tmp_path / "run", executor=executor, workers=2)
    assert not record["failures"]
    statuses = {e["name"]: e["status"] for e in record["scenes"][0]["estimators"]}
    assert statuses == {
        "my_module:Analog": "passed",
        "my_module:Analog + sobol": "passed",
        "my_module:Analog (scale = 2.0)": "rejected",
        "my_module:Analog (scale = 2.0) + sobol": "rejected",
        "analog": "passed",
        "analog + sobol": "passed",
    }
    assert record["scenes"][0]["estimators"][0]["kind"] == "my_module:Analog"


def test_drawing_is_nothing_but_drawing(tmp_path, monkeypatch):
    """With Sobol points too: what the study wants to know of the class is asked before time is taken."""
    cells = cells_of(read_study(study_file(tmp_path / "s", [{"kind": "my_module:Analog"}])))
    prepare(cells)
    monkeypatch.setattr(own_methods, "digest_of", lambda *_: pytest.fail("sources are read while time is taken"))
    for batch in batches_of(cells):
        assert draw_batch(cells[batch.cell], batch, 0.5).moments[0, 0] == batch.samples


def test_a_changed_source_is_another_study(tmp_path):
    path = study_file(tmp_path / "s", [{"kind": "my_module:Analog"}])
    before = read_study(path)
    prepare(cells_of(before))
    (tmp_path / "elsewhere").mkdir()
    study_file(tmp_path / "elsewhere", [{"kind": "my_module:Analog"}])
    assert read_study(tmp_path / "elsewhere" / "study.toml").fingerprint == before.fingerprint
    study_file(tmp_path / "s", [{"kind": "my_module:Analog"}], factor="3.0")  # what it imports counts as well
    after = read_study(path)
    assert after.fingerprint != before.fingerprint
    assert differences(before.text, after.text) == [
        "scenes[0].estimators[0]: the contents of my_module:Analog have changed"
    ]
    with pytest.raises(FogproofError, match="the sources of my_module:Analog have changed"):
        prepare(cells_of(before))
    (cell, _) = cells_of(after)
    assert float(cell.method.variance(cell.scene).value) > 1  # the new state is what runs
    assert not list(tmp_path.rglob("*.pyc"))  # old bytecode would be taken for an edit of the same second and length


FAULTS = {
    "no module": (MINE, "their_module:Analog", "there is no module their_module in"),
    "no class": (MINE, "my_module:Analogue", "Analogue is not there in the module my_module"),
    "an installed package without it": (MINE, "numpy.nothing:Analog", "the package numpy has no module numpy.nothing"),
    "no function": ("Analog = 3", "my_module:Analog", "Analog is no class in"),
    "syntax": ("def f(:", "my_module:Analog", "my_module.py, line 1: invalid syntax"),
    "import": ("import nothing_here", "my_module:Analog", "cannot import my_module: ModuleNotFoundError"),
    "exit": ("raise SystemExit(2)", "my_module:Analog", "cannot import my_module: the code ends the process, exit code 2"),
    "exit at once": ("import os; os._exit(0)", "my_module:Analog", "cannot import my_module: the code ends the process"),
    "constructor": (MINE.replace("scale=1.0", "size"), "my_module:Analog", "missing 1 required positional argument: 'size'"),
    "no draw": (MINE.replace("def draw", "def drew"), "my_module:Analog", "which has no draw(rng, n)"),
    "ends": (MINE.replace("return self", "raise SystemExit(4) or self"), "my_module:Analog", "draw: SystemExit: 4"),
    "raises": (MINE.replace("return self", "return 1 / 0 + self"), "my_module:Analog", "draw: ZeroDivisionError"),
    "shape": (MINE.replace("return self", "return 1.0; self"), "my_module:Analog", "must return 1 numbers, got shape ()"),
    "dimensions": (MINE.replace("dimensions = 1", "dimensions = 'x'"), "my_module:Analog", "dimensions must be a whole"),
    "no name": (MINE, "my module:Analog", "kind 'my module:Analog'; known are"),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_faults_are_told(tmp_path, name):
    text, kind, words = FAULTS[name]
    path = study_file(tmp_path / "s", [{"kind": kind}], text)
    with pytest.raises(FogproofError) as caught:
        prepare(cells_of(read_study(path)))
    assert words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_what_is_no_number_has_no_bias(tmp_path):
    text = MINE.replace("return self", "return np.nan * self")
    path = study_file(tmp_path / "s", [{"kind": "my_module:Analog"}], text)
    for estimator in run_study(read_study(path), tmp_path / "run")["scenes"][0]["estimators"]:
        assert estimator["status"] == "rejected"
        assert estimator["bias"] is None


DECLARING = """
    import numpy as np
    from fogproof.contracts import Reference

    class Mine:
        {of_class}

        def __init__(self, scene):
            {of_object}

        def draw(self, rng, n):
            return {drawn}
"""


@pytest.mark.parametrize(
    ("name", "value", "rule"),
    [
        (
            "drawn",
            "rng.random(n) * 1j",
            "draw must return real numbers, got dtype complex128; return the real or the imaginary part",
        ),
        ("drawn", "np.array(['1.5'] * n)", "draw must return real numbers, got dtype <U3"),
        ("of_object", "self.variance = -1", "variance must be finite and >= 0, got -1.0; give the exact"),
        ("of_object", "self.variance = 1j", "variance must be a number"),
        ("of_object", "self.variance = [1, 2]", "variance must be a single number"),
        ("of_object", "self.variance = Reference(-0.5, 0.1)", "variance: value must be finite and not below 0 by more"),
        ("of_object", "self.bounds = (1, 0)", "bounds must be two finite numbers"),
        ("of_class", "bias = True", "bias must be a text, got True; say in words why"),
        ("of_class", "title = 3", "title must be a text, got 3"),
        ("of_class", "title = 'z\\ud800'", "title must be free of lone surrogates"),
        ("of_class", "bias = '\\udfff'", "bias must be free of lone surrogates"),
        ("of_class", "title = 'z' * 201", "title must have at most 200 characters"),
    ],
)
def test_what_breaks_its_contract_is_named_before_anything_runs(tmp_path, name, value, rule):
    whole = {"of_class": "pass", "of_object": "pass", "drawn": "rng.random(n)"}
    path = study_file(tmp_path / "s", [{"kind": "my_module:Mine"}], DECLARING.format(**{**whole, name: value}))
    with pytest.raises(FogproofError, match=rf"study\.toml: scene 'fog', my_module:Mine: {rule}"):
        prepare(cells_of(read_study(path)))
    path = study_file(tmp_path / "s", [{"kind": "my_module:Mine"}], DECLARING.format(**whole))
    prepare(cells_of(read_study(path)))


@pytest.mark.parametrize("name", ["", " "])
def test_a_scene_has_a_name(tmp_path, name):
    (tmp_path / "study.toml").write_text(
        toml({"samples": [64], "scenes": [{**SCENE, "name": name, "estimators": ["analog"]}]})
    )
    with pytest.raises(FogproofError, match=r"name must not be blank, got .* give the scene a name"):
        read_study(tmp_path / "study.toml")


ENDING = """
    import os

    class Ending:
        def __init__(self, scene, most=0):
            self.most = most

        def draw(self, rng, n):
            return rng.random(n) if n <= self.most else os._exit(0)
"""


def test_what_ends_its_process_at_its_first_call_is_named_and_nothing_runs(tmp_path):
    path = study_file(tmp_path / "s", [{"kind": "my_module:Ending"}], ENDING)
    with pytest.raises(
        FogproofError, match="scene 'fog', my_module:Ending: the subject ended the process, exit code 0"
    ):
        run_study(read_study(path), tmp_path / "run", executor="processes")
    assert not (tmp_path / "run").exists()


def test_what_ends_its_process_later_costs_its_own_results_alone(tmp_path, capsys, monkeypatch):
    """By the command, which would draw in threads: 0 without a word and a page was the end of that."""
    monkeypatch.setattr("fogproof.study.run.ATTEMPTS", 1)  # a new pool of workers each
    estimators = [{"kind": "my_module:Ending", "most": 64}, {"kind": "analog"}]
    path = study_file(tmp_path / "s", estimators, ENDING, samples=[64, 512, 4096], sobol=False)
    command(["study", str(path), "-o", str(tmp_path / "run"), "--workers", "1"], standalone_mode=False)
    record = json.loads((tmp_path / "run" / "results.json").read_text())
    assert (record["exit_code"], record["executor"]) == (1, "processes")
    assert {failure["estimator"] for failure in record["failures"]} == {"my_module:Ending (most = 64)"}
    assert "this one was not tried" in record["failures"][-1]["error"]
    assert record["scenes"][0]["estimators"][1]["status"] == "passed"
    told = capsys.readouterr().err
    assert (
        told.count("failed 1 times: the worker that drew it died: the subject ended the process, exit code 0, and ")
        == 1
    )
    assert (tmp_path / "run" / "index.html").exists()


def test_what_it_prints_is_no_part_of_the_record(tmp_path):
    spoken = MINE.replace("u = rng.random((n, 1))", "print('drawing'); u = rng.random((n, 1))")
    chatty = "print('loading')\n" + textwrap.dedent(spoken)
    path = study_file(tmp_path / "s", [{"kind": "my_module:Analog"}], chatty)
    words = [sys.executable, "-m", "fogproof", "study", str(path), "-o", str(tmp_path / "out"), "--json"]
    ran = subprocess.run(words, capture_output=True, text=True)
    assert json.loads(ran.stdout)["scenes"], ran.stderr
    assert "drawing" in ran.stderr
    assert "loading" in ran.stderr


def test_who_ignores_the_generator_is_told_before_anything_runs(tmp_path):
    """Hits and misses from one seed; and equal numbers, which need no chance."""
    ignoring = MINE.replace("u = rng.random((n, 1))", "u = np.random.default_rng(5).random((n, 1))")
    with pytest.raises(FogproofError, match="the same realisations though rng is another; take all chance from rng"):
        try_own(read_study(study_file(tmp_path / "a", [{"kind": "my_module:Analog"}], ignoring)))
    three = ignoring.replace("default_rng(5)", "default_rng(int(rng.integers(3)))").replace(
        "(-np.log1p(-u) > self.tau)", "u"
    )
    with pytest.raises(FogproofError, match="take all chance from rng"):
        try_own(read_study(study_file(tmp_path / "c", [{"kind": "my_module:Analog"}], three)))
    exact = MINE.replace("-np.log1p(-u) > self.tau", "0 * u + np.exp(-self.tau)").replace("p * (1 - p)", "0.0")
    try_own(read_study(study_file(tmp_path / "b", [{"kind": "my_module:Analog"}], exact)))


LEAVING = """
    import threading, time

    class Leaving:
        def __init__(self, scene):
            pass

        def draw(self, rng, n):
            threading.Thread(target=time.sleep, args=(600,)).start()
            return rng.random(n)
"""


def test_threads_that_it_leaves_do_not_hold_the_study(tmp_path):
    path = study_file(tmp_path / "s", [{"kind": "my_module:Leaving"}], LEAVING, sobol=False)
    words = [sys.executable, "-m", "fogproof", "study", str(path), "-o", str(tmp_path / "out"), "--workers", "1"]
    ran = subprocess.run(words, capture_output=True, text=True, timeout=300, start_new_session=True)
    assert json.loads((tmp_path / "out" / "results.json").read_text())["state"] == "finished", ran.stderr
    assert (tmp_path / "out" / "index.html").exists()


WAITING = """
    import pathlib, time

    class Waiting:
        def __init__(self, scene):
            pass

        def draw(self, rng, n):
            if n > 64:
                pathlib.Path(__file__).with_name("waits").touch()
                time.sleep(600)
            return rng.random(n)
"""


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
def test_a_stop_says_what_it_waits_for_and_a_second_one_ends_it(tmp_path):
    path = study_file(tmp_path / "s", [{"kind": "my_module:Waiting"}], WAITING, sobol=False)
    words = [sys.executable, "-m", "fogproof", "study", str(path), "-o", str(tmp_path / "out"), "--workers", "1"]
    child = subprocess.Popen(words, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, preexec_fn=heard)
    until = time.monotonic() + 300
    try:
        while not (path.parent / "waits").exists() and time.monotonic() < until:
            time.sleep(0.05)
        child.send_signal(signal.SIGTERM)
        told = child.stderr.readline()
        assert told.startswith(b"fogproof: stopping: waiting for "), told
        assert b"a second signal ends at once" in told
        child.send_signal(signal.SIGTERM)
        assert child.wait(60) == -signal.SIGTERM
    finally:
        child.kill()
        child.wait()
        child.stderr.close()


def heard():
    signal.signal(signal.SIGTERM, signal.SIG_DFL)


def test_a_program_without_a_guard_is_told_of_it_and_the_estimator_is_not_blamed(tmp_path):
    path = study_file(tmp_path / "s", [{"kind": "my_module:Analog"}])
    program = tmp_path / "program.py"
    lines = [
        "from fogproof.study import read_study, run_study",
        "{}run_study(read_study({!r}), {!r}, executor='processes')",
    ]
    for guard in ("", 'if __name__ == "__main__": '):
        program.write_text("\n".join(lines).format(guard, str(path), str(tmp_path / "run")))
        done = subprocess.run([sys.executable, str(program)], capture_output=True, text=True, timeout=120)
        assert (done.returncode == 0) == bool(guard), done.stderr
        assert ('let what it runs stand under `if __name__ == "__main__":`' in done.stderr) != bool(guard)
        assert "the subject ended" not in done.stderr
