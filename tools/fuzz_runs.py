"""What `fuzz_commands` runs: a maker a kind of command, each with files and words broken by a few seeded changes.

Every command of the group has a maker, or comes among the words; options are those that the commands have, read from them.
"""

from __future__ import annotations

import io
import json
import random
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import click
import numpy as np
from broken_files import SCENE, STUDY, broken_bytes, broken_table, text_of, toml
from fuzz_oracle import broken_line

from fogproof.catalogue.own import own_cases
from fogproof.cli.commands import cli

CASES = """
import numpy as np, fogproof
from fogproof.catalogue import EstimatorCase, SamplerCase, Twin
class Exponential:
    domain, dimensions = fogproof.HalfLine(0.0), 1
    def __init__(self, sigma=1.0):
        self.sigma = sigma
    def sample(self, u):
        return -np.log1p(-u[:, 0]) / self.sigma
    def pdf(self, t):
        return np.exp(-t)
class Mean:
    def draw(self, rng, n):
        return rng.random(n)
def cases():
    return [
        SamplerCase(name="right", make=Exponential, samples=20_000, twin=Twin("rate", lambda: Exponential(2.0))),
        EstimatorCase(name="mean", make=Mean, reference=0.5, samples=10_000, weight=3),
    ]
"""
STUDY_FILE = {**STUDY, "samples": [10], "replicates": 4}
SAMPLER = {
    "dimensions": 2, "axis": [0, 0, 1], "phase": {"kind": "henyey-greenstein", "g": "$g"}, "parameters": {"g": 0.5},
    "columns": ["x", "x", "x"], "type": "float64",
}  # fmt: skip
ESTIMATOR = {
    "reference": 0.5,
    "error": 0.0,
    "bounds": [0, 1],
    "tails": "light",
    "columns": ["value"],
    "nonnegative": True,
}
SEEN = {
    "scattering": "none", "background": 2.5, "medium": {"sigma_a": 0.7, "sigma_s": 0.0}, "purpose": "fog",
    "camera": {"kind": "perspective", "origin": [0, 0, 0], "target": [0, 0, 1], "fov": 0.7, "film": {"width": 6, "height": 4}},
    "shape": {"kind": "slab", "point": [0, 0, 2], "normal": [0, 0, -1], "thickness": 2},
}  # fmt: skip
VALUES = [
    "", "-", "--", "-1", "0", "1e400", "nan", "fog/analog/haze", "fog/*", "[", "**", "nothing", "../..", "/dev/null", "a\x1b[31m",
    "\u202eb", "x.py", "x.py::", "::", "csv", "dask://", "{scene} {out}", "'", "\udcff",
]  # fmt: skip
ALL = ("verify", "gallery", "zoo", "bench", "stability")
"""Commands that run all they have where no name is given: minutes, by right."""


class Run(NamedTuple):
    """A call of the command line: its words, what stands on stdin, the exit codes that may come."""

    words: list[str]
    codes: tuple[int, ...] = (0, 2)
    stdin: bytes = b""


def commands() -> list[str]:
    """Return the names of the commands."""
    return cli.list_commands(click.Context(cli))


def options() -> list[str]:
    """Return the options of all commands."""
    context = click.Context(cli)
    found = (cli.get_command(context, name) for name in commands())
    return sorted(
        {word for command in found if command for given in command.params for word in given.opts if word[0] == "-"}
    )


WORDS = VALUES + options() + ["-h"]


def plan(rng: random.Random, folder: Path, record: dict[str, Any]) -> Run:
    """Return a scene to be planned."""
    file = folder / "scene.toml"
    text = toml(broken_table(rng, SCENE)).encode()
    file.write_bytes(broken_bytes(rng, text) if rng.random() < 0.3 else text)
    return Run(["plan", str(file), *["--json"] * rng.randrange(2)])


def study(rng: random.Random, folder: Path, record: dict[str, Any]) -> Run:
    """Return a small study to be measured."""
    file = folder / "study.toml"
    text = toml(broken_table(rng, STUDY_FILE)).encode()
    file.write_bytes(broken_bytes(rng, text) if rng.random() < 0.2 else text)
    shutil.rmtree(folder / "study", ignore_errors=True)
    words = ["study", str(file), "-o", str(folder / "study"), "--workers", "1", *["--json"] * rng.randrange(2)]
    return Run(words, (0, 1, 2, 3, 130))


def report(rng: random.Random, folder: Path, record: dict[str, Any]) -> Run:
    """Return records of which one or both are broken."""
    names = [folder / "new", folder / "old"]
    for name in names:
        name.mkdir(exist_ok=True)
        whole = rng.random() < 0.3
        (name / "results.json").write_bytes(json.dumps(record).encode() if whole else text_of(rng, record))
    against = ["--against", str(names[1])] * rng.randrange(2)
    return Run(["report", str(names[0]), *against], (0, 1, 2, 3) if against else (0, 2))


def requests(rng: random.Random, folder: Path, record: dict[str, Any]) -> Run:
    """Return broken requests, in a file or on stdin, for answers or for a table."""
    content = b"\n".join(broken_line(rng) for _ in range(rng.randrange(1, 4)))
    file = folder / "requests.jsonl"
    file.write_bytes(content)
    place = rng.choice(("-", str(file)))
    if rng.random() < 0.3:
        kind = rng.choice(("json", "csv", "c", "npz"))
        return Run(["golden", "--requests", place, "--format", kind, "--timeout", "2"], stdin=content)
    return Run(["oracle", place, "--timeout", "2"], stdin=content)


def cases(rng: random.Random, folder: Path, record: dict[str, Any]) -> Run:
    """Return a file of somebody's cases, to be listed."""
    file = folder / "mine.py"
    file.write_bytes(broken_bytes(rng, CASES.encode()))
    own_cases.cache_clear()
    return Run(
        ["list", str(file) + rng.choice(("", "", "::right", "::", "::*", "::no")), *["--json"] * rng.randrange(2)]
    )


def samples(rng: random.Random, columns: int) -> tuple[str, bytes]:
    """Return broken rows of numbers, and the suffix of their file."""
    columns = columns if rng.random() < 0.8 else rng.randrange(5)
    rows = np.random.default_rng(rng.randrange(2**32)).random((300, columns))
    rows = rows / np.linalg.norm(rows, axis=1, keepdims=True) if columns == 3 and rng.random() < 0.8 else rows
    suffix, out = rng.choice((".npy", ".csv", ".bin", ".txt") * 3 + ("",)), io.BytesIO()
    if suffix == ".npy":
        np.save(out, rows)
    elif suffix == ".bin":
        out.write(rows.tobytes())
    else:
        np.savetxt(out, rows, delimiter=",")
    return suffix, broken_bytes(rng, out.getvalue()) if rng.random() < 0.5 else out.getvalue()


def check(rng: random.Random, folder: Path, record: dict[str, Any]) -> Run:
    """Return samples to be judged by what a spec says of them, or a program that is none."""
    table: dict[str, Any] = rng.choice((SAMPLER, ESTIMATOR))
    suffix, content = samples(rng, len(table["columns"]))
    file, spec = folder / f"samples{suffix}", folder / "spec.toml"
    file.write_bytes(content)
    subject = [str(file)]
    if rng.random() < 0.2:
        subject = ["--exec", rng.choice(("cat", "true", "no-such-program", "'", ""))]
        table = {key: value for key, value in table.items() if key not in ("columns", "type")}
    text = toml(broken_table(rng, table) if rng.random() < 0.4 else table).encode()
    spec.write_bytes(broken_bytes(rng, text) if rng.random() < 0.1 else text)
    more = ["--json", "--samples", "200", "--timeout", "1", "--start-timeout", "1"]
    return Run(["check", *subject, "--spec", str(spec), *more[rng.randrange(2) :]], (0, 1, 2, 3))


def seen(rng: random.Random, folder: Path) -> Path:
    """Return the file of a scene with a camera, which may be broken."""
    file = folder / rng.choice(("seen.toml", "seen.json", "-x.toml"))
    table = broken_table(rng, SEEN) if rng.random() < 0.4 else SEEN
    file.write_bytes((json.dumps(table) if file.suffix == ".json" else toml(table)).encode())
    return file


def picture(rng: random.Random, folder: Path) -> Path:
    """Return the file of an image, which may be broken."""
    file = folder / f"image-{rng.randrange(3)}{rng.choice(('.npy', '.pfm') * 4 + ('.png',))}"
    value = np.random.default_rng(rng.randrange(2**32)).random((4, 6), np.float32)
    if file.suffix == ".npy":
        np.save(file, value)
    else:
        file.write_bytes(b"Pf\n6 4\n-1.0\n" + value.tobytes())
    if rng.random() < 0.4:
        file.write_bytes(broken_bytes(rng, file.read_bytes()))
    return file


def compare(rng: random.Random, folder: Path, record: dict[str, Any]) -> Run:
    """Return images to be compared with a scene or with each other."""
    images = [str(picture(rng, folder)) for _ in range(rng.choice((1, 1, 2)))]
    against = [str(seen(rng, folder))] if rng.random() < 0.6 else ["--with", str(picture(rng, folder))]
    place = ["--report", str(folder / "compared")] if rng.random() < 0.1 else []
    return Run(["compare", *images, *against, *place, *["--json"] * rng.randrange(2)], (0, 1, 2, 3))


def export(rng: random.Random, folder: Path, record: dict[str, Any]) -> Run:
    """Return a scene to be written for a renderer."""
    target = rng.choice(("mitsuba", "cycles", "pbrt", "json", "blender"))
    place = ["-o", rng.choice((str(folder / "exported"), str(folder), "-"))] if rng.random() < 0.5 else []
    return Run(["export", "--to", target, *place, str(seen(rng, folder))])


def render(rng: random.Random, folder: Path, record: dict[str, Any]) -> Run:
    """Return scenes to be rendered by a program that knows one picture, or is none."""
    image = picture(rng, folder)
    with_it = (
        f"cp {image} {{out}}.npy {{scene}}" if rng.random() < 0.2 else f"sh -c 'cp {image} $1.npy' sh {{out}} {{scene}}"
    )
    if rng.random() < 0.2:
        with_it = broken_bytes(rng, with_it.encode()).decode("latin-1").replace("\0", "")
    command = rng.choice((["render"], ["relations", "--no-oracle", "--only", "moved/*", "--renders", "1"]))
    place = str(folder / f"renders-{rng.randrange(4)}")
    words = [*command, str(seen(rng, folder)), f"--with={with_it}", "-o", place, "--time-limit", "5"]
    return Run([*words, *["--json"] * rng.randrange(2)], (0, 1, 2, 3))


def words(rng: random.Random, folder: Path, record: dict[str, Any]) -> Run:
    """Return any words, though no run of everything."""
    command = rng.choice([*commands(), "", "veriffy"])
    rest = [rng.choice(WORDS) for _ in range(rng.randrange(6))]
    return Run([command, *["nothing"] * (command in ALL), *rest], stdin=rng.randbytes(rng.randrange(9)))


MAKERS: dict[str, Callable[[random.Random, Path, dict[str, Any]], Run]] = {
    "plan": plan, "study": study, "report": report, "requests": requests, "cases": cases, "check": check,
    "compare": compare, "export": export, "render": render, "words": words,
}  # fmt: skip
SHARES = {
    "plan": 16, "study": 1, "report": 1, "requests": 6, "cases": 16, "check": 4, "compare": 4, "export": 6, "render": 1,
    "words": 16,
}  # fmt: skip
