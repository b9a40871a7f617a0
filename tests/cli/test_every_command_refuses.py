"""Every command with every kind of input and output that it cannot use: exit code 2 and a sentence, before anything is computed."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from pathlib import Path

import pytest
from fuzz_commands import Ended, Run, here

from fogproof.cli.commands import _COMMANDS

SCENE = Path(__file__).resolve().parents[2] / "scenes" / "foggy-lamp.toml"
SPEC = 'domain = {kind = "half-line", low = 0}\n'

READS: dict[str, list[list[str]]] = {
    "verify": [["{bad}.py"]],
    "list": [["{bad}.py"]],
    "check": [["{bad}.npy", "--spec", "{spec}"], ["{bad}.csv", "--spec", "{spec}"], ["{npy}", "--spec", "{bad}.toml"]],
    "oracle": [["{bad}.json"], ["{bad}.toml", "-o", "{out}.npy"]],
    "compare": [
        ["{bad}.exr", "{scene}"],
        ["{bad}.npy", "{scene}"],
        ["{image}", "{bad}.toml"],
        ["{image}", "--with", "{bad}.pfm"],
    ],
    "export": [["{bad}.toml", "--to", "json"]],
    "render": [["{bad}.toml", "--with", "mitsuba", "-o", "{out}"]],
    "relations": [["{bad}.toml", "--with", "mitsuba", "-o", "{out}"]],
    "golden": [["--requests", "{bad}.jsonl"]],
    "plan": [["{bad}.toml"]],
    "study": [["{bad}.toml", "-o", "{out}"]],
    "report": [["{bad}"], ["{run}", "--against", "{bad}"]],
    "stability": [],
    "zoo": [],
    "bench": [],
    "gallery": [],
}
"""What a command reads, {bad} being what it cannot read."""

WRITES: dict[str, list[str]] = {
    "verify": ["fog/analog/haze", "--report", "{taken}"],
    "oracle": ["{scene}", "-o", "{taken}/image.npy"],
    "compare": ["{image}", "--with", "{image}", "--report", "{taken}"],
    "export": ["{scene}", "--to", "json", "-o", "{taken}/scene.json"],
    "render": ["{scene}", "--with", "mitsuba", "-o", "{taken}"],
    "relations": ["{scene}", "--with", "mitsuba", "-o", "{taken}"],
    "golden": ["phase_pdf", "-o", "{taken}/table.json"],
    "study": ["{study}", "-o", "{taken}"],
    "stability": ["--short", "-o", "{taken}"],
    "zoo": ["-o", "{taken}"],
    "bench": ["-o", "{taken}"],
    "gallery": ["-o", "{taken}"],
}
"""What a command writes, {taken} being a file where a folder has to be."""

NO_OUTPUT = {"list", "check", "plan", "report"}


def missing(path: Path) -> None: ...


def a_folder(path: Path) -> None:
    path.mkdir()


def empty(path: Path) -> None:
    path.write_bytes(b"")


def noise(path: Path) -> None:
    path.write_bytes(bytes(range(256)) * 8)


def zeros(path: Path) -> None:
    path.write_bytes(bytes(4096))


def two_bytes_a_letter(path: Path) -> None:
    path.write_bytes("kind = 'rayleigh'\n".encode("utf-16"))


KINDS: list[Callable[[Path], None]] = [missing, a_folder, empty, noise, zeros, two_bytes_a_letter]


STUDY = """
samples = [64]
[[scenes]]
name = "haze"
quantity = "transmittance"
medium = { sigma_a = 0.1, sigma_s = 0.1 }
ray = { origin = [0, 0, 0], direction = [0, 0, 1], length = 1 }
estimators = ["ratio"]
"""


@pytest.fixture
def filled(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[list[str]], list[str]]:
    """Return what puts real files in the place of names in braces."""
    import numpy as np

    monkeypatch.chdir(tmp_path)
    np.save(tmp_path / "image.npy", np.ones((4, 4, 3)))
    np.save(tmp_path / "samples.npy", np.ones((100, 1)))
    (tmp_path / "spec.toml").write_text(SPEC)
    (tmp_path / "study.toml").write_text(STUDY)
    (tmp_path / "taken").write_text("somebody's")
    (tmp_path / "run").mkdir()
    names = {"scene": SCENE, "image": "image.npy", "npy": "samples.npy", "spec": "spec.toml", "study": "study.toml"}
    names |= {"taken": "taken", "out": "out", "bad": "bad", "run": "run"}
    return lambda words: [word.format(**names) for word in words]


def refused(end: Ended) -> None:
    text = end.err.decode()
    assert end.code == 2, (end.code, text)
    answer = json.loads(end.out)["error"]["message"] if end.out else ""  # the oracle tells it as an answer
    assert answer or re.search(r"^(fogproof|Error|Usage): ", text, re.M), text
    assert "Traceback" not in text
    assert not re.search("[\x00-\x08\x0b-\x1f\x7f-\x9f]", text), text


def test_the_tables_name_every_command() -> None:
    assert set(READS) == set(_COMMANDS)
    assert set(WRITES) | NO_OUTPUT == set(_COMMANDS)


@pytest.mark.parametrize("command", _COMMANDS)
def test_an_option_that_there_is_not(command: str) -> None:
    refused(here(Run([command, "--no-such-option"])))


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.__name__)
@pytest.mark.parametrize("command", [name for name, calls in READS.items() if calls])
def test_what_cannot_be_read(
    filled: Callable[[list[str]], list[str]], command: str, kind: Callable[[Path], None]
) -> None:
    for call in READS[command]:
        words = filled(call)
        bad = Path(next(word for word in words if word.startswith("bad")))
        kind(bad)
        if command == "report" and kind is not missing and kind is not a_folder:
            continue  # a folder is read
        refused(here(Run([command, *words])))
        assert not Path("out").exists()
        bad.rmdir() if kind is a_folder else bad.unlink(missing_ok=True)


@pytest.mark.parametrize("command", [name for name, calls in READS.items() if calls and name not in ("verify", "list")])
def test_an_input_without_a_name(filled: Callable[[list[str]], list[str]], command: str) -> None:
    """Neither is one the folder one stands in, nor None."""
    for call in READS[command]:
        words = ["" if word.startswith("{bad}") else word for word in call]
        end = here(Run([command, *filled(words)]))
        refused(end)
        assert b"is empty: name a file or folder" in end.err
        assert not Path("out").exists()


@pytest.mark.parametrize("command", WRITES)
def test_what_cannot_be_written(filled: Callable[[list[str]], list[str]], command: str) -> None:
    refused(here(Run([command, *filled(WRITES[command])])))
    assert Path("taken").read_text() == "somebody's"


@pytest.mark.parametrize("command", WRITES)
def test_an_output_without_a_name(filled: Callable[[list[str]], list[str]], command: str) -> None:
    """An unset variable of the shell is not the folder one stands in."""
    words = filled(WRITES[command])
    before = sorted(Path().rglob("*"))
    end = here(Run([command, *words[:-1], ""]))
    refused(end)
    assert b"is empty: name a file or folder" in end.err
    assert sorted(Path().rglob("*")) == before


@pytest.mark.parametrize("command", [name for name, words in WRITES.items() if words[-1] == "{taken}"])
def test_an_output_that_is_no_folder_is_said_to_be_none(filled: Callable[[list[str]], list[str]], command: str) -> None:
    Path("link").symlink_to("nowhere")
    words = filled(WRITES[command])
    assert b"'taken' is a file" in here(Run([command, *words])).err
    assert b"link is a link that leads nowhere" in here(Run([command, *words[:-1], "link"])).err


@pytest.mark.parametrize("command", ["verify", "compare", "stability", "gallery", "study"])
def test_a_folder_into_which_another_run_writes(filled: Callable[[list[str]], list[str]], command: str) -> None:
    fcntl = pytest.importorskip("fcntl")
    Path("busy").mkdir()
    other = os.open("busy", os.O_RDONLY)
    fcntl.flock(other, fcntl.LOCK_EX)
    end = here(Run([command, *filled(WRITES[command])[:-1], "busy"]))
    os.close(other)
    assert (end.code, b"another run of fogproof writes into busy" in end.err) == (2, True), end.err
    assert not [*Path("busy").iterdir()]


@pytest.mark.parametrize("digits", ["9" * 5000, "0x" + "f" * 5000], ids=["decimal", "hexadecimal"])
@pytest.mark.parametrize("command", ["plan", "study", "check", "export", "oracle"])
def test_an_integer_beyond_all_numbers(filled: Callable[[list[str]], list[str]], command: str, digits: str) -> None:
    """Python refuses to read one, and to print another, in words for programmers."""
    words = filled(next(call for call in READS[command][::-1] if "{bad}.toml" in call))
    Path("bad.toml").write_text(f"seed = {digits}\nray = [{digits}]\n")
    end = here(Run([command, *words]))
    refused(end)
    assert b"an integer has too many digits" in end.err


@pytest.mark.parametrize("value", ["1979-05-27", "07:32:00", "1979-05-27T07:32:00Z", "[[1, 1979-05-27]]"])
@pytest.mark.parametrize("command", ["plan", "study", "check", "export", "oracle", "compare", "render", "relations"])
def test_a_date(filled: Callable[[list[str]], list[str]], command: str, value: str) -> None:
    """TOML has dates and times, and nothing that is read here has."""
    words = filled(next(call for call in READS[command][::-1] if "{bad}.toml" in call))
    Path("bad.toml").write_text(f"purpose = {value}\nmedium = {{ sigma_a = {value} }}\n")
    end = here(Run([command, *words]))
    refused(end)
    assert b"is a date or a time, and no key takes one: put it in quotes" in end.err, end.err


def test_a_date_in_a_scene_that_a_spec_names(filled: Callable[[list[str]], list[str]]) -> None:
    Path("scene.toml").write_text("purpose = 1979-05-27\n")
    Path("bad.toml").write_text("scene = 'scene.toml'\n")
    end = here(Run(["check", *filled(["{npy}", "--spec", "{bad}.toml"])]))
    refused(end)
    assert b"scene.toml: purpose = 1979-05-27 is a date or a time" in end.err, end.err
