"""What draws may depend on besides the study: machine, versions, and the code they were made with."""

from __future__ import annotations

import hashlib
import importlib.metadata
import os
import platform
from functools import cache
from pathlib import Path
from typing import Any


def environment() -> dict[str, Any]:
    """Return what the draws may depend on besides the study, and the code they were made with."""
    packages = ("numpy", "scipy", "numba")
    versions = {package: importlib.metadata.version(package) for package in packages}
    machine = {"machine": platform.machine(), "platform": platform.platform(terse=True), "cores": os.cpu_count()}
    return {"python": platform.python_version(), **versions, **machine, "code": code_digest()}


@cache
def code_digest() -> str:
    """Return a sum of the sources of fogproof: batches of two states of the code should not be mixed."""
    root, words = Path(__file__).parents[1], hashlib.blake2b(digest_size=10)
    for folder in ("analytic", "estimators", "scene", "study"):
        for file in sorted((root / folder).rglob("*.py")):
            words.update(file.relative_to(root).as_posix().encode() + file.read_bytes())
    return words.hexdigest()
