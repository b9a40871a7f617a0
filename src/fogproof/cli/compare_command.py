"""`fogproof compare`."""

from __future__ import annotations

import json
from pathlib import Path

import click

from fogproof.cli.force import FORCE, take
from fogproof.cli.terminal import say
from fogproof.cli.unwritten import Unwritten
from fogproof.cli.values import FOLDER, NAMED, PROBABILITY, RELATIVE
from fogproof.images.compare import compare_image
from fogproof.images.judging import ALPHA, TOLERANCE, ImageComparison
from fogproof.images.pairs import compare_pictures

CODES = {"not rejected": 0, "rejected": 1, "inconclusive": 3}
SCENES = (".toml", ".json")


@click.command("compare")
@click.argument("images", nargs=-1, required=True, metavar="IMAGE... SCENE.toml", type=NAMED)
@click.option(
    "--with",
    "others",
    multiple=True,
    metavar="IMAGE",
    type=NAMED,
    help="Compare with this image, without an oracle; repeatable.",
)
@click.option(
    "--tolerance", type=RELATIVE, default=TOLERANCE, show_default=True, help="Relative error that does not matter."
)
@click.option(
    "--alpha", type=PROBABILITY, default=ALPHA, show_default=True, help="False-alarm probability of all tests together."
)
@click.option("--layer", default="", help="Layer of the channels, in files of several.")
@click.option(
    "--samples", type=click.IntRange(min=1), help="Samples a pixel, where variance layers are of one sample, as pbrt's."
)
@click.option(
    "--correlated", is_flag=True, help="Pixels share random numbers: only several renders tell how means scatter."
)
@click.option(
    "--report",
    "folder",
    type=FOLDER,
    help="Write the page, maps and results here.",
)
@FORCE
@click.option("--json", "as_json", is_flag=True, help="Print the record as JSON instead of words.")
def command(
    images: tuple[str, ...],
    others: tuple[str, ...],
    tolerance: float,
    alpha: float,
    layer: str,
    samples: int | None,
    correlated: bool,
    folder: Path | None,
    force: bool,
    as_json: bool,
) -> int:
    """Compare an image with the oracle's image of a scene.

    IMAGE is an EXR, NPY or PFM file of linear radiance; several are independent renders of the same scene, each of its own seed.
    The last argument is the scene, with a [camera] table. Without a scene, --with names the images to compare with.
    Exit code: 0 not rejected, 1 rejected, 3 inconclusive.

    \b
    Example:  fogproof compare render.exr scenes/images/lamp-inside-forward.toml --report build/lamp
    """
    scene_file = images[-1] if images[-1].lower().endswith(SCENES) else None
    if folder is not None:
        from fogproof.images.report import WRITTEN

        take(folder, WRITTEN, force)
    if scene_file is None:
        if not others:
            raise click.UsageError("give a SCENE.toml after the images, or --with IMAGE to compare with")
        done = compare_pictures(images, others, tolerance=tolerance, alpha=alpha, layer=layer, correlated=correlated)
    else:
        if others or len(images) < 2:
            raise click.UsageError("give IMAGE... SCENE.toml, or IMAGE... --with IMAGE")
        from fogproof.scene.files import read_image_scene

        done = compare_image(
            images[:-1],
            read_image_scene(scene_file),
            tolerance=tolerance,
            alpha=alpha,
            layer=layer,
            samples=samples,
            correlated=correlated,
        )
    _tell(done, as_json)
    unwritten = Unwritten()
    if folder is not None:
        from fogproof.images.report import write_comparison

        with unwritten.noted():
            say(f"report: {write_comparison(done, folder)}", err=True)
    return unwritten.code(CODES[done.verdict.outcome])


def _tell(done: ImageComparison, as_json: bool) -> None:
    if as_json:
        from fogproof.images.report import record_of

        say(json.dumps(record_of(done)))
        return
    say(done.verdict)
    for name, ratio, interval in done.ratios:
        say(
            f"  mean of {name} / reference: {ratio:.7g}, {interval.low:.7g} to {interval.high:.7g} at {interval.confidence:.0%}"
        )
