"""Lines of the oracle's service in this process, in units of reading and writing the same lines as JSON."""

from __future__ import annotations

import io
import json
from typing import Any

import numpy as np

from fogproof.bench.benchmark import Benchmark, Goal, Way
from fogproof.oracle import serve

LINES = 2000
_FOG = {"sigma_a": 0.1, "sigma_s": 0.4}


def _questions(quantity: str) -> bytes:
    rng = np.random.default_rng(1)

    def ray() -> dict[str, Any]:
        return {"origin": [0, 0, rng.random()], "direction": [0, 0, 1], "length": 0.1 + rng.random()}

    def question() -> dict[str, Any]:
        match quantity:
            case "phase_pdf":
                return {"phase": {"kind": "henyey-greenstein", "g": 0.6}, "mu": rng.uniform(-1, 1)}
            case "airlight_integral":
                return {"sigma_t": rng.random(), "h": 0.01 + rng.random(), "a": -2 * rng.random(), "b": 3}
            case "transmittance":
                return {"medium": _FOG, "ray": ray()}
        return {"medium": _FOG, "ray": ray(), "light": {"position": [1, 1, 0], "intensity": 3}}

    return b"".join(json.dumps({"quantity": quantity, **question()}).encode() + b"\n" for _ in range(LINES))


def _answered(lines: bytes) -> Way:
    def run() -> int:
        out = io.BytesIO()
        serve(io.BytesIO(lines).read, out)
        return out.tell()

    return Way(run, LINES)


def _ways() -> dict[str, Way]:
    quantities = ("phase_pdf", "airlight_integral", "transmittance", "single_scattering")
    texts = {quantity: _questions(quantity) for quantity in quantities}

    def as_json() -> None:
        for line in texts["transmittance"].splitlines():
            json.dumps(json.loads(line))

    return {"JSON alone": Way(as_json, LINES)} | {name: _answered(text) for name, text in texts.items()}


def benchmarks() -> list[Benchmark]:
    """Return it."""
    goals = {
        name: Goal("<=", 20.0) for name in ("phase_pdf", "airlight_integral", "transmittance", "single_scattering")
    }
    return [Benchmark("oracle-lines", "A line of the oracle", "line", "JSON alone", _ways, goals)]
