"""A renderer runs: one scene in, one image out, and what went wrong in a sentence."""

from __future__ import annotations

import json
import subprocess
from dataclasses import dataclass
from pathlib import Path

from fogproof.children import run
from fogproof.renderers.table import Renderer, command_of

LAST = 300
"""Characters of a renderer's last words that are kept."""


@dataclass(frozen=True)
class RenderFailure:
    """Why there is no image; `refused` where the renderer has no such thing, rather than failed."""

    reason: str
    refused: bool = False


def render_one(
    renderer: Renderer, scene: Path, out: Path, values: dict[str, str], seconds: float | None = None
) -> Path | RenderFailure:
    """Run a renderer and return the image's path, or why there is none.

    scene    JSON file of the scene
    out      EXR file to write; a renderer that writes arrays may be given {out}.npy
    values   what else the command is told: python, samples, seed, …
    seconds  longest it may take
    """
    beside = out.with_name(f"{out.name}.npy")
    for old in (out, beside):
        try:
            old.unlink(missing_ok=True)
        except OSError as error:
            return RenderFailure(f"cannot remove {old}: {error.strerror or error}")
    command = command_of(renderer, {"scene": str(scene), "out": str(out), **values})
    try:
        ran = run(command, seconds)
    except subprocess.TimeoutExpired:
        return RenderFailure(f"rendering took longer than {seconds:g} s")
    except OSError as error:
        return RenderFailure(f"cannot run {command[0]}: {error.strerror or error}")
    if not out.parent.is_dir():
        return RenderFailure(f"the folder {out.parent} was removed while its scene was rendered")
    if ran.returncode:
        words = (ran.stderr.strip().splitlines() or [""])[-1][-LAST:]
        if "No module named" in words and renderer.install:
            return RenderFailure(f"{renderer.name} is not installed; {renderer.install}")
        trouble = words.startswith(("Traceback", " ")) or "Error" in words.split(":")[0]
        return RenderFailure(words or f"exit code {ran.returncode}", refused=ran.returncode == 1 and not trouble)
    out = beside if beside.exists() and not out.exists() else out
    if not out.exists():
        return RenderFailure(f"the renderer ended well and wrote no {out.name}")
    return out


def code_of(renderer: Renderer, values: dict[str, str]) -> list[bytes]:
    """Return what a render depends on besides the scene: the words of the command, and the scripts it names."""
    words = command_of(renderer, {"scene": "scene", "out": "out", **values})
    scripts = [Path(word).read_bytes() for word in words if word.endswith(".py") and Path(word).is_file()]
    return [json.dumps(words).encode(), *scripts]
