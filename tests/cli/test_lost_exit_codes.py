"""A parent may have left SIGCHLD ignored, as daemons do: exit codes are heard all the same, or nothing is started."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from fogproof import children

pytestmark = pytest.mark.skipif(os.name != "posix", reason="needs signals")
ROOT = Path(__file__).resolve().parents[2]
SUN = (ROOT / "scenes" / "images" / "sun.toml").read_text().replace("width = 48, height = 36", "width = 4, height = 4")
WELL_BUT_ENDS = """
import sys
import numpy as np
np.save(sys.argv[2] + ".npy", np.ones((4, 4), np.float32))
sys.exit(5)
"""


def ignoring():
    signal.signal(signal.SIGCHLD, signal.SIG_IGN)


def test_a_renderer_that_fails_has_failed(tmp_path):
    (tmp_path / "own.py").write_text(WELL_BUT_ENDS)
    (tmp_path / "sun.toml").write_text(SUN)
    words = ["render", "sun.toml", "--with", f"{sys.executable} own.py {{scene}} {{out}}", "-o", "out"]
    ran = subprocess.run(
        [sys.executable, "-m", "fogproof", *words], cwd=tmp_path, capture_output=True, text=True, preexec_fn=ignoring
    )  # fmt: skip
    assert (ran.returncode, "error" in ran.stdout, "exit code 5" in ran.stdout) == (3, True, True), (
        ran.stdout + ran.stderr
    )


def test_the_package_starts_nothing_whose_end_it_would_not_hear():
    before = signal.signal(signal.SIGCHLD, signal.SIG_IGN)
    try:
        with pytest.raises(ChildProcessError, match="ignores SIGCHLD"):
            children.run(["false"])
    finally:
        signal.signal(signal.SIGCHLD, before)
    assert children.run(["false"]).returncode == 1


PYTHONINSPECT = {**os.environ, "PYTHONINSPECT": "1"}
CONSOLE = [sys.executable, "-c", "from fogproof_command import main; main()"]


@pytest.mark.parametrize("start", [CONSOLE, [sys.executable, "-m", "fogproof"]], ids=["script", "module"])
@pytest.mark.parametrize(("words", "code"), [(["list", "fog"], 0), (["no-such-command"], 2)], ids=["well", "usage"])
def test_an_interpreter_that_would_stay_ends_with_our_code(start, words, code):
    ran = subprocess.run([*start, *words], env=PYTHONINSPECT, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    assert (ran.returncode, "Traceback" in ran.stderr) == (code, False), ran.stderr
