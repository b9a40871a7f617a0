"""A user's three-line test fails for a wrong sampler and passes for a right one, inside one false-alarm probability a session."""

import json
import os
import re
import subprocess
import sys
import textwrap
from importlib import metadata
from xml.etree import ElementTree

import pytest

RIGHT = """
    import numpy as np

    def test_right(fogproof):
        sample, pdf = lambda u: -np.log1p(-u[:, 0]), lambda t: np.exp(-t)
        fogproof.check_sampler(sample, pdf, fogproof.HalfLine(0.0), dimensions=1, samples=20_000)
"""
WRONG = """
    import numpy as np

    def test_wrong(fogproof):
        sample, pdf = lambda u: u[:, 0] ** 2, lambda x: np.ones(len(x))
        fogproof.check_sampler(sample, pdf, fogproof.Interval(0.0, 1.0), dimensions=1, samples=20_000)
"""
DEAD = """
    import numpy as np

    def test_dead(fogproof):
        fogproof.check_estimator(lambda rng, n: np.zeros(n), 0.3, samples=1000)
"""


def run(folder, text, *options):
    (folder / "test_mine.py").write_text(textwrap.dedent(text))
    return subprocess.run(
        [sys.executable, "-m", "pytest", "-p", "fogproof_pytest", "-p", "no:cacheprovider", "-q", *options, str(folder)],
        capture_output=True, text=True, cwd=folder,
    )  # fmt: skip


@pytest.mark.parametrize("workers", [(), ("-n", "2")], ids=["alone", "xdist"])
def test_right_passes_and_wrong_fails(tmp_path, workers):
    out = run(
        tmp_path, RIGHT + textwrap.dedent(WRONG).replace("\n", "\n    "), *workers, f"--junitxml={tmp_path}/junit.xml"
    )
    assert out.returncode == 1, out.stdout + out.stderr
    assert "1 failed, 1 passed" in out.stdout
    assert "RejectedError" in out.stdout
    assert "fogproof_pytest/checks.py" not in out.stdout  # the user sees his own line
    assert "verdicts: " in out.stdout
    spent, budget = re.search(r"spent: (\S+) of (\S+);", out.stdout).groups()
    assert 0 < float(spent) <= float(budget)
    properties = {p.attrib["value"] for p in ElementTree.parse(tmp_path / "junit.xml").iter("property")}
    assert any("check_sampler: rejected" in value for value in properties)


def test_an_inconclusive_verdict_fails_unless_marked(tmp_path):
    out = run(tmp_path, DEAD)
    assert out.returncode == 1
    assert "an inconclusive verdict is no pass" in out.stdout
    marked = DEAD.replace(
        "    def test", "    import pytest\n\n    @pytest.mark.fogproof(inconclusive='pass')\n    def test"
    )
    assert run(tmp_path, marked).returncode == 0


def test_shares_do_not_depend_on_what_is_selected(tmp_path):
    many = RIGHT + "".join(f"    def test_{i}(fogproof): pass\n" for i in range(9))
    (report,) = [tmp_path / "report"]
    alphas = []
    for selection in ((), ("-k", "right")):
        out = run(tmp_path, many, "--fogproof-report", str(report), "--fogproof-alpha", "1e-4", *selection)
        assert out.returncode == 0, out.stdout
        (case,) = json.loads((report / "results.json").read_text())["cases"]
        alphas.append(case["verdict"]["alpha"])
        assert (report / "index.html").exists()
    assert alphas == [1e-4 / 10 / 2] * 2


def test_the_same_seed_says_the_same(tmp_path):
    seeds = []
    for _ in range(2):
        run(tmp_path, RIGHT, "--fogproof-seed", "7", "--fogproof-report", str(tmp_path / "report"))
        seeds.append(json.loads((tmp_path / "report" / "results.json").read_text())["cases"][0]["verdict"]["seed"])
    assert seeds[0] == seeds[1]
    assert "--fogproof-seed=" in run(tmp_path, RIGHT).stdout


def test_many_checks_in_one_test_spend_no_more_than_its_share(tmp_path):
    text = RIGHT.replace("        fogproof.check", "        for _ in range(5):\n            fogproof.check")
    run(tmp_path, text, "--fogproof-report", str(tmp_path / "report"))
    cases = json.loads((tmp_path / "report" / "results.json").read_text())["cases"]
    assert [case["name"].endswith(f"#{i + 1}") for i, case in enumerate(cases)] == [True] * 5
    assert sum(case["verdict"]["alpha"] for case in cases) <= 1e-6


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (("dimensions=1, samples", "alpha=0.5, dimensions=1, samples"), "alpha is shared out by the session"),
        (("def test_right", "def test_right_"), "1 passed"),
    ],
)
def test_misuse_is_told(tmp_path, change, words):
    assert words in run(tmp_path, RIGHT.replace(*change)).stdout


EVERY = """
    import numpy as np
    from fogproof import Medium, PointLight, Ray
    from fogproof.relations import PathSetting
    from fogproof.scene.shapes import Ball

    def uniform(rng, n):
        return rng.random(n)

    def test_derivative(fogproof):
        fogproof.check_gradient(uniform, 0.5, samples=5000)

    def test_relations(fogproof):
        def render(setting):
            if setting.medium.channels or setting.only is not None:
                raise fogproof.UnsupportedError("grey, all orders")
            return lambda rng, n: setting.light.intensity * (1 + rng.random(n))

        light = PointLight((0.0, 0.0, 4.0), 10.0)
        setting = PathSetting(Medium(0.2, 0.8), Ball((0, 0, 0), 1.0), Ray((3, 0, 0), (-1, 0, 0)), light)
        fogproof.check_relations(render, setting, samples=2000)
"""


def test_checks_that_pass_their_options_on_share_the_budget_and_the_seed(tmp_path):
    out = run(tmp_path, EVERY, "--fogproof-seed=4", "--fogproof-report", str(tmp_path / "report"))
    cases = json.loads((tmp_path / "report" / "results.json").read_text())["cases"]
    derivative = next(case["verdict"] for case in cases if "test_derivative" in case["name"])
    assert derivative["alpha"] == pytest.approx(1e-6 / 4)
    assert derivative["seed"] == 3257402847398839113  # from the session's seed and the name of the test
    relations = [case["verdict"] for case in cases if "test_relations" in case["name"]]
    assert len(relations) > 3, out.stdout
    assert sum(verdict["alpha"] for verdict in relations) <= 1e-6 / 4
    assert "look at" in out.stdout  # this light does not spread as it goes


def test_a_report_that_cannot_be_written_is_told_before_the_tests_run(tmp_path):
    (tmp_path / "file").write_text("")
    out = run(tmp_path, RIGHT, "--fogproof-report", str(tmp_path / "file" / "report"))
    assert out.returncode == 4
    assert "--fogproof-report: cannot write" in out.stderr
    assert "Traceback" not in out.stderr
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "index.html").write_text("mine")
    out = run(tmp_path, RIGHT, "--fogproof-report", str(tmp_path / "other"))
    assert "choose another folder" in out.stderr
    assert "--force" not in out.stderr  # pytest has no such option


def test_a_stopped_session_does_not_look_finished(tmp_path):
    text = RIGHT + "\n    def test_stop():\n        raise KeyboardInterrupt\n"
    out = run(tmp_path, text, "--fogproof-report", str(tmp_path / "report"))
    assert out.returncode == 2
    assert "Unfinished" in (tmp_path / "report" / "index.html").read_text()


def test_wrong_options_are_told(tmp_path):
    assert "must name a folder, got ''" in run(tmp_path, RIGHT, "--fogproof-report", "").stderr
    assert "--fogproof-alpha must lie in (0, 1)" in run(tmp_path, RIGHT, "--fogproof-alpha", "2").stderr
    marked = RIGHT.replace("    def test", "    import pytest\n\n    @pytest.mark.fogproof(wieght=2)\n    def test")
    assert "the marker fogproof knows" in run(tmp_path, marked).stdout + run(tmp_path, marked).stderr


@pytest.mark.parametrize(
    ("mark", "words"),
    [
        ("weight='2'", "weight must be a finite number > 0, got '2'"),
        ("calls=0", "calls must be a whole number >= 1, got 0"),
        ("inconclusive='maybe'", "inconclusive must be 'fail' or 'pass', got 'maybe'"),
        ("3", "give the marker fogproof names, such as weight=3"),
    ],
)
def test_a_wrong_mark_is_told(tmp_path, mark, words):
    out = run(tmp_path, f"import pytest\n@pytest.mark.fogproof({mark})\ndef test_a(fogproof): pass\n")
    assert words in out.stdout + out.stderr
    assert "INTERNALERROR" not in out.stdout + out.stderr


def test_verdicts_of_fixtures_are_told_whenever_they_fall(tmp_path):
    text = """
        import numpy as np
        import pytest

        def mean(fogproof, off=0.0):
            fogproof.check_estimator(lambda rng, n: rng.random(n) + off, 0.5, samples=5000)

        @pytest.fixture
        def before(fogproof):
            mean(fogproof, 0.4)

        @pytest.fixture
        def after(fogproof):
            yield
            mean(fogproof)

        def test_before(before): pass

        def test_after(fogproof, after): mean(fogproof)
    """
    out = run(tmp_path, text, "--fogproof-report", str(tmp_path / "report"))
    assert "verdicts: 1 rejected, 2 not rejected" in out.stdout or "2 not rejected, 1 rejected" in out.stdout
    cases = json.loads((tmp_path / "report" / "results.json").read_text())["cases"]
    assert sorted(case["status"] for case in cases) == ["passed", "passed", "rejected"]


def test_a_test_that_was_not_counted_gets_no_share(tmp_path):
    text = "def test_a(request):\n    request.getfixturevalue('fogproof')\n"
    out = run(tmp_path, text)
    assert out.returncode == 1
    assert "name the fixture among the test's arguments" in out.stdout


NAMES = [("-p", "fogproof_pytest"), ("-p", "no:fogproof")]


@pytest.mark.parametrize("options", NAMES, ids=" ".join)
def test_the_plugin_is_turned_on_and_off_by_its_name(tmp_path, options):
    """Whatever names it, it is there once; turned off, it is not there."""
    if "fogproof" not in {point.name for point in metadata.entry_points(group="pytest11")}:
        pytest.skip("this environment was made before the entry point had its name; `make test` renews it")
    (tmp_path / "test_mine.py").write_text("def test_there(fogproof):\n    pass\n")
    if options[1] == "fogproof_pytest":
        (tmp_path / "conftest.py").write_text("pytest_plugins = ['fogproof_pytest']\n")
    call = [sys.executable, "-m", "pytest", *options, "-p", "no:cacheprovider", "-q", str(tmp_path)]
    out = subprocess.run(call, capture_output=True, text=True, cwd=tmp_path, check=False).stdout
    assert ("fixture 'fogproof' not found" if options[1].startswith("no:") else "1 passed") in out


def test_the_plugin_alone_loads_nothing_heavy():
    code = "import fogproof_pytest, sys; print([m for m in ('numpy', 'fogproof', 'scipy') if m in sys.modules])"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout.strip() == "[]"


LOST = """
    import threading
    import numpy as np
    import pytest

    go = threading.Event()

    def reject(fogproof):
        fogproof.check_estimator(lambda rng, n: rng.random(n), 0.9, samples=2000)

    def test_thread(fogproof):
        thread = threading.Thread(target=reject, args=(fogproof,))
        thread.start()
        thread.join()

    def test_caught(fogproof):
        with pytest.raises(AssertionError):
            reject(fogproof)

    def test_skipped(fogproof):
        try:
            reject(fogproof)
        except AssertionError:
            pytest.skip("flaky")

    def test_xfailed(fogproof):
        try:
            reject(fogproof)
        except AssertionError:
            pytest.xfail("no")

    @pytest.mark.xfail(raises=ZeroDivisionError)
    def test_divides(fogproof):
        try:
            reject(fogproof)
        except AssertionError:
            pass
        1 / 0

    @pytest.mark.xfail(raises=(ZeroDivisionError, AssertionError))
    def test_either(fogproof):
        test_divides(fogproof)

    @pytest.mark.xfail(raises=KeyError)
    def test_renamed(fogproof):
        try:
            reject(fogproof)
        except AssertionError:
            raise KeyError

    @pytest.mark.xfail(raises=Exception)
    def test_xpassed(fogproof):
        try:
            reject(fogproof)
        except AssertionError:
            pass

    def test_running(fogproof):
        begun = threading.Event()
        slow = lambda rng, n: (begun.set(), go.wait(60), rng.random(n))[-1]
        pytest.running = threading.Thread(target=lambda: fogproof.check_estimator(slow, 0.5, samples=2))
        pytest.running.start()
        begun.wait()

    @pytest.mark.xfail
    def test_expected(fogproof):
        go.set()
        pytest.running.join()  # its verdict belongs to this test's report, not to a later one's
        reject(fogproof)

    def test_kept(fogproof):
        pytest.kept = fogproof

    def test_later():
        reject(pytest.kept)
"""


def test_a_rejection_fails_its_test_whoever_catches_it(tmp_path):
    out = run(tmp_path, LOST, "-rA", "-W", "ignore", "--fogproof-report", str(tmp_path / "report"))
    outcomes: dict[str, str] = {}
    for found, test in re.findall(r"^([A-Z]+) test_mine.py::(\w+)", out.stdout, re.M):
        outcomes[test] = f"{outcomes.get(test, '')} {found}".strip()
    assert outcomes == {
        "test_thread": "FAILED",
        "test_caught": "FAILED",
        "test_skipped": "FAILED",
        "test_xfailed": "FAILED",
        "test_divides": "FAILED",
        "test_either": "XFAIL",
        "test_renamed": "XFAIL",
        "test_xpassed": "FAILED",
        "test_running": "PASSED ERROR",
        "test_expected": "XFAIL",
        "test_kept": "PASSED",
        "test_later": "FAILED",
    }, out.stdout
    assert "check_estimator: rejected, though the exception has not ended the test" in out.stdout
    assert "check_estimator still runs where test_running ends" in out.stdout
    assert "called by the fixture of test_mine.py::test_kept, which had ended" in out.stdout
    cases = json.loads((tmp_path / "report" / "results.json").read_text())["cases"]
    assert [case["status"] for case in cases if "running" not in case["name"]] == ["rejected"] * 9


FORKS = """
    import multiprocessing, os

    def test_wrong(fogproof):
        fogproof.check_estimator(lambda rng, n: rng.random(n), 0.5, samples=2000)
        child = os.fork()
        if child == 0:
            try:
                fogproof.check_estimator(lambda rng, n: rng.random(n), 0.9, samples=2000)
            finally:
                os._exit(0)
        os.waitpid(child, 0)

    def test_right(fogproof):
        check = lambda: fogproof.check_estimator(lambda rng, n: rng.random(n), 0.5, samples=2000)
        child = multiprocessing.get_context("fork").Process(target=check)
        child.start()
        child.join()
"""


@pytest.mark.skipif(sys.platform == "win32", reason="needs a system that can fork")
@pytest.mark.parametrize("workers", [(), ("-n", "1")], ids=["alone", "xdist"])
def test_a_rejection_in_a_forked_process_is_not_lost(tmp_path, workers):
    out = run(tmp_path, FORKS, *workers, f"--fogproof-report={tmp_path}/page")
    assert (out.returncode, "1 error" in out.stdout) == (1, True), out.stdout + out.stderr
    assert re.search("check_estimator: rejected, though the exception has not ended the test", out.stdout)
    cases = json.loads((tmp_path / "page" / "results.json").read_text())["cases"]
    told = sorted((case["name"].removeprefix("test_mine.py::"), case["status"]) for case in cases)
    assert told == [("test_right", "passed"), ("test_wrong #1", "passed"), ("test_wrong #2", "rejected")]


AFTER = """
    import pytest

    @pytest.hookimpl(tryfirst=True)
    def pytest_sessionfinish():
        if kept := getattr(pytest, "kept", None):
            with pytest.raises(Exception):
                kept.check_estimator(lambda rng, n: rng.random(n), 0.9, samples=2000)
"""


@pytest.mark.parametrize("workers", [(), ("-n", "1")], ids=["alone", "xdist"])
def test_what_comes_after_the_last_test_fails_the_session(tmp_path, workers):
    (tmp_path / "conftest.py").write_text(textwrap.dedent(AFTER))
    out = run(tmp_path, "def test_mine(fogproof): __import__('pytest').kept = fogproof", *workers)
    assert "1 passed" in out.stdout
    assert out.returncode == 1
    assert (
        "so that the session fails: check_estimator was called by the fixture of test_mine.py::test_mine" in out.stdout
    )


OUTLIVES = """
    import threading, time

    def later(check, ended):
        while not ended():
            time.sleep(0.01)
        time.sleep(1)
        check(lambda rng, n: rng.random(n), 0.9, samples=2000)

    def test_mine(fogproof):
        check = fogproof.check_estimator
        threading.Thread(target=later, args=(check, lambda: not threading.main_thread().is_alive())).start()
"""


def test_a_thread_that_outlives_the_session_is_not_silent(tmp_path):
    out = run(tmp_path, OUTLIVES, "-p", "no:threadexception")
    assert "1 passed" in out.stdout
    assert out.returncode == 1
    assert "after the session had ended, so that the process fails: check_estimator was called by" in out.stderr


def test_a_test_that_ends_its_worker_is_on_the_page(tmp_path):
    dead = RIGHT + "\n    def test_dead(fogproof):\n        __import__('os')._exit(3)\n"
    out = run(tmp_path, dead, "-n", "1", f"--fogproof-report={tmp_path}/report")
    assert out.returncode == 1
    cases = json.loads((tmp_path / "report" / "results.json").read_text())["cases"]
    (lost,) = (case for case in cases if case["name"] == "test_mine.py::test_dead")
    assert (lost["status"], "ended before it was finished" in lost["reason"]) == ("error", True)
    assert "test_mine.py::test_dead" in (tmp_path / "report" / "index.html").read_text()
    assert len(cases) == 2


def test_a_rejection_is_not_taken_back_by_the_end_of_the_session(tmp_path):
    stop = """
    import pytest

    def test_stop():
        pytest.exit("done", returncode=0)
    """
    out = run(tmp_path, textwrap.dedent(WRONG) + textwrap.dedent(stop), f"--fogproof-report={tmp_path}/page")
    assert out.returncode == 1, out.stdout + out.stderr
    assert "verdicts: 1 rejected" in out.stdout
    assert run(tmp_path, textwrap.dedent(RIGHT) + textwrap.dedent(stop)).returncode == 0


TAKING_BACK = {
    "hook": """
    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(session):
        session.exitstatus = 0
    """,
    "fixture": """
    @pytest.fixture(autouse=True)
    def calm(request):
        yield
        session = request.session
        session.testsfailed = 0
        request.config.add_cleanup(lambda: setattr(session, "exitstatus", 0))
    """,
}


@pytest.mark.parametrize("way", TAKING_BACK)
def test_a_rejection_is_not_taken_back_by_an_exit_status(tmp_path, way):
    (tmp_path / "conftest.py").write_text("import pytest\n" + textwrap.dedent(TAKING_BACK[way]))
    assert run(tmp_path, WRONG).returncode == 1


@pytest.mark.parametrize(("text", "code"), [(RIGHT, 4), (WRONG, 1)], ids=["right", "wrong"])
def test_a_report_that_cannot_be_written_at_the_end_is_told(tmp_path, text, code):
    full = """
        import os
        import pytest

        def replace(*_):
            raise OSError(28, "No space left on device")

        @pytest.hookimpl(tryfirst=True)
        def pytest_sessionfinish():
            os.replace = replace
    """
    (tmp_path / "conftest.py").write_text(textwrap.dedent(full))
    out = run(tmp_path, text, f"--fogproof-report={tmp_path}/page")
    assert (out.returncode, "1 passed" in out.stdout) == (code, code == 4), out.stdout + out.stderr
    assert "--fogproof-report: cannot write" in out.stdout
    assert "No space left on device" in out.stdout
    assert "Traceback" not in out.stdout + out.stderr


@pytest.mark.parametrize("workers", [(), ("-n", "1")], ids=["alone", "xdist"])
def test_a_rejection_is_not_taken_back_by_another_try(tmp_path, workers):
    """A subject that ignores its generator would get as many tries as it likes."""
    text = """
        import numpy as np

        tries = []

        def test_moody(fogproof):
            tries.append(1)
            k = 2 if len(tries) == 1 else 1
            sample, pdf = lambda u: u[:, 0] ** k, lambda x: np.ones(len(x))
            fogproof.check_sampler(sample, pdf, fogproof.Interval(0.0, 1.0), dimensions=1, samples=20_000)

        def test_slips(fogproof):
            tries.append(1)
            fogproof.check_estimator(lambda rng, n: rng.random(n), 0.5, samples=1000)
            assert len(tries) > 3
    """
    out = run(tmp_path, text, "--reruns", "3", f"--fogproof-report={tmp_path}/page", *workers)
    assert out.returncode == 1, out.stdout + out.stderr
    assert "2 passed" in out.stdout
    assert re.search("verdicts: (1 rejected, 1 not rejected|1 not rejected, 1 rejected)\n", out.stdout), out.stdout
    assert "rejected, and run again" in out.stdout
    record = json.loads((tmp_path / "page" / "results.json").read_text())
    assert sorted(case["status"] for case in record["cases"]) == ["passed", "rejected"]
    assert record["exit_code"] == 1
    right = run(tmp_path, text.replace("k = 2 if", "k = 1 if"), "--reruns", "3", *workers)
    assert right.returncode == 0, right.stdout + right.stderr


ENDED = """
    import os, signal

    def end():
        {how}

    def test_last(fogproof):
        try:
            test_wrong(fogproof)
        except BaseException:
            pass
        end()
"""


@pytest.mark.skipif(os.name != "posix", reason="needs signals")
@pytest.mark.parametrize("how", ["os._exit(0)", "os.kill(os.getpid(), 9)", "os.kill(os.getpid(), 15)"])
def test_what_a_session_had_found_when_it_was_ended_is_kept(tmp_path, how):
    """Beside what an earlier session had found in the same folder, which looks finished."""
    folder = tmp_path / "page"
    option = f"--fogproof-report={folder}"
    assert run(tmp_path, RIGHT, option).returncode == 0
    text = textwrap.dedent(RIGHT) + textwrap.dedent(WRONG) + textwrap.dedent(ENDED.format(how=how))
    run(tmp_path, text, option)
    assert not (folder / "index.html").exists()
    made = subprocess.run([sys.executable, "-m", "fogproof", "report", str(folder)], capture_output=True, text=True)
    told = [name in made.stderr for name in ("had rejected", "::test_wrong", "::test_last", "::test_right")]
    assert (made.returncode, told) == (1, [True, True, True, False]), made.stderr
    record = json.loads((folder / "results.json").read_text())
    found = {case["name"].rpartition("::")[2]: case["status"] for case in record["cases"]}
    assert (found, record["state"]) == (
        {"test_right": "passed", "test_wrong": "rejected", "test_last": "rejected"},
        "interrupted",
    )
    assert "nfinished" in (folder / "index.html").read_text()


def test_what_a_worker_had_found_when_it_was_ended_is_on_the_page(tmp_path):
    text = textwrap.dedent(RIGHT) + textwrap.dedent(WRONG) + textwrap.dedent(ENDED.format(how="os._exit(0)"))
    out = run(tmp_path, text, "-n", "2", f"--fogproof-report={tmp_path}/report")
    assert out.returncode == 1
    record = json.loads((tmp_path / "report" / "results.json").read_text())
    last = [case["status"] for case in record["cases"] if "test_last" in case["name"]]
    assert (sorted(last), record["state"], len(record["cases"])) == (["error", "rejected"], "finished", 4)


CRASHES = """
    import os, pathlib, shutil, tempfile

    def test_crashes(fogproof):
        flag = pathlib.Path("flag")
        if not flag.exists():
            flag.touch()
            shutil.rmtree(tempfile.gettempdir())
            {find}
            os._exit(0)
        fogproof.check_estimator(lambda rng, n: rng.random(n), 0.5, samples=2000)
"""
FIND = {
    "rejected": "try: fogproof.check_estimator(lambda rng, n: rng.random(n), 0.9, samples=2000)",
    "forked": "try: os.fork() or fogproof.check_estimator(lambda rng, n: rng.random(n), 0.9, samples=2000); os.wait()",
    "right": "try: fogproof.check_estimator(lambda rng, n: rng.random(n), 0.5, samples=2000)",
}


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs to fork, and to remove what is open")
@pytest.mark.parametrize(("find", "page"), [("rejected", False), ("forked", True), ("right", True)])
def test_another_try_takes_no_rejection_back_where_the_first_ended_its_worker(tmp_path, monkeypatch, find, page):
    """Though the test empties the folder of temporary files."""
    (tmp_path / "t").mkdir()
    monkeypatch.setenv("TMPDIR", str(tmp_path / "t"))
    text = CRASHES.format(find=f"{FIND[find]}\n            except BaseException: pass")
    out = run(tmp_path, text, "-n", "1", "--reruns", "1", *([f"--fogproof-report={tmp_path}/page"] if page else []))
    assert "1 passed, 1 rerun" in out.stdout, out.stdout + out.stderr
    assert out.returncode == (find != "right")
    assert ("rejected, and run again; the seed is the same" in out.stdout) == (find != "right")
    if page:
        record = json.loads((tmp_path / "page" / "results.json").read_text())
        assert [case["status"] for case in record["cases"]] == ["passed" if find == "right" else "rejected"]
        assert record["exit_code"] == (find != "right")


@pytest.mark.skipif(not hasattr(os, "fork"), reason="needs to fork")
def test_what_a_forked_process_had_found_is_kept_once(tmp_path):
    forks = """
        import os

        def test_forks(fogproof):
            child = os.fork()
            if not child:
                try:
                    test_wrong(fogproof)
                finally:
                    os._exit(0)
            os.waitpid(child, 0)
            {then}
    """
    for then, state, count in (("os._exit(0)", "interrupted", 2), ("pass", "finished", 2)):
        text = textwrap.dedent(WRONG) + textwrap.dedent(forks.replace("{then}", then))
        run(tmp_path, text, f"--fogproof-report={tmp_path}/{state}")
        record = json.loads((tmp_path / state / "results.json").read_text())
        assert [case["status"] for case in record["cases"]] == ["rejected"] * count
        assert record["state"] == state
