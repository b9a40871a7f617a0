"""`fogproof render`."""

from __future__ import annotations

import json
import sys
from pathlib import Path
from typing import Any

import click

from fogproof.cli.force import FORCE, take
from fogproof.cli.signals import interruptible
from fogproof.cli.terminal import say
from fogproof.cli.unwritten import Unwritten
from fogproof.cli.values import FOLDER, PLACE, PROBABILITY, RELATIVE, SECONDS
from fogproof.images.judging import ALPHA, TOLERANCE
from fogproof.images.renders import WRITTEN, Wanted, render_scenes, write_page
from fogproof.renderers.table import renderer_of, require_command


@click.command("render")
@click.argument("scenes", nargs=-1, required=True, metavar="SCENE.toml...", type=PLACE)
@click.option(
    "--with",
    "renderer",
    required=True,
    metavar="RENDERER",
    help="mitsuba, cycles, or a command with {scene} and {out}.",
)
@click.option(
    "-o", "--output", "folder", required=True, metavar="DIR", type=FOLDER,
    help="Images, records and the page land here; a run that was stopped goes on.",
)  # fmt: skip
@click.option("--samples", type=click.IntRange(min=1), default=256, show_default=True, help="Samples a pixel.")
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of the renderer.")
@click.option("--python", default=sys.executable, help="Interpreter that has the renderer; this one by default.")
@click.option(
    "--tolerance", type=RELATIVE, default=TOLERANCE, show_default=True, help="Relative error that does not matter."
)
@click.option(
    "--alpha", type=PROBABILITY, default=ALPHA, show_default=True, help="False-alarm probability of each scene."
)
@click.option("--time-limit", "seconds", type=SECONDS, metavar="SECONDS", help="Longest a render may take.")
@FORCE
@click.option("--json", "as_json", is_flag=True, help="Print rows as JSON, one a line.")
def command(
    scenes: tuple[Path, ...],
    renderer: str,
    folder: Path,
    samples: int,
    seed: int,
    python: str,
    tolerance: float,
    alpha: float,
    seconds: float | None,
    force: bool,
    as_json: bool,
) -> int:
    """Render scenes with another program, compare each with the oracle, and write one page.

    Exit code: 0 nothing rejected, 1 something rejected, 3 something inconclusive or not rendered, or an error.

    \b
    Example:  fogproof render scenes/images/*.toml --with mitsuba -o build/mitsuba
    """
    from fogproof.images.scene_names import PAGE, scene_names
    from fogproof.reports.files import prepare_folder
    from fogproof.scene.files import read_image_scenes

    wanted = Wanted(renderer_of(renderer), samples, seed, tolerance, alpha, python, seconds)
    read_image_scenes(scenes)  # what cannot be read is told before hours of rendering
    require_command(wanted.renderer, python)
    names = scene_names(scenes)
    take(folder, PAGE, force)
    for name in names:
        if (folder / name).exists():
            prepare_folder(folder / name, WRITTEN, force)
    rows: list[dict[str, Any]] = []
    width, unwritten = max(map(len, names)), Unwritten()
    with interruptible() as stop:
        for row in render_scenes(scenes, wanted, folder):
            rows.append(row)
            say(json.dumps(row) if as_json else _line(row, width))
            for reason in row.get("unwritten", ()):
                unwritten.tell(reason)
            with unwritten.noted():
                write_page(rows, wanted, folder, len(scenes))
    if stop.code:
        say(f"stopped after {len(rows)} of {len(scenes)} scenes; these are kept", err=True)
    with unwritten.noted():
        say(f"report: {write_page(rows, wanted, folder, len(scenes))}", err=True)
    outcomes = {row["outcome"] for row in rows}
    return stop.code or unwritten.code(1 if "rejected" in outcomes else 0 if outcomes <= {"not rejected"} else 3)


def _line(row: dict[str, Any], width: int) -> str:
    told = f"{row['scene']:{width}}  {row['outcome']:12}  {row['ratio']:38}  {row['resolution']:8}  {row['seconds']:>6}"
    kept = "  (kept: neither the scene nor the command has changed)" if row.get("kept") else ""
    return f"{told}  {row['reason']}".rstrip() + kept
