"""`fogproof relations`."""

from __future__ import annotations

import fnmatch
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
from fogproof.images.relation_run import RelationRun, relation_names, run_relations, write_record
from fogproof.renderers.table import renderer_of, require_command


@click.command("relations")
@click.argument("scenes", nargs=-1, required=True, metavar="SCENE.toml...", type=PLACE)
@click.option(
    "--with",
    "renderer",
    required=True,
    metavar="RENDERER",
    help="mitsuba, cycles, or a command with {scene} and {out}; {samples}, {seed}, {threads} and {integrator} may stand in it.",
)
@click.option(
    "-o", "--output", "folder", required=True, metavar="DIR", type=FOLDER,
    help="Renders, record and page land here; a run that was stopped goes on.",
)  # fmt: skip
@click.option("--only", multiple=True, metavar="PATTERN", help="Relations by name, such as 'moved/*'; repeatable.")
@click.option("--samples", type=click.IntRange(min=1), default=256, show_default=True, help="Samples a pixel.")
@click.option(
    "--renders", type=click.IntRange(min=1), default=2, show_default=True, help="Independent renders of each side."
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="From which all seeds follow.")
@click.option("--integrators", default="", metavar="NAME,...", help="Integrators of a command with {integrator} in it.")
@click.option("--python", default=sys.executable, help="Interpreter that has the renderer; this one by default.")
@click.option(
    "--tolerance", type=RELATIVE, default=TOLERANCE, show_default=True, help="Relative error that does not matter."
)
@click.option(
    "--alpha", type=PROBABILITY, default=ALPHA, show_default=True, help="False-alarm probability of the whole run."
)
@click.option("--no-oracle", is_flag=True, help="Leave the oracle out, and hold the renderer to itself alone.")
@click.option(
    "--time-limit", "seconds", type=SECONDS, default=600.0, show_default=True, help="Longest a render may take [s]."
)
@FORCE
@click.option("--json", "as_json", is_flag=True, help="Print rows as JSON, one a line.")
def command(
    scenes: tuple[Path, ...],
    renderer: str,
    folder: Path,
    only: tuple[str, ...],
    samples: int,
    renders: int,
    seed: int,
    integrators: str,
    python: str,
    tolerance: float,
    alpha: float,
    no_oracle: bool,
    seconds: float,
    force: bool,
    as_json: bool,
) -> int:
    """Hold a renderer to what is true of every scene: moved, scaled, mirrored, cut, by another integrator it looks the same.

    Each relation that fails names the part of the renderer it isolates, and the oracle says which side is wrong where it can.
    Exit code: 0 nothing rejected, 1 something rejected, 3 something inconclusive or not rendered, or an error.

    \b
    Example:  fogproof relations scenes/images/sun.toml --with mitsuba -o build/relations
    """
    from fogproof.images.scene_names import PAGE, scene_names
    from fogproof.scene.files import read_image_scenes

    chosen = renderer_of(renderer)
    ways = tuple(name.strip() for name in integrators.split(",") if name.strip()) or chosen.integrators
    if integrators and not chosen.takes("integrator"):
        raise click.UsageError("--integrators needs {integrator} in the command")
    run = RelationRun(
        chosen, ways, samples, renders, seed, tolerance, alpha, python, only, not no_oracle, seconds, force
    )  # fmt: skip
    read_image_scenes(scenes)  # what cannot be read is told before hours of rendering
    scene_names(scenes)
    names = relation_names(scenes, run)
    if missed := [pattern for pattern in only if not any(fnmatch.fnmatchcase(name, pattern) for name in names)]:
        raise click.UsageError(f"no relation of these scenes is named {' or '.join(missed)}")
    require_command(chosen, python)
    take(folder, PAGE, force)
    rows: list[dict[str, Any]] = []
    asked, unwritten = len(names), Unwritten()
    with interruptible() as stop:
        for row in run_relations(scenes, run, folder):
            rows.append(row)
            say(json.dumps(row) if as_json else _line(row))
            for reason in row.get("unwritten", ()):
                unwritten.tell(reason)
            with unwritten.noted():
                write_record(rows, run, folder, asked, whole=False)
    if stop.code:
        say(f"stopped after {len(rows)} of {asked} relations; what was rendered is kept", err=True)
    with unwritten.noted():
        say(f"report: {write_record(rows, run, folder, asked, whole=not stop.code)}", err=True)
    outcomes = {row["outcome"] for row in rows}
    return stop.code or unwritten.code(1 if "rejected" in outcomes else 0 if outcomes <= {"not rejected"} else 3)


def _line(row: dict[str, Any]) -> str:
    told = f"{row['scene']}  {row['relation']:22}  {row['outcome']:12}  {row['difference']:9}  {row['resolution']:8}"
    against = ", ".join(filter(None, (row["first"], row["second"])))
    told += f"  {'oracle: ' + against if against else ''}"
    if row["outcome"] == "rejected":
        told += f"\n    {'; '.join(filter(None, (row['message'], row['reason'])))}; look at {row['isolates']}"
    elif row["outcome"] in ("error", "not rendered"):
        told += f"  {row['reason']}"
    return told.rstrip()
