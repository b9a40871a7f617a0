"""Protects: compiled kernels load only where needed, run what their sources say now, and never what an older edit said."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import fogproof
from fogproof.estimators.kernels import compiling as kernels
from fogproof.estimators.kernels.cache_files import prune

PACKAGE = Path(fogproof.__file__).parent

TRANSMITTANCE = """
import numpy as np
from fogproof.estimators.tracking.ratio import RatioTransmittance
from fogproof.scene import ExponentialMedium, Ray
medium = ExponentialMedium(0.7, (0.1, 0.2, 0.3))
draws = RatioTransmittance(medium, Ray((0, 0, 0), (0, 0, 1), 2.0), 2.0).draw(np.random.default_rng(1), 1000)
from fogproof.estimators.kernels import tracking as kernel_tracking
stats = kernel_tracking.ratio_tracking.stats
print(float(draws.value.mean()), sum(stats.cache_hits.values()))
"""


def run(code: str, path: Path, cache: Path | None = None) -> str:
    environment = {**os.environ, "PYTHONPATH": str(path)}
    environment.pop("NUMBA_CACHE_DIR", None)
    if cache is not None:
        environment["XDG_CACHE_HOME"] = str(cache)
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, env=environment, check=True)
    return done.stdout.strip()


def test_an_edited_callee_is_compiled_again(tmp_path: Path) -> None:
    copy, cache = tmp_path / "source", tmp_path / "cache"
    shutil.copytree(PACKAGE, copy / "fogproof", ignore=shutil.ignore_patterns("__pycache__"))
    first, hits = run(TRANSMITTANCE, copy, cache).split()
    assert hits == "0"
    again, hits = run(TRANSMITTANCE, copy, cache).split()
    assert (again, hits) == (first, "1")

    callee = copy / "fogproof" / "estimators" / "media" / "exponential.py"
    text = callee.read_text()
    assert text.count("return medium.sigma_0[channel] * np.exp(") == 1
    callee.write_text(text.replace("return medium.sigma_0[channel] * np.exp(", "return 0.0 * np.exp("))
    edited, hits = run(TRANSMITTANCE, copy, cache).split()
    assert hits == "0"
    assert float(edited) == 1.0 != float(first)


@pytest.mark.parametrize("module", ["fogproof", "fogproof.estimators", "fogproof.catalogue"])
def test_import_does_not_load_numba(module: str) -> None:
    code = f"import {module}, sys; print([m for m in ('numba', 'scipy') if m in sys.modules])"
    assert run(code, PACKAGE.parent) == "[]"


def test_without_a_place_to_write_nothing_is_kept_and_all_works(tmp_path: Path) -> None:
    blocked = tmp_path / "file"
    blocked.write_text("not a directory")
    value, hits = run(TRANSMITTANCE, PACKAGE.parent, blocked).split()
    assert 0 < float(value) < 1
    assert hits == "0"


def test_the_directory_depends_on_every_kernel_source(tmp_path: Path) -> None:
    names = {}
    for change in ("", "# edited"):
        folder = tmp_path / f"kernels{len(change)}"
        folder.mkdir()
        (folder / "a.py").write_text("a = 1\n")
        (folder / "b.py").write_text("b = 1\n" + change)
        directory = kernels.cache_directory(folder)
        assert directory is not None
        names[change] = directory.name
    assert names[""] != names["# edited"]


def test_a_decorated_function_leaves_numbas_settings_alone() -> None:
    import numba

    before = numba.config.CACHE_DIR

    @kernels.inlined
    def twice(x: float) -> float:
        return 2 * x

    assert before == numba.config.CACHE_DIR
    assert twice(np.float64(3.0)) == 6.0


def test_users_functions_are_compiled_in_memory_once() -> None:
    from fogproof.estimators.kernels import tracking as kernel_tracking

    plain = kernels.uncached(kernel_tracking.look_up)
    assert plain is kernels.uncached(kernel_tracking.look_up)
    assert hasattr(kernel_tracking.look_up._cache, "_cache_path")
    assert not hasattr(plain._cache, "_cache_path")


def test_damaged_code_is_compiled_again(tmp_path: Path) -> None:
    first, _ = run(TRANSMITTANCE, PACKAGE.parent, tmp_path).split()
    (folder,) = (tmp_path / "fogproof").iterdir()
    files = sorted(folder.glob("*.kernel"))
    assert files
    for number, file in enumerate(files):
        data = bytearray(file.read_bytes())
        data[len(data) * (number + 1) // (len(files) + 2)] ^= 4
        file.write_bytes(data if number else data[: len(data) // 2])
    again, hits = run(TRANSMITTANCE, PACKAGE.parent, tmp_path).split()
    assert (again, hits) == (first, "0")
    assert run(TRANSMITTANCE, PACKAGE.parent, tmp_path).split() == [first, "1"]


def test_a_disk_that_is_full_keeps_no_code_and_stops_nothing(tmp_path: Path) -> None:
    small = "import resource, sys; resource.setrlimit(resource.RLIMIT_FSIZE, (2000, 2000)); sys.dont_write_bytecode = True\n"
    value, hits = run(small + TRANSMITTANCE, PACKAGE.parent, tmp_path).split()
    assert 0 < float(value) < 1
    assert hits == "0"
    assert not [file for file in tmp_path.rglob("*") if file.is_file()]


def test_folders_of_gone_sources_are_removed(tmp_path: Path) -> None:
    old, young = tmp_path / "kernels-old", tmp_path / "kernels-young"
    for folder, days in ((old, 40), (young, 3)):
        folder.mkdir()
        os.utime(folder, (time.time() - 86_400 * days,) * 2)
    mine = tmp_path / "kernels-mine"
    mine.mkdir()
    prune(tmp_path, mine)
    assert sorted(tmp_path.iterdir()) == [mine, young]
