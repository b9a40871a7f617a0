"""The examples run as they stand, and find the error that can be switched on."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).resolve().parents[2] / "examples" / "check_sampler_cpp.py"
needs_compiler = pytest.mark.skipif(shutil.which("c++") is None, reason="no C++ compiler: install g++ or clang")


@needs_compiler
@pytest.mark.parametrize(("flags", "words"), [([], "not rejected"), (["-DFLIPPED"], "sign convention")])
def test_a_sampler_in_cpp(flags, words):
    run = subprocess.run([sys.executable, EXAMPLE, *flags], capture_output=True, text=True)
    assert words in run.stdout, run.stderr
    assert (run.returncode == 0) == (not flags)
