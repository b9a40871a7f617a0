"""A module that ends the process, or fails by its surroundings, gives no verdict and blames no case: a sentence, and 2."""

import os
import subprocess
import sys
from functools import partial

import pytest
from fuzz_commands import Run, here

from fogproof.checks.limits import within
from fogproof.cli.commands import cli, main
from fogproof.cli.terminal import BAD_INPUT
from fogproof.errors import SubjectError
from fogproof_command.startup import StandInError

POSIX = pytest.mark.skipif(os.name != "posix", reason="needs processes that are forked")
CONSOLE = [sys.executable, "-c", "import sys; sys.path.pop(0); from fogproof_command import main; main()"]


@pytest.mark.parametrize("start", [CONSOLE, [sys.executable, "-m", "fogproof"]], ids=["console", "module"])
@pytest.mark.parametrize("name", ["signal", "numpy"])
def test_a_module_that_ends_the_process_gives_no_verdict(tmp_path, start, name):
    (tmp_path / f"{name}.py").write_text("raise SystemExit(0)")
    env = {**os.environ, "PYTHONPATH": str(tmp_path)}
    done = subprocess.run([*start, "list"], capture_output=True, env=env, check=False)
    assert done.returncode == BAD_INPUT
    assert done.stderr.startswith(f"fogproof: {tmp_path}/{name}.py stands in the place of the module {name}".encode())


def ends(path):
    exec(compile("raise SystemExit(0)", path, "exec"))


def test_a_module_that_ends_a_command_gives_no_verdict(tmp_path, monkeypatch, capfd):
    monkeypatch.setattr(cli, "main", lambda *arguments, **extra: ends(str(tmp_path / "scipy.py")))
    with pytest.raises(SystemExit) as end:
        main(["list"])
    assert end.value.code == BAD_INPUT
    assert "scipy.py stands in the place of the module scipy" in capfd.readouterr().err


@POSIX
def test_a_module_that_ends_a_case_is_no_outcome_of_it(tmp_path):
    with pytest.raises(StandInError, match=r"scipy\.py stands in the place"):
        within(60, partial(ends, str(tmp_path / "scipy.py")))
    with pytest.raises(SubjectError, match="SystemExit"):
        within(60, partial(ends, str(tmp_path / "mine.py")))


@POSIX
def test_a_subject_that_closes_all_files_is_told_so():
    """In a process that has few files open: which are closed decides what fails first."""
    code = "import os; from functools import partial; from fogproof.checks.limits import within; "
    code += "within(60, partial(os.closerange, 3, 99))"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=False)
    assert "SubjectError" in done.stderr.splitlines()[-1]
    assert "closed files that others had opened" in done.stderr
    assert done.stderr.count("Traceback") == 1, "that of the error itself"


def test_a_server_of_processes_that_fails_leaves_it_to_who_asked():
    fails = "from fogproof.server_start import begin; begin([]); raise EOFError"
    done = subprocess.run([sys.executable, "-c", fails], capture_output=True, check=False)
    assert (done.returncode, done.stderr) == (1, b"")


@pytest.mark.parametrize("told", ["abc", "", "-1", "1.5", "9" * 17, "9" * 9999, "²"])
def test_a_date_that_libraries_cannot_read_is_named(monkeypatch, told):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", told)
    end = here(Run(["list"]))
    assert (end.code, b"SOURCE_DATE_EPOCH must be a whole number of seconds" in end.err) == (BAD_INPUT, True)
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    assert here(Run(["list", "fog/*"])).code == 0


@POSIX
def test_a_folder_that_is_gone_is_named(tmp_path):
    (tmp_path / "gone").mkdir()
    code = "import os, sys; os.chdir('gone'); os.rmdir(os.getcwd()); sys.path.pop(0); "
    start = code + "sys.argv[1:] = ['verify', 'equiangular/beside']; from fogproof_command import main; main()"
    done = subprocess.run([sys.executable, "-c", start], capture_output=True, cwd=tmp_path, check=False)
    assert (done.returncode, b"the folder one stands in is gone; go to another" in done.stderr) == (2, True)


def test_a_file_of_cases_that_is_none_is_told_why(tmp_path):
    (tmp_path / "folder.py").mkdir()
    (tmp_path / "wide.py").write_bytes("x = 1\n".encode("utf-16"))
    for name, why in (("folder", b"is a folder"), ("wide", b"is not UTF-8 text; save it as UTF-8")):
        end = here(Run(["verify", str(tmp_path / f"{name}.py")]))
        assert (end.code, why in end.err) == (BAD_INPUT, True), end.err
