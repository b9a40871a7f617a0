"""The renderers there are, how their scripts are exported, and the commands that run them."""

from __future__ import annotations

import json
import shlex
import shutil
from dataclasses import dataclass
from pathlib import Path

from fogproof.errors import InvalidInputError
from fogproof.scene import ImageScene
from fogproof.scene.to_json import to_json

HERE = Path(__file__).parent
READING = """    with open(given.scene, encoding="utf-8") as file:
        scene = json.load(file)
"""
"""What a script does to read its scene; an exported one has it inside."""


@dataclass(frozen=True)
class Renderer:
    """A renderer: the command that renders, with {python}, {scene}, {out}, {samples}, {seed}, {threads} and {integrator} in it.

    install      the line that installs it
    integrators  names of its ways to render a scene; the first is its usual one
    """

    name: str
    command: str
    install: str = ""
    integrators: tuple[str, ...] = ("",)

    def takes(self, key: str) -> bool:
        """Return whether the command has a place for a value."""
        return f"{{{key}}}" in self.command


OPTIONS = "{scene} {out} --samples {samples} --seed {seed} --threads {threads} --integrator {integrator}"


def _script(name: str) -> str:
    return f"{{python}} {shlex.quote(str(HERE / f'render_with_{name}.py'))} {OPTIONS}"


RENDERERS = {
    "mitsuba": Renderer(
        "mitsuba",
        _script("mitsuba"),
        "python -m pip install 'fogproof[mitsuba]'",
        ("volpath", "volpathmis"),
    ),
    "cycles": Renderer(
        "cycles",
        _script("cycles"),
        "python3.11 -m venv cycles && cycles/bin/python -m pip install bpy==5.0.1 'numpy<2', then --python cycles/bin/python",
        ("tracked", "marched"),
    ),
}


def renderer_of(name_or_command: str) -> Renderer:
    """Return a renderer by its name, or one of the user's own by its command."""
    if name_or_command in RENDERERS:
        return RENDERERS[name_or_command]
    if "{scene}" not in name_or_command or "{out}" not in name_or_command:
        known = ", ".join(RENDERERS)
        what = f"--with {name_or_command!r}: is none of {known}, and no command with {{scene}} and {{out}} in it"
        raise InvalidInputError(what, "with")
    try:
        words = shlex.split(name_or_command)
    except ValueError as error:
        raise InvalidInputError(f"--with {name_or_command!r}: {error}", "with") from None
    return Renderer(Path(words[0]).name, name_or_command)


def command_of(renderer: Renderer, values: dict[str, str]) -> list[str]:
    """Return the words of the command that renders a scene; values of its {keys}, an option without a value is left out."""
    words: list[str] = []
    for word in shlex.split(renderer.command):
        for key, value in values.items():
            word = word.replace(f"{{{key}}}", value)
        words.append(word)
    return words


def require_command(renderer: Renderer, python: str) -> None:
    """Refuse a command whose program is not there, before anything is rendered."""
    program = command_of(renderer, {"python": python})[0]
    if "{" not in program and shutil.which(program) is None:
        fix = "name a program that can be run, by its path if it is not in PATH"
        raise InvalidInputError(f"--with {renderer.name}: cannot run {program}: no such command; {fix}", "with")


def script_of(name: str, scene: ImageScene) -> str:
    """Return one file that the renderer's own interpreter runs: `python FILE OUT.exr`; the scene stands in it."""
    body = (HERE / f"render_with_{name}.py").read_text(encoding="utf-8")
    table = json.dumps(to_json(scene), indent=1).replace("'", "\\u0027")
    given = body.replace('    parser.add_argument("scene")\n', "").replace(READING, "    scene = json.loads(SCENE)\n")
    head, mark, rest = given.partition("from typing import Any\n")
    return f"{head}{mark}\nSCENE = r'''{table}'''\n{rest}"
