"""What stands in the way of a start is a sentence: too little memory, a file in a module's place; pipes are waited for."""

import contextlib
import os
import signal
import subprocess
import sys
import threading
import time
import types
from functools import partial
from pathlib import Path

import numpy as np
import pytest
from fuzz_commands import Run, here

from fogproof import input_files, servers
from fogproof.checks.limits import end_isolated, isolated
from fogproof.children import carrying
from fogproof.cli import signals
from fogproof.cli.signals import Listening, Stopped
from fogproof.errors import InvalidInputError, TimeLimitError
from fogproof.input_files import read_requests
from fogproof.oracle.limits import within
from fogproof.reports.files import write_output
from fogproof_command.startup import BAD_INPUT, FAULT, end_of, shadowed

POSIX = pytest.mark.skipif(os.name != "posix", reason="needs signals and pipes")
CONSOLE = [sys.executable, "-c", "import sys; sys.path.pop(0); from fogproof_command import main; main()"]
CASES = """
import os, time
import numpy as np
from fogproof.catalogue import EstimatorCase
os.chdir("/")
class Mean:
    def draw(self, rng, n):
        if os.fork() == 0:
            time.sleep(60)
            os._exit(0)
        return rng.random(n)
def cases():
    return [EstimatorCase(name="mean", make=Mean, reference=0.5, samples=1000)]
"""


def raised(error, behind=None):
    try:
        raise error from behind
    except Exception as caught:
        return caught


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        ImportError("x.so: failed to map segment from shared object"),
        ImportError("x.so: cannot allocate memory in static TLS block"),
        raised(ImportError("numpy is badly installed"), MemoryError()),
    ],
)
def test_too_little_memory_is_no_fault(error):
    assert end_of(error) == ("there is not enough memory to load what this needs; allow more (ulimit -v)", BAD_INPUT)


def test_any_other_error_is_a_fault():
    assert end_of(raised(ValueError("x"))) == ("ValueError: x", FAULT)


def test_a_file_in_the_place_of_a_module_is_known(tmp_path):
    assert shadowed(str(tmp_path / "random.py")) == "random"
    assert shadowed(str(tmp_path / "numpy" / "__init__.py")) == "numpy"
    assert shadowed(str(tmp_path / "mine.py")) == ""
    assert shadowed(os.__file__) == shadowed(pytest.__file__) == ""


def test_a_module_that_lacks_what_it_is_asked_for_is_known(tmp_path, monkeypatch):
    monkeypatch.delenv("PYTHONPATH", raising=False)
    module = types.ModuleType("numpy")
    module.__file__ = str(tmp_path / "numpy.py")
    said = f"{module.__file__} stands in the place of the module numpy; rename it"
    assert end_of(AttributeError("x", obj=module, name="x")) == (said, BAD_INPUT)
    monkeypatch.setenv("PYTHONPATH", f"/nowhere{os.pathsep}{tmp_path}")
    said += ", or take its folder out of PYTHONPATH"
    assert end_of(AttributeError("x", obj=module, name="x")) == (said, BAD_INPUT)
    assert end_of(AttributeError("x", obj=np, name="x"))[1] == FAULT


def test_files_beside_one_are_nobodys(tmp_path):
    """`python -m fogproof` is the console script, in a folder of any files."""
    for name in ("numpy", "click", "json", "signal", "traceback", "scipy", "fogproof_command"):
        (tmp_path / f"{name}.py").write_text("raise ValueError")
    done = subprocess.run([sys.executable, "-m", "fogproof", "list"], capture_output=True, cwd=tmp_path, check=False)
    assert (done.returncode, done.stderr) == (0, b"")


def test_a_module_may_load_us_while_python_looks_for_it(tmp_path):
    """Its own folder stays where it is."""
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "__init__.py").write_text("import fogproof")
    (tmp_path / "mine" / "__main__.py").write_text("import beside")
    (tmp_path / "beside.py").write_text("print('beside')")
    assert subprocess.check_output([sys.executable, "-m", "mine"], cwd=tmp_path) == b"beside\n"


@pytest.mark.parametrize("start", [CONSOLE, [sys.executable, "-m", "fogproof"]], ids=["console", "module"])
def test_it_is_named_before_anything_is_loaded(tmp_path, start):
    (tmp_path / "numpy.py").write_text("x = 1")
    done = subprocess.run(
        [*start, "list"], capture_output=True, env={**os.environ, "PYTHONPATH": str(tmp_path)}, check=False
    )
    assert done.returncode == BAD_INPUT
    assert done.stderr.startswith(f"fogproof: {tmp_path}/numpy.py stands in the place of the module numpy".encode())
    assert b"Traceback" not in done.stderr


@POSIX
def test_other_peoples_code_keeps_to_itself(tmp_path):
    """A module beside it is not the server's, a folder it goes to not ours, and what it starts ends, with the sockets."""
    deep = tmp_path / ("deep" * 30)
    deep.mkdir()
    (tmp_path / "mine.py").write_text(CASES)
    (tmp_path / "socket.py").write_text("raise ValueError")
    word = f"fogproof-test-{os.getpid()}"
    env = {**os.environ, "TMPDIR": str(deep), "OF_THIS_TEST": word}
    with subprocess.Popen(
        [*CONSOLE, "verify", "mine.py", "--report", "page"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env=env,
        cwd=tmp_path,
    ) as ran:
        said = ran.communicate()[1]
    assert (ran.returncode, said.count(b"\n")) == (0, 2), said
    assert (tmp_path / "page" / "index.html").is_file()
    assert not carrying([word])
    assert not [*deep.iterdir(), *Path("/tmp").glob(f"fogproof-{ran.pid}-*")]


@POSIX
def test_a_subject_hears_no_signal_of_our_group():
    assert isolated(partial(os.getsid, 0)) != os.getsid(0)


@POSIX
def test_a_server_that_still_loads_is_ended(tmp_path, monkeypatch):
    (tmp_path / "slow_to_load.py").write_text("import time; time.sleep(60)")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    begun = servers.context
    monkeypatch.setattr(servers, "context", lambda slow: begun(["slow_to_load"]))
    servers.end()

    def ask():
        with contextlib.suppress(OSError):  # "no process could be started"
            isolated(int)

    asked = threading.Thread(target=ask, daemon=True)
    asked.start()
    for _ in range(100):
        end_isolated()
        asked.join(0.1)
        if not asked.is_alive():
            return
    pytest.fail("it is still waited for")


@POSIX
def test_pipes_that_do_not_block_are_waited_for():
    reading, writing = os.pipe()
    os.set_blocking(writing, False)
    questions = b'{"quantity": "phase_pdf", "phase": {"kind": "rayleigh"}, "mu": 0}\n' * 400
    child = subprocess.Popen([*CONSOLE, "oracle", "-"], stdin=subprocess.PIPE, stdout=writing)
    os.close(writing)
    threading.Thread(target=child.communicate, args=(questions,)).start()
    time.sleep(1.5)  # by now the pipe is full
    with open(reading, "rb") as pipe:
        assert len(pipe.readlines()) == 400


@POSIX
def test_an_output_may_be_a_pipe_without_a_name():
    reading, writing = os.pipe()
    write_output(f"/dev/fd/{writing}", "told")
    os.close(writing)
    with open(reading) as pipe:
        assert pipe.read() == "told"


def test_requests_are_bounded(tmp_path, monkeypatch):
    monkeypatch.setattr(input_files, "REQUESTS", 10)
    (tmp_path / "requests").write_bytes(b"1234567890")
    assert read_requests(tmp_path / "requests") == b"1234567890"
    (tmp_path / "requests").write_bytes(b"12345678901")
    with pytest.raises(InvalidInputError, match="more than 10 bytes"):
        read_requests(tmp_path / "requests")


@POSIX
def test_an_alarm_may_ring_at_any_moment():
    for number in range(3000):
        try:
            assert within((1 + number % 40) * 1e-6, int) == 0
        except TimeLimitError:
            continue


def test_a_limit_of_processor_time_is_told_every_second(monkeypatch):
    number = getattr(signal, "SIGXCPU", None)
    if number is None:
        pytest.skip("has no such signal")
    ended = []
    monkeypatch.setattr(signals.os, "kill", lambda *what: ended.append(what))
    monkeypatch.setattr(signals.signal, "signal", lambda *what: None)
    listening = Listening()
    with pytest.raises(Stopped):
        listening.hear(number, None)
    listening.at -= 10
    listening.hear(number, None)
    assert (listening.code, ended) == (128 + number, [])
    listening.hear(signal.SIGTERM, None)
    assert ended


@POSIX
def test_no_bytecode_is_left_cut_short(tmp_path):
    """Python does not look whether all of it was written, where a limit or a full disk lets a part through."""
    (tmp_path / "long.py").write_text("".join(f"def f{i}(): return {i}\n" for i in range(999)))
    limits = "import resource; resource.setrlimit(resource.RLIMIT_FSIZE, (9999, 9999)); "
    start = f"{limits}from fogproof_command import mind_limits; mind_limits(); import long"
    env = {**os.environ, "PYTHONPATH": str(tmp_path), "PYTHONDONTWRITEBYTECODE": ""}
    subprocess.run([sys.executable, "-c", start], env=env, cwd=tmp_path, check=True)
    assert not (tmp_path / "__pycache__").exists()


@POSIX
def test_a_table_has_a_time_limit():
    end = here(Run(["golden", "slab_reflectance", "--timeout", "1e-6"]))
    assert (end.code, b"no answer within 1e-06 s" in end.err) == (2, True)
