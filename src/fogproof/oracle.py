"""The oracle for programs in any language: JSON requests in, reference values with error bounds out.

A request is an object with the key `quantity` and the arguments of that function of `fogproof.analytic`:

    {"quantity": "airlight_integral", "sigma_t": 0.5, "h": 1, "a": -2, "b": "inf", "phase": {"kind": "rayleigh"}}

Numbers may be nested lists, which broadcast. Numbers that JSON lacks are the strings "inf", "-inf" and "nan".
"""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from typing import Any

from fogproof import analytic
from fogproof.contracts import Reference
from fogproof.errors import FogproofError, InvalidInputError, shorten
from fogproof.scene import Isotropic, Medium, PointLight, Ray
from fogproof.scene.arrays import FloatArray
from fogproof.scene.files import read_fields
from fogproof.scene.phase_functions import PhaseFunctionField
from fogproof.validate import Channels

PROTOCOL = "fogproof/oracle/1"
_FORWARD = "mu is the forward cosine: propagation direction in . propagation direction out"


@dataclass(frozen=True)
class Quantity:
    """A question the oracle answers: its function, its arguments (type, or (type, default)), unit and convention."""

    function: Callable[..., Reference]
    arguments: dict[str, Any]
    unit: str
    convention: str


@cache
def quantities() -> dict[str, Quantity]:
    """Return every quantity by name."""
    scene = {"medium": Medium, "ray": Ray}
    radiance = "W/(m^2 sr)"
    return {
        "optical_thickness": Quantity(analytic.optical_thickness, scene, "1", "integral of sigma_t along the ray"),
        "transmittance": Quantity(
            analytic.transmittance, scene, "1", "fraction of radiance that arrives: exp(-optical thickness)"
        ),
        "ambient_fog": Quantity(
            analytic.ambient_fog,
            {**scene, "ambient": (Channels, 0.0), "background": (Channels, 0.0)},
            radiance,
            "in-scattered radiance and emission constant along the ray; emission is multiplied by sigma_a",
        ),
        "single_scattering": Quantity(
            analytic.single_scattering,
            {**scene, "light": PointLight},
            radiance,
            "airlight alone, without the background; the light's intensity is in W/sr; " + _FORWARD,
        ),
        "airlight_integral": Quantity(
            analytic.airlight_integral,
            {
                "sigma_t": FloatArray,
                "h": FloatArray,
                "a": FloatArray,
                "b": FloatArray,
                "phase": (PhaseFunctionField, Isotropic()),
            },
            "1/m",
            "integral over t in [a, b] of exp(-sigma_t ((t - a) + r)) / r^2 4 pi f_p(-t/r), r^2 = t^2 + h^2",
        ),
        "phase_pdf": Quantity(analytic.phase_pdf, {"phase": PhaseFunctionField, "mu": FloatArray}, "1/sr", _FORWARD),
        "phase_cdf": Quantity(
            analytic.phase_cdf,
            {"phase": PhaseFunctionField, "mu": FloatArray},
            "1",
            "probability that the cosine is <= mu; " + _FORWARD,
        ),
    }


def answer(request: Any) -> dict[str, Any]:
    """Answer one request; raises `FogproofError` for a bad one. The value is not yet JSON-ready where it is infinite."""
    if not isinstance(request, dict):
        raise InvalidInputError(f"request: must be a JSON object, got {shorten(request)}")
    if "quantity" not in request:
        raise InvalidInputError(f"request: quantity is missing; known are {', '.join(quantities())}", "quantity")
    name = request["quantity"]
    known = quantities().get(name) if isinstance(name, str) else None
    if known is None:
        raise InvalidInputError(
            f"request: quantity {shorten(name)} is not known; known are {', '.join(quantities())}", "quantity"
        )
    arguments = {key: value for key, value in request.items() if key not in ("quantity", "id")}
    result = known.function(**read_fields(known.arguments, arguments, "request"))
    return {
        **({"id": request["id"]} if "id" in request else {}),
        "quantity": name,
        "value": result.value,
        "error": result.error,
        "unit": known.unit,
        "convention": known.convention,
        "method": result.method,
        "source": result.source,
    }


def answer_text(text: str) -> dict[str, Any]:
    """Answer a request given as JSON text: the answer, or `{"error": {"code", "message", "path"}}`."""
    request: Any = None
    try:
        try:
            request = json.loads(text)
        except (json.JSONDecodeError, RecursionError) as error:
            raise InvalidInputError(f"request is not valid JSON: {error}") from None
        return answer(request)
    except FogproofError as error:
        named = {"id": request["id"]} if isinstance(request, dict) and "id" in request else {}
        return {**named, "error": error.to_dict()}
