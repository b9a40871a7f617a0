"""`fogproof oracle -`: lines a second, in CPU time of the process, waiting together and one by one."""

from __future__ import annotations

import json
import random
import resource
import subprocess
import sys
import time
from typing import Any

LINES = 20_000
FOG = {"sigma_a": 0.1, "sigma_s": 0.4}
COMMAND = [sys.executable, "-c", "from fogproof.cli import main; main(['oracle', '-'])"]


def ray() -> dict[str, Any]:
    """Return a ray that no other line has."""
    return {"origin": [0, 0, random.random()], "direction": [0, 0, 1], "length": 0.1 + random.random()}


def question(quantity: str) -> dict[str, Any]:
    """Return a question of one quantity with fresh numbers."""
    match quantity:
        case "phase_pdf":
            phase = {"kind": "henyey-greenstein", "g": 0.6}
            return {"quantity": quantity, "phase": phase, "mu": random.uniform(-1, 1)}
        case "airlight_integral":
            numbers = {"sigma_t": random.random(), "h": 0.01 + random.random(), "a": -2 * random.random(), "b": 3}
            return {"quantity": quantity, **numbers}
        case "transmittance":
            return {"quantity": quantity, "medium": FOG, "ray": ray()}
    return {"quantity": quantity, "medium": FOG, "ray": ray(), "light": {"position": [1, 1, 0], "intensity": 3}}


def together(lines: list[bytes]) -> float:
    """Return CPU seconds of the process that answers lines which are all there at once."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(COMMAND, input=b"\n".join(lines), stdout=subprocess.PIPE, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def one_by_one(lines: list[bytes]) -> float:
    """Return seconds in which lines are answered that each wait for the answer before."""
    with subprocess.Popen(COMMAND, stdin=subprocess.PIPE, stdout=subprocess.PIPE) as oracle:
        assert oracle.stdin is not None
        assert oracle.stdout is not None
        for i, line in enumerate(lines):
            if i == 1:  # the first waits for imports
                start = time.perf_counter()
            oracle.stdin.write(line + b"\n")
            oracle.stdin.flush()
            oracle.stdout.readline()
        spent = time.perf_counter() - start
        oracle.stdin.close()
    return spent


def main() -> None:
    """Print a row a quantity."""
    for quantity in ("phase_pdf", "airlight_integral", "transmittance", "single_scattering"):
        lines = [json.dumps(question(quantity)).encode() for _ in range(LINES)]
        start_up = together(lines[:1])
        rate = LINES / (together(lines) - start_up)
        alone = 500 / one_by_one(lines[:501])
        print(f"{quantity:20} {rate:8.0f} lines a second together, {alone:6.0f} one by one; ratio {rate / alone:.0f}")


if __name__ == "__main__":
    main()
