"""`fogproof plan`."""

from __future__ import annotations

import json

import click

from fogproof.cli.terminal import say
from fogproof.cli.values import NAMED
from fogproof.plan import plan
from fogproof.scene.files import read_scene


@click.command("plan")
@click.argument("scene", metavar="SCENE.toml", type=NAMED)
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of words.")
def command(scene: str, as_json: bool) -> int:
    """Say which terms of the volume rendering equation a scene needs, and which methods serve it.

    \b
    Example:  fogproof plan scenes/foggy-lamp.toml
    """
    answer = plan(read_scene(scene))
    say(json.dumps(answer.to_dict()) if as_json else str(answer))
    return 0
