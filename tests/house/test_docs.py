"""Every code block of README and docs/ does what the page says.

Python blocks of a page run one after the other in one namespace, in a folder that looks like a checkout. A `text`
block right behind one is what it prints; "…" stands for anything. If the block raises, the text ends with the exception's name.
Studies can be measured, commands exist with every option they are shown with, and links lead somewhere.
"""

import contextlib
import io
import re
import shlex
from pathlib import Path
from typing import NamedTuple

import click
import pytest

from fogproof.cli.commands import cli
from fogproof.study import read_study
from fogproof.study.cells import cells_of, prepare

ROOT = Path(__file__).resolve().parents[2]
PAGES = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md"))]
BLOCK = re.compile(r"^```(\w*)[^\n]*\n(.*?)^```$", re.S | re.M)


class Block(NamedTuple):
    """A fenced block: its language, its text, the line it begins at, and what it is said to print."""

    language: str
    text: str
    line: int
    printed: str | None


def blocks(path):
    page = path.read_text(encoding="utf-8")
    found = list(BLOCK.finditer(page))
    for match, after in zip(found, [*found[1:], None][: len(found)], strict=True):
        told = after is not None and after[1] == "text" and not page[match.end() : after.start()].strip()
        printed = after[2] if told and after is not None else None
        yield Block(match[1], match[2], page[: match.start()].count("\n") + 2, printed)


def of(language):
    return [
        pytest.param(path, [b for b in blocks(path) if b.language == language], id=path.name)
        for path in PAGES
        if any(b.language == language for b in blocks(path))
    ]


def pattern(text):
    """Return what matches the text: runs of blanks are one, "…" is anything."""
    words = [re.escape(word) for word in re.split(r"\s+", text.strip())]
    return r"\s+".join(words).replace("…", r"[\s\S]*?")


@pytest.fixture
def checkout(tmp_path, monkeypatch):
    """A folder that has what a checkout has, where a page may write."""
    for name in ("scenes", "studies", "examples"):
        (tmp_path / name).symlink_to(ROOT / name)
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize(("path", "examples"), of("python"))
def test_python_does_what_is_shown(path, examples, checkout):
    names = {"__name__": path.stem}
    for block in examples:
        code = compile("\n" * (block.line - 1) + block.text, str(path), "exec")
        out, failed = io.StringIO(), ""
        with contextlib.redirect_stdout(out):
            try:
                exec(code, names)
            except Exception as error:
                failed = type(error).__name__
                if block.printed is None or block.printed.split()[-1] != failed:
                    raise
        if block.printed is not None:
            assert re.search(pattern(block.printed), f"{out.getvalue()}\n{failed}"), (block.line, out.getvalue())


@pytest.mark.parametrize(("path", "studies"), of("toml"))
def test_studies_can_be_measured(path, studies, tmp_path):
    for block in studies:
        (tmp_path / "study.toml").write_text(block.text)
        prepare(cells_of(read_study(tmp_path / "study.toml")))


def commands():
    for path in PAGES:
        for line in path.read_text(encoding="utf-8").splitlines():
            for call in re.findall(r"(?:^|`|\| |/)(fogproof [^`#|]*)", line):
                yield pytest.param(call.strip(), id=f"{path.name}: {call.strip()[:60]}")


@pytest.mark.parametrize("call", list(commands()))
def test_every_command_shown_exists(call):
    words = [word for word in re.sub(r"[\[\]]|…| {2,}.*", " ", call).split() if not word.startswith("(")]
    _, *rest = shlex.split(" ".join(words))
    if not rest or rest[0].startswith("-"):
        return
    context = click.Context(cli)
    assert rest[0] in cli.list_commands(context), call
    command = cli.get_command(context, rest[0])
    options = {option for parameter in command.params for option in parameter.opts} | {"--help"}
    used = {word.split("=")[0] for word in rest[1:] if re.fullmatch(r"-[a-z]|--[a-z][\w-]*(=.*)?", word)}
    assert used <= options, (call, used - options)


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.name)
def test_links_lead_somewhere(path):
    page = re.sub(r"^```.*?^```$", "", path.read_text(encoding="utf-8"), flags=re.S | re.M)
    for link in re.findall(r"\]\(([^)#\s]+)[^)]*\)", page):
        if "://" not in link and not link.startswith("mailto:"):
            assert (path.parent / link).exists(), link
