"""`fogproof export`."""

from __future__ import annotations

from pathlib import Path

import click

from fogproof.cli.terminal import say
from fogproof.cli.values import FILE_OR_STDOUT, NAMED


@click.command("export")
@click.argument("scene", metavar="SCENE.toml", type=NAMED)
@click.option(
    "--to",
    "target",
    required=True,
    type=click.Choice(["mitsuba", "cycles", "pbrt", "json"]),
    help="For which renderer.",
)
@click.option("-o", "--output", type=FILE_OR_STDOUT, help="Write here instead of to stdout (-).")
def command(scene: str, target: str, output: Path | None) -> int:
    """Write a scene for another renderer: a script for its own Python, `python SCRIPT OUT.exr`, a file of pbrt-v4, or plain JSON.

    Units and conventions are translated in the script, each with a word on it.

    \b
    Example:  fogproof export scenes/images/sun.toml --to mitsuba -o sun.py && python sun.py sun.exr --samples 256
    """
    import json

    from fogproof.renderers.table import script_of
    from fogproof.reports.files import write_output
    from fogproof.scene.files import read_image_scene
    from fogproof.scene.to_json import to_json

    read = read_image_scene(scene)
    if target == "pbrt":
        from fogproof.renderers.pbrt import pbrt_text

        text = pbrt_text(read)
    else:
        text = json.dumps(to_json(read), indent=1) + "\n" if target == "json" else script_of(target, read)
    if output is None:
        click.echo(text, nl=False)
    else:
        write_output(output, text, scene)
        say(output, err=True)
    return 0
