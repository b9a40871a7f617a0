"""Subjects that kill their parent, raise what means Ctrl-C, or write to stdout: told as theirs, and no other's result is lost."""

import json
import multiprocessing.forkserver
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
from pathlib import Path

import pytest
from fuzz_commands import Run, here
from study_fixtures import RAY, toml

from fogproof import servers
from fogproof.checks.limits import fresh_process, isolated, within
from fogproof.errors import Stopped, SubjectError, is_stop, stop_behind

POSIX = pytest.mark.skipif(os.name != "posix", reason="needs a system that can fork")
CONSOLE = [sys.executable, "-c", "import sys; sys.path.pop(0); from fogproof_command import main; main()"]
HOSTILE = """
import atexit, ctypes, os, signal, sys
import numpy as np

C = ctypes.CDLL(None)

def write(word):
    print(f"{word} print", flush=True)
    sys.__stdout__.write(f"{word} __stdout__")
    os.write(1, f"{word} os".encode())
    os.system(f"echo {word} shell")
    C.printf(f"{word} C".encode())  # its buffer is written at the end of the process

write("loading")
atexit.register(write, "ending")

class Draw:
    def __init__(self, scene=None, what="", most=0):
        self.what, self.most = what, most

    def draw(self, rng, n):
        if n > self.most:
            hostile(self.what)
        return (rng.random(n) < np.exp(-1)).astype(float)

class End(BaseException):
    pass

def hostile(what):
    if what == "parent":
        os.kill(os.getppid(), signal.SIGKILL)
    elif what == "group":
        os.killpg(os.getpgid(os.getppid()), signal.SIGKILL)
    elif what == "terminate":
        os.kill(os.getppid(), signal.SIGTERM)
    elif what == "child":
        if os.fork() == 0:
            os.kill(os.getppid(), signal.SIGKILL)
            os._exit(0)
        os.wait()
    elif what == "stop":
        raise KeyboardInterrupt
    elif what == "generator":
        raise GeneratorExit
    elif what == "end":
        raise End
    elif what == "writes":
        write("drawing")
"""
CASES = """
from fogproof.catalogue import EstimatorCase
def cases():
    return [EstimatorCase(name=what or "right", make=lambda what=what: Draw(None, what), reference=np.exp(-1), samples=10_000)
            for what in ("parent", "", "group", "terminate", "child", "stop", "generator", "end", "writes")]
"""
SCENE = {"name": "fog", "quantity": "transmittance", "medium": {"sigma_a": 0.2, "sigma_s": 0.3}, "ray": RAY}
KILLED = "killed the process that had started it"


def ran(words, folder):
    done = subprocess.run([*CONSOLE, *words], cwd=folder, capture_output=True, text=True, timeout=300)
    assert "Traceback" not in done.stderr
    assert done.stdout, done.stderr
    return done, json.loads(done.stdout)  # that and nothing else


@POSIX
def test_cases(tmp_path):
    (tmp_path / "mine.py").write_text(HOSTILE + CASES)
    done, record = ran(["verify", "mine.py", "--seed", "1", "--json"], tmp_path)
    assert done.returncode == record["exit_code"] == 1
    found = {case["name"].removeprefix("mine/"): case for case in record["cases"]}
    for name, words in {
        "parent": KILLED,
        "terminate": KILLED,
        "group": KILLED,
        "child": "ended the process, exit code -9",
        "stop": "draw(rng, n) raised KeyboardInterrupt",
        "generator": "draw(rng, n) raised GeneratorExit",
        "end": "End",
    }.items():
        assert (found[name]["status"], words in found[name]["reason"]) == ("error", True), found[name]
    assert {found[name]["status"] for name in ("right", "writes")} == {"passed"}
    for word in ("loading", "drawing", "ending"):
        for way in ("print", "__stdout__", "os", "shell", "C"):
            assert f"{word} {way}" in done.stderr


def study(folder, *estimators):
    (folder / "mine.py").write_text(HOSTILE)
    table = {"samples": [64, 512], "replicates": 4, "batch": 512, "sobol": False}
    own = [{"kind": "mine:Draw", **options} for options in estimators]
    (folder / "study.toml").write_text(toml({**table, "scenes": [{**SCENE, "estimators": ["analog", *own]}]}))
    return ["study", str(folder / "study.toml"), "-o", str(folder / "out"), "--workers", "1"]


def statuses(record):
    return {estimator["name"]: estimator["status"] for estimator in record["scenes"][0]["estimators"]}


@POSIX
def test_estimators_that_write_and_raise(tmp_path):
    hostile = [{"what": what, "most": 64} for what in ("stop", "generator", "end")]
    words = study(tmp_path, {"what": "writes"}, *hostile)
    done, record = ran([*words, "--json"], tmp_path)
    assert (done.returncode, record["state"]) == (1, "finished")
    failed = {failure["estimator"].split()[-1]: failure["error"] for failure in record["failures"]}
    assert failed.keys() == {"stop)", "generator)", "end)"}
    assert "draw: KeyboardInterrupt" in failed["stop)"]
    assert statuses(record)["analog"] == statuses(record)["mine:Draw (what = writes)"] == "passed"
    assert "drawing C" in done.stderr


@POSIX
@pytest.mark.parametrize("what", ["parent", "group"])
def test_an_estimator_that_kills_its_parent(tmp_path, monkeypatch, what):
    monkeypatch.setattr("fogproof.study.run.ATTEMPTS", 1)  # a new pool of workers each
    words = study(tmp_path, {"what": what, "most": 64})
    assert here(Run(words)).code == 1
    record = json.loads((tmp_path / "out" / "results.json").read_text())
    assert {failure["estimator"] for failure in record["failures"]} == {f"mine:Draw (most = 64, what = {what})"}
    assert "the worker that drew it died" in record["failures"][0]["error"]
    assert statuses(record)["analog"] == "passed"
    assert (tmp_path / "out" / "index.html").exists()


@pytest.mark.parametrize("what", ["KeyboardInterrupt", "GeneratorExit", "type('End', (BaseException,), {})"])
def test_loading(tmp_path, monkeypatch, what):
    """In this process, where a signal could have been meant."""
    monkeypatch.chdir(tmp_path)
    Path("mine.py").write_text(f"raise {what}")
    end = here(Run(["verify", "mine.py"]))
    assert (end.code, b"mine.py: line 1: the code raises " in end.err) == (2, True), end.err


@POSIX
def test_a_signal_while_somebody_elses_file_is_loaded_is_a_stop(tmp_path):
    (tmp_path / "mine.py").write_text("import time\nprint('loading', flush=True)\ntime.sleep(60)")

    def hearing():
        signal.signal(signal.SIGINT, signal.default_int_handler)

    child = subprocess.Popen(
        [*CONSOLE, "verify", "mine.py"], cwd=tmp_path, stderr=subprocess.PIPE, text=True, preexec_fn=hearing
    )
    assert child.stderr.readline() == "loading\n"
    child.send_signal(signal.SIGINT)
    _, told = child.communicate(timeout=60)
    assert (child.returncode, told.strip()) == (130, "fogproof: stopped")


def test_what_is_a_stop():
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        assert is_stop(KeyboardInterrupt())  # Python's own handler
        signal.signal(signal.SIGINT, signal.SIG_IGN)
        assert not is_stop(KeyboardInterrupt())
        assert stop_behind(KeyboardInterrupt()) is None
        assert is_stop(Stopped(signal.SIGTERM))
        assert not is_stop(GeneratorExit())
    finally:
        signal.signal(signal.SIGINT, before)


def kills_its_parent():
    os.kill(os.getppid(), signal.SIGKILL)
    return 3


def stops_its_parent():
    os.kill(os.getppid(), signal.SIGSTOP)
    os.kill(os.getppid(), signal.SIGCONT)
    return 3


def says_later(say):
    time.sleep(1)
    say("later")


def leaves_its_parent_stopped():
    os.kill(os.getppid(), signal.SIGSTOP)
    return 3


def stops_itself():
    os.kill(os.getpid(), signal.SIGSTOP)
    return 3


def closes_and_opens_files():
    os.closerange(3, 4096)  # a test runner may have many open
    for number in range(32):
        os.open(f"file{number}", os.O_CREAT | os.O_RDWR)


@POSIX
@pytest.mark.parametrize(
    "run", [lambda check: isolated(check, 60), lambda check: within(60, check)], ids=["isolated", "within"]
)
def test_the_last_thing_it_does_is_seen(run):
    with pytest.raises(SubjectError, match=KILLED):
        run(kills_its_parent)
    assert run(stops_its_parent) == 3
    assert run(leaves_its_parent_stopped) == 3
    assert run(stops_itself) == 3


@POSIX
def test_a_server_of_processes_that_is_killed_is_started_again():
    assert isolated(int) == 0
    os.kill(multiprocessing.forkserver._forkserver._forkserver_pid, signal.SIGKILL)
    assert isolated(int) == 0


@POSIX
def test_a_server_of_processes_that_is_stopped_is_told_to_go_on():
    assert isolated(int) == 0
    server = multiprocessing.forkserver._forkserver._forkserver_pid
    os.kill(server, signal.SIGSTOP)
    found = []
    asking = threading.Thread(target=lambda: found.append(isolated(int)), daemon=True)
    asking.start()
    asking.join(30)
    os.kill(server, signal.SIGCONT)
    assert found == [0]


@POSIX
@pytest.mark.parametrize("whole", [False, True], ids=["its socket", "all temporary files"])
def test_a_server_of_processes_whose_folder_is_removed_is_started_again(monkeypatch, whole):
    """Beside another subject, which is still waited for."""
    temporary = tempfile.mkdtemp()  # of a path that is short enough for sockets
    monkeypatch.setattr(tempfile, "tempdir", temporary)
    monkeypatch.setitem(multiprocessing.current_process()._config, "tempdir", None)
    servers.end()
    time.sleep(servers.ENDING)
    beside = fresh_process((), says_later)
    try:
        assert Path(servers.folder()).parent == Path(temporary)
        shutil.rmtree(temporary if whole else servers.folder())
        assert isolated(int) == 0
        assert os.path.isdir(servers.folder())
        assert beside.answer(60) == "later"
    finally:
        beside.end()
        shutil.rmtree(temporary, ignore_errors=True)


@POSIX
def test_no_question_is_written_into_its_files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(SubjectError):
        within(60, closes_and_opens_files)
    assert not any(b"?" in file.read_bytes() for file in tmp_path.iterdir())


WRITES = """
import contextlib, os, time
def writes():
    for number in range(3, 64):
        with contextlib.suppress(OSError):
            os.write(number, b"\\n\\n\\n\\n\\n")
def writes_and_never_returns():
    writes()
    time.sleep(600)
"""


@POSIX
def test_a_subject_that_writes_into_every_file_it_finds(tmp_path):
    """In a process of its own, whose files are nobody else's."""
    (tmp_path / "subject.py").write_text(WRITES)
    code = """if True:
        from fogproof.checks import limits
        from subject import writes, writes_and_never_returns
        for run in (
            lambda: limits.isolated(writes),
            lambda: limits.isolated(writes),
            lambda: limits.within(60.0, writes),
            lambda: limits.within(1.0, writes_and_never_returns),
        ):
            try:
                run()
            except Exception as error:
                print(f"{type(error).__name__}: {error}")
    """
    there = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=there, timeout=60)
    told = done.stdout.splitlines()
    assert len(told) == 4, done.stderr
    assert all(line.startswith("SubjectError: the subject wrote into files that others had opened") for line in told), (
        told
    )
    assert done.stderr.strip() == ""  # neither multiprocessing's server nor its watcher has read it


@POSIX
def test_main_in_a_callers_process_leaves_its_stdout_alone():
    code = textwrap.dedent("""
        import os, sys
        from fogproof.cli import main
        try:
            main(["list", "fog/analog/haze"])
        except SystemExit:
            pass
        os.write(1, b"mine")
    """)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.stdout[:15], done.stdout[-4:]) == ("fog/analog/haze", "mine"), done


@POSIX
def test_what_a_subject_writes_is_not_on_a_callers_stdout():
    code = """if True:
        import functools, os
        from fogproof.checks.limits import isolated
        isolated(functools.partial(os.write, 1, b"theirs"))
        print("mine")
    """
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert (done.stdout, "theirs" in done.stderr) == ("mine\n", True)


BREAKING = """
import contextlib, os, signal, threading, time
import numpy as np

def everywhere():
    for number in range(3, 64):
        with contextlib.suppress(OSError):
            os.write(number, b"a line of a log\\n")

def now_and_then():
    while True:
        time.sleep(0.005)
        everywhere()

class Breaks:
    def __init__(self, scene, what):
        self.what = what
        self.share = np.exp(-scene.ray.length * (scene.built_medium.sigma_a + scene.built_medium.sigma_s))

    def draw(self, rng, n):
        if n > 64 and self.what == "writes":
            everywhere()
        if n > 64 and self.what in ("thread", "later"):
            threading.Thread(target=now_and_then, daemon=True).start()
            time.sleep(0.05 if self.what == "thread" else 0.0)
        if n > 64 and self.what.startswith("stops"):
            os.kill(os.getppid(), signal.SIGSTOP)
        if n > 64 and self.what == "stops and raises":
            raise RuntimeError("no more")
        if n > 64 and self.what == "stops and ends":
            os._exit(7)
        return (rng.random(n) < self.share).astype(float)
"""


DIES = "the worker that drew it died: the subject "
COSTS = {
    "writes": f"{DIES}wrote into files that others had opened",
    "thread": f"{DIES}wrote into files that others had opened",
    "stops and raises": "draw: RuntimeError: no more",
    "stops and ends": f"{DIES}ended the process, exit code 7",
    "stops": "",
    "later": None,  # nobody knows whether its batch is over by then
}


@POSIX
def test_nothing_that_an_estimator_does_to_its_worker_holds_the_study_or_costs_another(tmp_path):
    (tmp_path / "mine.py").write_text(BREAKING)
    scene = {**SCENE, "estimators": [*({"kind": "mine:Breaks", "what": what} for what in COSTS), "analog"]}
    table = {"samples": [64, 512], "replicates": 4, "batch": 512, "sobol": False, "scenes": [scene]}
    (tmp_path / "study.toml").write_text(toml(table))
    code = """if True:
        import json
        from fogproof.study import read_study, run_study
        print(json.dumps(run_study(read_study("study.toml"), "out", executor="processes", workers=2)))
    """
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=tmp_path, timeout=100)
    record = json.loads(done.stdout)
    errors = {}
    for failure in record["failures"]:
        if "was not tried" not in failure["error"]:
            errors[failure["estimator"]] = failure["error"]
    for what, words in COSTS.items():
        told = errors.pop(f"mine:Breaks (what = {what})", "")
        assert words is None or (words in told and bool(words) == bool(told)), (what, told)
    assert not errors
    assert (statuses(record)["analog"], "Traceback" in done.stderr) == ("passed", False)
