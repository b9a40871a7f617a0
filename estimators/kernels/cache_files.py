"""Machine code on disk: each compiled kernel a file that proves itself, or is compiled again.

numba's own files are an index and data without checksums: a changed bit in them ends the process, and a full disk ends the run.
Here a file is there whole or not at all, and whatever is wrong with it, or with the disk, costs one compilation.
"""

from __future__ import annotations

import contextlib
import hashlib
import os
import pickle
import shutil
import time
import uuid
from pathlib import Path
from typing import Any

_UNUSED_DAYS = 30
"""A folder of kernels that nobody has opened for so long belongs to sources that are gone."""
_SUM = 16


class CacheFiles:
    """What numba asks of the files of one function: `save`, `load` and `flush`."""

    def __init__(self, folder: Path, name: str) -> None:
        self._folder, self._name = folder, name

    def save(self, key: Any, data: Any) -> None:
        """Write the code of one signature; on a full disk, or without permission, nothing is kept."""
        from numba.core.serialize import dumps

        content = dumps(data)
        path = self._path(key)
        beside = path.with_name(f"{path.name}.{uuid.uuid4().hex[:16]}")
        with contextlib.suppress(OSError):
            try:
                beside.write_bytes(hashlib.blake2b(content, digest_size=_SUM).digest() + content)
                os.replace(beside, path)
            finally:
                beside.unlink(missing_ok=True)

    def load(self, key: Any) -> Any:
        """Return the code of one signature, None if there is none or it is not what was written."""
        path = self._path(key)
        try:
            stored = path.read_bytes()
        except OSError:
            return None
        if hashlib.blake2b(stored[_SUM:], digest_size=_SUM).digest() == stored[:_SUM]:
            with contextlib.suppress(Exception):  # written whole, but by another state of numba or Python
                return pickle.loads(stored[_SUM:])
        with contextlib.suppress(OSError):
            path.unlink()
        return None

    def flush(self) -> None:
        """Forget nothing: the folder's name says of which sources it is."""

    def _path(self, key: Any) -> Path:
        return self._folder / f"{self._name}-{hashlib.blake2b(repr(key).encode(), digest_size=12).hexdigest()}.kernel"


def prune(root: Path, mine: Path) -> None:
    """Note that a folder is in use, and remove those beside it that have not been for a month."""
    with contextlib.suppress(OSError):
        os.utime(mine)
        for folder in root.glob("kernels-*"):
            if time.time() - folder.stat().st_mtime > _UNUSED_DAYS * 86_400:
                shutil.rmtree(folder, ignore_errors=True)
