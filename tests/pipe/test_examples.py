"""The examples in four languages: right ones pass, the planted error is named, and the headers stay as short as they promise."""

import shutil
import subprocess
from pathlib import Path

import pytest

from fogproof.pipe.check import Settings, check_program

EXAMPLES = Path(__file__).resolve().parents[2] / "examples" / "pipe"
BUILD = {
    "cpp": ["c++", "-O2", "-std=c++17", "-Wall", "-Wextra", "-Werror", "NAME.cpp", "-o"],
    "rust": ["rustc", "-O", "--edition", "2021", "-D", "warnings", "NAME.rs", "-o"],
    "go": ["go", "build", "NAME.go", "fogproof.go", "-o"],
    "node": ["node"],
}
CAUSE = {"hg": "sign convention", "free_path": "wrong pdf returned"}


def built(language: str, name: str, folder: Path) -> str:
    """Return the command line of an example, compiled into a folder; skip where its compiler is not there."""
    tool, *words = [word.replace("NAME", name) for word in BUILD[language]]
    if shutil.which(tool) is None:
        pytest.skip(f"no {tool} on this machine")
    if language == "node":
        return f"{tool} {EXAMPLES / language / name}.mjs"
    program = folder / name
    words = ["build", "-o", program, *words[1:-1]] if language == "go" else [*words, program]
    subprocess.run([tool, *words], cwd=EXAMPLES / language, check=True, capture_output=True)
    return str(program)


@pytest.mark.parametrize("name", CAUSE)
@pytest.mark.parametrize("language", BUILD)
def test_an_example_passes_and_its_bug_is_named(language, name, tmp_path):
    command = built(language, name, tmp_path)
    spec = EXAMPLES / f"{name}.toml"
    right = check_program(command, spec, Settings(samples=100_000)).verdict
    assert right.outcome == "not rejected", right
    wrong = check_program(f"{command} --bug", spec, Settings(samples=100_000)).verdict
    assert (wrong.outcome, wrong.cause) == ("rejected", CAUSE[name]), wrong


def test_examples_are_short():
    """A header of at most 150 lines, and at most 30 for whoever has a sampler."""
    assert len((EXAMPLES / "cpp" / "fogproof.hpp").read_text().splitlines()) <= 150
    for name in CAUSE:
        assert len((EXAMPLES / "cpp" / f"{name}.cpp").read_text().splitlines()) <= 30


def test_the_line_of_shell_runs():
    if shutil.which("mawk") is None:
        pytest.skip("no mawk on this machine")
    page = (EXAMPLES.parents[1] / "docs" / "pipe.md").read_text()
    command = next(block for block in page.split("```") if block.strip().startswith("mawk"))
    spec = {
        "dimensions": 1,
        "medium": {"sigma_a": 1, "sigma_s": 0},
        "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": "inf"},
    }
    verdict = check_program(command.strip(), spec, Settings(samples=2000)).verdict
    assert verdict.outcome == "not rejected", str(verdict)
