"""Install the built wheel as a user does, and let the three-line test judge: right passes, wrong fails, in every way to run tests.

    python tools/try_wheel.py [--keep DIR]

A wheel is built from this tree, and installed as `fogproof[pytest]` into a fresh environment with nothing else of ours. Then
pytest runs a test file with a right and a wrong sampler: alone, with two workers (pytest-xdist), until the first failure (-x), and
with failures run again (pytest-rerunfailures), which must not make the wrong one pass.
"""

from __future__ import annotations

import argparse
import os
import re
import subprocess
import sys
import tempfile
import time
import venv
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
TESTS = """
import fogproof as package
import numpy as np

def pdf(t):
    return np.exp(-t)

def test_right(fogproof):
    fogproof.check_sampler(lambda u: -np.log1p(-u[:, 0]), pdf, fogproof.HalfLine(0.0), dimensions=1)

def test_wrong(fogproof):
    fogproof.check_sampler(lambda u: -np.log1p(-u[:, 0]) / 1.01, pdf, fogproof.HalfLine(0.0), dimensions=1)

def test_loud():
    assert package.check_sampler(lambda u: -np.log1p(-u[:, 0]), pdf, package.HalfLine(0.0), dimensions=1)
"""
WAYS: dict[str, tuple[list[str], dict[str, int]]] = {
    "alone": ([], {"passed": 1, "failed": 2}),
    "two workers": (["-n", "2"], {"passed": 1, "failed": 2}),
    "until the first failure": (["-x"], {"passed": 1, "failed": 1}),
    "failures run again": (["--reruns", "2"], {"passed": 1, "failed": 2, "rerun": 4}),
    "again, two workers": (["--reruns", "1", "-n", "2"], {"passed": 1, "failed": 2, "rerun": 2}),
    "the right one alone": (["-k", "right"], {"passed": 1, "deselected": 2}),
}


def run(*words: str | Path, **options: object) -> subprocess.CompletedProcess[str]:
    """Run a command in an environment that knows nothing of this tree."""
    clean = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "VIRTUAL_ENV"))}
    return subprocess.run([*map(str, words)], capture_output=True, text=True, env=clean, check=False, **options)  # type: ignore[call-overload, no-any-return]


def demand(done: subprocess.CompletedProcess[str]) -> None:
    """End the program with what a command said, if it failed."""
    if done.returncode:
        raise SystemExit(f"{' '.join(map(str, done.args))}\n{done.stdout[-3000:]}{done.stderr[-3000:]}")


def main() -> int:
    """Return 1 if any way to run the tests says anything else than expected."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--keep", type=Path, help="work here, and leave it there")
    given = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = (given.keep or Path(name)).resolve()
        folder.mkdir(parents=True, exist_ok=True)
        began = time.monotonic()
        demand(run(sys.executable, "-m", "pip", "wheel", "--quiet", "--no-deps", "--wheel-dir", folder / "dist", ROOT))
        (wheel,) = (folder / "dist").glob("fogproof-*.whl")
        venv.create(folder / "venv", with_pip=True, clear=True)
        python = folder / "venv" / ("Scripts" if os.name == "nt" else "bin") / "python"
        more = ("pytest-xdist", "pytest-rerunfailures")
        demand(run(python, "-m", "pip", "install", "--quiet", f"{wheel}[pytest]", *more))
        print(f"{wheel.name} installed in {time.monotonic() - began:.0f} s")
        (folder / "tests").mkdir(exist_ok=True)
        (folder / "tests" / "test_mine.py").write_text(TESTS)
        bad = 0
        for way, (options, expected) in WAYS.items():
            call = (python, "-m", "pytest", "-p", "no:cacheprovider", *options, "test_mine.py")
            done = run(*call, cwd=folder / "tests")
            (last,) = re.findall(r"=+ (.*) in [\d.]+s.* =+$", done.stdout.strip().splitlines()[-1]) or [done.stdout]
            counts = {word: int(n) for n, word in re.findall(r"(\d+) (\w+)", last)}
            good = counts == expected and done.returncode == (1 if "failed" in expected else 0)
            print(f"{'as expected' if good else 'NOT AS EXPECTED':15} {way}: {last}")
            if not good:
                print(done.stdout[-3000:], done.stderr[-1000:])
            bad += not good
        print(f"{len(WAYS) - bad} of {len(WAYS)} ways as expected, {time.monotonic() - began:.0f} s")
        return int(bad > 0)


if __name__ == "__main__":
    sys.exit(main())
