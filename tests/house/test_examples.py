"""The examples run as they stand, and find the error that can be switched on."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from fogproof.analytic import airlight_integral

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "check_sampler_cpp.py"
needs_compiler = pytest.mark.skipif(shutil.which("c++") is None, reason="no C++ compiler: install g++ or clang")


@needs_compiler
@pytest.mark.parametrize(("flags", "words"), [([], "not rejected"), (["-DFLIPPED"], "sign convention")])
def test_a_sampler_in_cpp(flags, words, tmp_path):
    """It says what it found, and leaves no library behind."""
    environment = os.environ | {"TMPDIR": str(tmp_path)}
    run = subprocess.run([sys.executable, EXAMPLE, *flags], capture_output=True, text=True, env=environment)
    assert not list(tmp_path.iterdir())
    assert words in run.stdout, run.stderr
    assert (run.returncode == 0) == (not flags)


BUILD = {
    "cpp": ["c++", "-Wall", "-Wextra", "-Werror", "oracle_client.cpp", "-o"],
    "rs": ["rustc", "-D", "warnings", "oracle_client.rs", "-o"],
    "mjs": ["node", "oracle_client.mjs"],
}


@pytest.mark.parametrize("language", BUILD)
def test_a_client_of_the_oracle(language, tmp_path):
    """Each starts the oracle, asks one question, and prints the value with all its digits."""
    tool = BUILD[language][0]
    if shutil.which(tool) is None:
        pytest.skip(f"no {tool} on this machine")
    folder = EXAMPLE.parent
    assert len((folder / f"oracle_client.{language}").read_text().splitlines()) <= 30
    run = BUILD[language]
    if run[-1] == "-o":
        program = tmp_path / "client"
        subprocess.run([*run, program], cwd=folder, check=True, capture_output=True)
        run = [program]
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"
    found = subprocess.run(
        run, cwd=folder, env={**os.environ, "PATH": path}, capture_output=True, text=True, timeout=120
    )
    assert float(found.stdout) == airlight_integral(0.5, 1, -2, float("inf")).value, found.stderr
