"""What the folders of scenes are called into which renders are written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fogproof.errors import InvalidInputError


def scene_names(scenes: Sequence[Path]) -> list[str]:
    """Return the names of scene files without their endings: each a folder of its own inside the one that is written into."""
    names = [path.stem for path in scenes]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InvalidInputError(f"two scenes have the name {twice}: their renders would be one", twice)
    for path, name in zip(scenes, names, strict=True):
        if name in (".", ".."):
            raise InvalidInputError(
                f"{path}: its renders would be written into the folder {name!r}; rename it", str(path)
            )
    return names
