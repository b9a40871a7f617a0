"""Make the golden tables: proven values of the oracle's quantities, by ball arithmetic alone.

python tools/make_golden.py          writes analytic/proven/golden.json
python tools/make_golden.py --check  says whether the shipped tables still hold, without writing
"""

from __future__ import annotations

import json
import sys
from collections.abc import Iterator
from fractions import Fraction
from itertools import product
from pathlib import Path
from typing import Any

from fogproof.analytic.proven.airlight import airlight_ball
from fogproof.analytic.proven.balls import ProvenBall
from fogproof.analytic.proven.radiance import proven_radiance, proven_thickness, proven_transmittance
from fogproof.quantities import quantities
from fogproof.scene.files import read_fields

FILE = Path(__file__).resolve().parent.parent / "analytic" / "proven" / "golden.json"
DIGITS = 38

RAY = {"origin": [0.1, -0.2, -3.0], "direction": [0.48, 0.36, 0.8], "length": 4.5}
ENDLESS = {**RAY, "length": "inf"}
GRID = {
    "kind": "voxel-grid",
    "sigma_t": [[[0.1, 2.0, 0.0], [1.5, 0.3, 0.7]], [[0.0, 0.9, 4.0], [0.2, 0.0, 1.1]]],
    "lower": [-1.0, -1.0, -2.5],
    "upper": [2.5, 2.0, 1.5],
}
LAYERS = {"kind": "piecewise-constant", "boundaries": ["-inf", -2.0, -1.0, 0.5], "sigma_t": [0.2, 0.0, 1.7]}
MEDIA: dict[str, dict[str, Any]] = {
    "linear": {"kind": "linear", "sigma_0": 0.5, "gradient": [0.1, 0.0, -0.3], "albedo": 0.6, "emission": 0.4},
    "linear that ends": {
        "kind": "linear",
        "sigma_0": -0.5,
        "gradient": [0.0, 0.0, -0.3],
        "albedo": 0.6,
        "emission": 0.4,
    },
    "exponential": {"kind": "exponential", "sigma_0": 0.3, "rate": [0.0, 0.1, -0.9], "albedo": 0.6, "emission": 0.4},
    "layers": {**LAYERS, "albedo": [0.2, 0.0, 0.9], "emission": [0.4, 0.0, 1.5]},
    "anisotropic": {
        "kind": "anisotropic",
        "sigma": 0.7,
        "S": [[1.0, 0.5, 0.0], [0.5, 2.0, 0.0], [0.0, 0.0, 0.25]],
        "albedo": 0.6,
        "emission": 0.4,
    },
    "nearest voxels": {**GRID, "interpolation": "nearest", "albedo": 0.6, "emission": 0.4},
    "trilinear voxels": {**GRID, "interpolation": "trilinear", "albedo": 0.6, "emission": GRID["sigma_t"]},
    **{
        f"OpenGL fog {mode}": {
            "kind": "opengl-fog",
            "mode": mode,
            "density": 0.3,
            "start": 1.0,
            "end": 6.0,
            "eye": RAY["origin"],
            "albedo": 0.6,
            "emission": 0.4,
        }
        for mode in ("exp", "exp2", "linear")
    },
}
PHASES: list[dict[str, Any]] = [
    {"kind": "isotropic"},
    *({"kind": "henyey-greenstein", "g": g} for g in (0.5, -0.9, 0.9999)),
    {"kind": "rayleigh"},
    {"kind": "schlick", "k": 0.8},
    {"kind": "hazy"},
    {"kind": "murky"},
    {"kind": "cornette-shanks", "g": 0.7},
]
SEGMENTS = [(-5.0, 5.0), (-1.0, "inf"), (0.5, 2.0), (-3.0, -1.0)]


def requests() -> Iterator[dict[str, Any]]:
    """Yield every question of the tables."""
    for tau in (1e-300, 1e-16, 1e-8, 0.1, 1.0, 30.0, 700.0):
        medium = {"sigma_a": 0.25 * tau, "sigma_s": 0.75 * tau, "emission": 2.0}
        ray = {"origin": [0.0, 0.0, 0.0], "direction": [0.0, 0.0, 1.0], "length": 1.0}
        yield from _of_medium(medium, ray)
    yield from _of_medium({"sigma_a": 0.0, "sigma_s": 0.0}, ENDLESS)
    for name, medium in MEDIA.items():
        yield from _of_medium(medium, RAY)
        if name in ("linear that ends", "exponential", "nearest voxels", "trilinear voxels"):
            yield {"quantity": "transmittance", "medium": medium, "ray": ENDLESS}
    for phase, sigma_t, h, (a, b) in product(PHASES, (1e-9, 0.1, 10.0), (1e-6, 0.5), SEGMENTS):
        yield {"quantity": "airlight_integral", "sigma_t": sigma_t, "h": h, "a": a, "b": b, "phase": phase}
    for phase, sigma_t, (a, b) in product(PHASES, (0.0, 1.0), SEGMENTS[2:]):  # on the line of the light
        yield {"quantity": "airlight_integral", "sigma_t": sigma_t, "h": 0.0, "a": a, "b": b, "phase": phase}


def _of_medium(medium: dict[str, Any], ray: dict[str, Any]) -> Iterator[dict[str, Any]]:
    scene = {"medium": medium, "ray": ray}
    yield {"quantity": "optical_thickness", **scene}
    yield {"quantity": "transmittance", **scene}
    yield {"quantity": "ambient_fog", **scene, "ambient": 1.5, "background": 0.25}
    yield {"quantity": "emitted_radiance", **scene, "times_sigma_a": True}
    if ray["length"] != "inf":
        yield {"quantity": "emitted_radiance", **scene, "times_sigma_a": False}


def enclosure(request: dict[str, Any]) -> ProvenBall:
    """Return the proven answer to one question."""
    name = request["quantity"]
    given = {key: value for key, value in request.items() if key != "quantity"}
    arguments = read_fields(quantities()[name].arguments, given, "request")
    arguments.pop("rigorous", None)  # what follows is nothing else
    ray = arguments.get("ray")
    if ray is not None and ray.direction.tolist() != request["ray"]["direction"]:
        raise ValueError(f"the direction {request['ray']['direction']} is not a unit vector to the last bit")
    match name:
        case "optical_thickness":
            (ball,) = proven_thickness(arguments["medium"], arguments["ray"]).balls
        case "transmittance":
            (ball,) = proven_transmittance(arguments["medium"], arguments["ray"]).balls
        case "ambient_fog" | "emitted_radiance":
            (ball,) = proven_radiance(**arguments).balls
        case _:
            segment = (float(arguments[key]) for key in ("sigma_t", "h", "a", "b"))
            ball = airlight_ball(*segment, arguments["phase"])
    return ball


def decimal(ball: ProvenBall) -> tuple[str, str]:
    """Return midpoint and radius of a decimal ball that contains the ball, as exact decimal numbers."""
    if not ball.is_finite():
        return "inf", "0"
    middle, radius, exponent = (int(x) for x in ball.mid_rad_10exp(DIGITS))
    return _scientific(middle, exponent), _scientific(radius, exponent)


def _scientific(digits: int, exponent: int) -> str:
    text = str(digits)
    return f"{text[0]}.{text[1:] or '0'}e{exponent + len(text) - 1}" if digits else "0"


def entry(request: dict[str, Any]) -> dict[str, Any]:
    """Return one question with its answer."""
    value, radius = decimal(enclosure(request))
    return {"request": request, "value": value, "radius": radius}


def same(one: dict[str, Any], two: dict[str, Any]) -> bool:
    """Return whether two entries ask the same and their enclosures meet: both contain the truth."""
    if one["request"] != two["request"] or "inf" in (one["value"], two["value"]):
        return one == two
    apart = abs(Fraction(one["value"]) - Fraction(two["value"]))
    return apart <= Fraction(one["radius"]) + Fraction(two["radius"])


def main() -> int:
    """Write the tables, or check them."""
    made = [entry(request) for request in requests()]
    if "--check" in sys.argv[1:]:
        shipped = json.loads(FILE.read_text(encoding="utf-8"))["values"]
        wrong = [new for old, new in zip(shipped, made, strict=True) if not same(old, new)]
        print(f"{len(made)} golden values, {len(wrong)} of them no longer hold", file=sys.stderr)
        return 1 if wrong else 0
    lines = ",\n".join(json.dumps(new) for new in made)
    about = "|value - truth| <= radius, proven; a number in a request stands for the float64 nearest to it"
    FILE.write_text(
        f'{{"format": "fogproof/golden/1", "about": "{about}", "values": [\n{lines}\n]}}\n', encoding="utf-8"
    )
    print(f"{len(made)} golden values written to {FILE}", file=sys.stderr)
    return 0


if __name__ == "__main__":
    sys.exit(main())
