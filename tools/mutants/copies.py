"""A copy of the project in which one file is wrong, and tests run in it."""

from __future__ import annotations

import multiprocessing
import multiprocessing.forkserver
import os
import shutil
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from signal import SIGKILL

from mutants.mutant import ROOT, Mutant

_HEAVY = ["pytest", "hypothesis", "numpy", "scipy.special", "scipy.stats", "scipy.optimize", "scipy.integrate"]
"""What most tests load and no error is planted in: a server of processes loads it once."""


@dataclass(frozen=True)
class Copy:
    """The tracked files of the project in a folder of their own, as they are on disk.

    sound  which tests have been seen to pass where nothing is wrong
    """

    root: Path
    sound: dict[str, bool] = field(default_factory=dict)

    @staticmethod
    def made(root: Path) -> Copy:
        """Make a copy anew."""
        shutil.rmtree(root, ignore_errors=True)
        root.mkdir(parents=True)
        listed = subprocess.run(
            ["git", "ls-files", "-co", "--exclude-standard", "-z"], cwd=ROOT, capture_output=True, check=True
        )
        for name in filter(None, listed.stdout.decode().split("\0")):
            source, target = ROOT / name, root / name
            target.parent.mkdir(parents=True, exist_ok=True)
            if source.is_symlink():
                os.symlink(source.readlink(), target)
            elif source.exists():
                shutil.copy2(source, target)
        return Copy(root)

    @contextmanager
    def wrong(self, mutant: Mutant) -> Iterator[None]:
        """Plant an error, and take it out again; compiled files tell both by the time of the last change."""
        path = self.root / mutant.file
        text, times = path.read_text(), path.stat()
        path.write_text(mutant.applied(text))
        try:
            yield
        finally:
            path.write_text(text)
            os.utime(path, ns=(times.st_atime_ns, times.st_mtime_ns))

    def is_sound(self, test: str, seconds: float) -> bool:
        """Return whether a test passes where nothing is wrong; it is run once."""
        if test not in self.sound:
            self.sound[test] = self.tested([test], seconds)[0] == "survived"
        return self.sound[test]

    def tested(self, tests: list[str], seconds: float) -> tuple[str, str]:
        """Run tests until the first fails; return "killed", "survived" or "time", and the test that failed."""
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(_HEAVY)
        log = self.root / "build" / "mutants.log"
        log.parent.mkdir(exist_ok=True)
        run = context.Process(target=_pytest, args=(str(self.root), tests, str(log)))
        run.start()
        run.join(seconds)
        if run.is_alive():
            os.killpg(run.pid, SIGKILL)
            run.join()
            return "time", ""
        output = log.read_text(errors="replace")
        if run.exitcode == 0:
            return "survived", ""
        failed = [line for line in output.splitlines() if line.startswith(("FAILED ", "ERROR "))]
        if not failed:  # nothing is killed by tests that could not run
            raise RuntimeError(f"the tests ended with {run.exitcode}:\n{output[-2000:]}")
        return "killed", failed[0].split(" ", 1)[1].split(" - ")[0]


def _pytest(root: str, tests: list[str], log: str) -> None:
    """Run tests in a copy, in a process group of their own, what they say going into a file."""
    os.setsid()
    os.chdir(root)
    out = os.open(log, os.O_WRONLY | os.O_CREAT | os.O_TRUNC)
    for stream in (1, 2):
        os.dup2(out, stream)
    source = os.path.join(root, "src")
    os.environ.update(PYTHONPATH=source, OPENBLAS_NUM_THREADS="1")
    sys.path[:] = [source, *(place for place in sys.path if not place.startswith(str(ROOT)) or ".venv" in place)]
    import pytest

    loaded = "ignore::pytest.PytestAssertRewriteWarning"  # Hypothesis is there already
    code = pytest.main(["-q", "-x", "--no-header", "-p", "no:cacheprovider", "-W", loaded, *tests])
    sys.stdout.flush()
    os._exit(int(code))
