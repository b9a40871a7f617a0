"""Every example of `examples/pipe`, right and with its planted error, under many seeds.

A right one must never be rejected; a planted error must be rejected each time and its class named. Needs the compilers; a language
without one is said to be left out.

    python tools/languages.py [SEEDS] [SAMPLES]
"""

from __future__ import annotations

import collections
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from fogproof.checks import fresh_seed
from fogproof.pipe.check import Settings, check_program

EXAMPLES = Path(__file__).resolve().parents[1] / "examples" / "pipe"
BUILD = {
    "cpp": ("c++", "-O2", "-std=c++17", "{name}.cpp", "-o", "{program}"),
    "rust": ("rustc", "-O", "--edition", "2021", "{name}.rs", "-o", "{program}"),
    "go": ("go", "build", "-o", "{program}", "{name}.go", "fogproof.go"),
    "node": (),
}
RUN = {"node": "node {source}.mjs"}
CAUSE = {"hg": "sign convention", "free_path": "wrong pdf returned"}


def command(language: str, name: str, folder: str) -> str | None:
    """Return the command line of an example, built into a folder; None where its compiler is not there."""
    program = f"{folder}/{language}-{name}"
    if shutil.which((*BUILD[language], language)[0]) is None:
        return None
    if BUILD[language]:
        words = [word.format(name=name, program=program) for word in BUILD[language]]
        subprocess.run(words, cwd=EXAMPLES / language, check=True)
    return RUN.get(language, "{program}").format(program=program, source=EXAMPLES / language / name)


def main(seeds: int = 100, samples: int = 100_000) -> int:
    """Print one line an example; return 1 if any line is not as it must be."""
    first, wrong = fresh_seed() % 2**32, 0
    with tempfile.TemporaryDirectory() as folder:
        for language in BUILD:
            for name, cause in CAUSE.items():
                words = command(language, name, folder)
                if words is None:
                    print(f"{language:5} {name:10} left out: its compiler is not there")
                    continue
                for bug, wanted in (("", "not rejected"), (" --bug", f"rejected ({cause})")):
                    told: collections.Counter[str] = collections.Counter()
                    for seed in range(first, first + seeds):
                        settings = Settings(samples=samples, seed=seed)
                        verdict = check_program(words + bug, EXAMPLES / f"{name}.toml", settings).verdict
                        told[f"{verdict.outcome} ({verdict.cause})" if verdict.cause else verdict.outcome] += 1
                    wrong += set(told) != {wanted}
                    print(f"{language:5} {name:10} {bug.strip() or 'right':6} {dict(told)}", flush=True)
    print(f"seeds {first} to {first + seeds - 1}, {samples} samples each")
    return int(wrong > 0)


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
