"""What the folders of scenes are called into which renders are written."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from fogproof.errors import InvalidInputError

PAGE = ("index.html", "results.json")
"""What is written of all scenes together, beside the folders of each."""


def scene_names(scenes: Sequence[Path]) -> list[str]:
    """Return the names of scene files without their endings: each a folder of its own inside the one that is written into."""
    names = [path.stem for path in scenes]
    if len(set(names)) < len(names):
        twice = next(name for name in names if names.count(name) > 1)
        raise InvalidInputError(f"two scenes have the name {twice}: their renders would be one", twice)
    for path, name in zip(scenes, names, strict=True):
        if name in (".", "..") or name.casefold() in PAGE:  # some systems take Index.html for index.html
            beside = ", the name of what is written of all scenes" if name.casefold() in PAGE else ""
            raise InvalidInputError(
                f"{path}: its renders would be written into the folder {name!r}{beside}; rename it", str(path)
            )
    return names
