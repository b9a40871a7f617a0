"""`fogproof gallery`."""

from __future__ import annotations

from pathlib import Path

import click

from fogproof.cli.force import FORCE, take
from fogproof.cli.signals import interruptible
from fogproof.cli.terminal import say
from fogproof.cli.values import FOLDER


@click.command("gallery")
@click.argument("pictures", nargs=-1, metavar="[PICTURE]...")
@click.option(
    "-o",
    "--output",
    "folder",
    required=True,
    metavar="DIR",
    type=FOLDER,
    help="Write the page and the pictures here.",
)
@click.option("--seed", type=click.IntRange(min=0), default=0, show_default=True, help="Seed of everything sampled.")
@FORCE
def command(pictures: tuple[str, ...], folder: Path, seed: int, force: bool) -> int:
    """Draw the theory's pictures: the oracle's curves, and behind them what the estimators sample.

    PICTURE is a name under DIR/figures, such as fog; without any, all are drawn. The page's path goes to stdout.

    \b
    Example:  fogproof gallery -o build/gallery
    """
    from fogproof.reports import write_gallery
    from fogproof.reports.files import FIGURES

    take(folder, ("gallery.html", "gallery.json", *FIGURES), force)
    with interruptible() as stop:
        write_gallery(folder, seed, pictures)
    if (folder / "gallery.html").exists():
        say(str(folder / "gallery.html"))
    if stop.code:
        say("stopped; the pictures that were drawn are kept", err=True)
    return stop.code
