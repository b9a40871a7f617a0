"""What a user says about a program or a file of samples: a TOML file, one table.

A text "$g" stands for the parameter g, wherever a number may: so one file serves a family, whose members the table `family` lists.
"""

from __future__ import annotations

import inspect
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from fogproof import domains
from fogproof.checks.arguments import require_albedo
from fogproof.checks.subject import Precision
from fogproof.domains import Domain
from fogproof.errors import InvalidInputError, InvalidValueError, shorten
from fogproof.input_files import read_toml
from fogproof.pipe.protocol import ESTIMATOR_COLUMNS, SAMPLER_COLUMNS
from fogproof.pipe.tables import Interpolation
from fogproof.scene import AnyMedium, PhaseFunction, Ray, Scene
from fogproof.scene.files import read_fields
from fogproof.scene.media import AnyMediumField
from fogproof.scene.phase import PhaseFunctionField
from fogproof.validate import Channels, number


@dataclass(frozen=True)
class Atom:
    """A point of its own probability; `at` may be a list, or "inf"."""

    at: float | tuple[float, ...]
    probability: float


@dataclass(frozen=True)
class Spec:
    """A sampler (domain, phase or medium given) or an estimator (scene, quantity or reference given), and how to judge it.

    domain       where the points live; phase and medium have one of their own
    dimensions   uniforms of one row; None: the program draws its own numbers, from the seed of each request
    phase        the oracle's density of directions about `axis`, or of the cosine on the interval [-1, 1]
    medium, ray  the oracle's density of collisions along the ray; past a finite end, the probability of reaching it is an atom
    table        a file with the density on a grid; see `fogproof.pipe.tables`
    interpolation  of the table: "linear" between its points, or "constant" on each of its cells
    scene        the estimator's expectation is the oracle's radiance
    quantity     the same for any answer of the oracle: a request as for `fogproof oracle`
    reference    the same as plain numbers, `error` bounds how far they are from the truth
    parameters   sent to the program with every request
    family       name -> list of values, or {from, to}
    columns      of a file, as in the program's greeting
    type         of a file of bare bytes: "float64" or "float32"
    """

    domain: Domain | None = None
    dimensions: int | None = None
    atoms: tuple[Atom, ...] = ()
    events: dict[str, float] = field(default_factory=dict)
    axis: tuple[float, float, float] | None = None
    mean_cosine: float | None = None
    albedo: Channels | None = None
    precision: Precision | None = None
    quasi_random: bool = False
    uniform_bits: int | None = None
    phase: PhaseFunction | None = None
    medium: AnyMedium | None = None
    ray: Ray | None = None
    table: str | None = None
    exact: bool = False
    interpolation: Interpolation | None = None
    scene: Scene | None = None
    quantity: dict[str, Any] | None = None
    reference: Channels | None = None
    error: Channels = 0.0
    variance: float | None = None
    cost: float | None = None
    bounds: tuple[float, float] | None = None
    nonnegative: bool = False
    tails: Literal["unknown", "light"] = "unknown"
    tolerance: float | tuple[float, float] = 0.0
    parameters: dict[str, float] = field(default_factory=dict)
    family: dict[str, Any] = field(default_factory=dict)
    columns: tuple[str, ...] = ()
    type: Literal["float64", "float32"] = "float64"
    samples: int | None = None
    folder: Path = Path()

    @property
    def samples_points(self) -> bool:
        """Whether it describes a sampler, not an estimator."""
        return self.domain is not None


_TYPES: dict[str, Any] = {
    "dimensions": (int | None, None),
    "atoms": (tuple[Atom, ...], ()),
    "events": (dict[str, float] | None, None),
    "axis": (tuple[float, float, float] | None, None),
    "mean_cosine": (float | None, None),
    "albedo": (Channels | None, None),
    "precision": (Precision | None, None),
    "quasi_random": (bool, False),
    "uniform_bits": (int | None, None),
    "phase": (PhaseFunctionField | None, None),
    "medium": (AnyMediumField | None, None),
    "ray": (Ray | None, None),
    "table": (str | None, None),
    "exact": (bool, False),
    "interpolation": (Interpolation | None, None),
    "scene": (Scene | None, None),
    "quantity": (dict[str, Any] | None, None),
    "reference": (Channels | None, None),
    "error": (Channels, 0.0),
    "variance": (float | None, None),
    "cost": (float | None, None),
    "bounds": (tuple[float, float] | None, None),
    "nonnegative": (bool, False),
    "tails": (Literal["unknown", "light"], "unknown"),
    "tolerance": (float | tuple[float, float], 0.0),
    "parameters": (dict[str, float] | None, None),
    "columns": (tuple[str, ...], ()),
    "type": (Literal["float64", "float32"], "float64"),
    "samples": (int | None, None),
}

_OF_ESTIMATORS = ("error", "variance", "cost", "bounds", "nonnegative", "tails", "tolerance")
_OF_TABLES = ("exact", "interpolation")
_OF_SAMPLERS = (
    *("atoms", "events", "axis", "mean_cosine", "albedo", "uniform_bits", "quasi_random", "table"),
    *_OF_TABLES,
)


def spec_of(table: Mapping[str, Any], origin: str, parameters: Mapping[str, float] | None = None) -> Spec:
    """Return the spec of a table with "$name" replaced by parameters: those given, else its own, else a first member of the family.

    origin  the file it comes from, for messages; files it names are looked for beside it
    """
    family = _family(table, origin)
    own = table.get("parameters", {})
    first = {name: values[0] for name, values in family.items()}
    values = {**first, **(own if isinstance(own, dict) else {}), **(parameters or {})}
    filled = {key: _filled(item, values, origin) for key, item in table.items() if key not in ("family", "domain")}
    if isinstance(filled.get("scene"), str):
        filled["scene"] = read_toml(Path(origin).parent / filled["scene"], "the scene file")
    fields = read_fields(_TYPES, filled, origin)
    fields |= {"events": fields["events"] or {}, "parameters": {**(fields["parameters"] or {}), **values}}
    domain = _domain(_filled(table["domain"], values, origin), origin) if "domain" in table else None
    spec = Spec(domain=_implied(fields, domain, origin), folder=Path(origin).parent, family=family, **fields)
    _require_numbers(spec)
    _require_sense(spec, origin)
    _require_use(spec, table, origin)
    return spec


def _implied(fields: dict[str, Any], domain: Domain | None, origin: str) -> Domain | None:
    """Return the domain that was given or, where a phase function or medium says it all, theirs."""
    if domain is None and fields["phase"] is not None:
        return domains.UnitSphere()
    if domain is None and fields["medium"] is not None:
        return domains.HalfLine(0.0)
    return domain


def _require_sense(spec: Spec, origin: str) -> None:
    given = [name for name in ("scene", "quantity", "reference") if getattr(spec, name) is not None]
    if spec.domain is None and not given:
        keys = "domain, phase or medium (a sampler), or scene, quantity or reference (an estimator)"
        raise InvalidInputError(f"{origin}: says nothing of what is to be judged; give {keys}", origin)
    if spec.domain is not None and given:
        raise InvalidInputError(f"{origin}: {given[0]} is for estimators, and a domain for samplers", given[0])
    if len(given) > 1:
        raise InvalidInputError(f"{origin}: give one of {', '.join(given)}", given[1])
    laws = [name for name in ("phase", "medium", "table") if getattr(spec, name) is not None]
    if len(laws) > 1:
        raise InvalidInputError(f"{origin}: one density is enough; give one of {', '.join(laws)}", laws[1])
    if (spec.medium is None) != (spec.ray is None):
        raise InvalidInputError(f"{origin}: medium and ray belong together", "ray")
    known = SAMPLER_COLUMNS if spec.samples_points else ESTIMATOR_COLUMNS
    for name in spec.columns:
        if name not in known:
            raise InvalidInputError(f"{origin}: columns has {name!r}; known are {', '.join(known)}", "columns")
    for label in spec.events:
        if not label.lstrip("-").isdigit():
            raise InvalidInputError(f"{origin}: events.{label} must be a whole number", f"events.{label}")


def _require_numbers(spec: Spec) -> None:
    """Refuse numbers that nothing can have, whether or not the program or file has what they are looked at for."""
    if spec.dimensions is not None and spec.dimensions < 1:
        raise InvalidValueError(
            "dimensions", "must be >= 1; leave it out if the program draws its own", spec.dimensions
        )
    if spec.albedo is not None:
        require_albedo(spec.albedo)
    for name, least in (("uniform_bits", 8), ("samples", 1)):
        value = getattr(spec, name)
        if value is not None and value < least:
            raise InvalidValueError(name, f"must be a whole number >= {least}", value)


def _require_use(spec: Spec, table: Mapping[str, Any], origin: str) -> None:
    """Refuse what is given and would not be looked at."""
    is_one, other = ("a sampler", "an estimator") if spec.samples_points else ("an estimator", "a sampler")
    for key in table:
        if key in (_OF_ESTIMATORS if spec.samples_points else _OF_SAMPLERS):
            raise InvalidInputError(
                f"{origin}: {key} says something of {other}, and this is {is_one}; leave it out", key
            )
        if key in _OF_TABLES and spec.table is None:
            raise InvalidInputError(f"{origin}: {key} says something of a table, and none is given; leave it out", key)


def _filled(value: Any, values: Mapping[str, float], origin: str) -> Any:
    if isinstance(value, dict):
        return {key: _filled(item, values, origin) for key, item in value.items()}
    if isinstance(value, list):
        return [_filled(item, values, origin) for item in value]
    if isinstance(value, str) and value.startswith("$"):
        if value[1:] not in values:
            known = f"known are {', '.join(values)}" if values else "there is no table parameters or family"
            raise InvalidInputError(f"{origin}: {value} is no parameter; {known}", value)
        return values[value[1:]]
    return value


def _family(table: Mapping[str, Any], origin: str) -> dict[str, list[float] | tuple[float, float]]:
    """Return name -> a list of values, or a tuple: the ends of a range."""
    family = table.get("family", {})
    if not isinstance(family, dict):
        raise InvalidInputError(f"{origin}: family must be a table of parameters, got {shorten(family)}", "family")
    found: dict[str, list[float] | tuple[float, float]] = {}
    for name, values in family.items():
        if isinstance(values, dict) and set(values) == {"from", "to"}:
            low, high = (number(f"family.{name}.{end}", values[end], "must be finite") for end in ("from", "to"))
            if not low < high:
                raise InvalidValueError(f"family.{name}.to", f"must be greater than from = {low:g}", high)
            found[name] = (low, high)
        elif isinstance(values, list) and values:
            found[name] = [number(f"family.{name}", value, "must be finite") for value in values]
        else:
            rule = "must be a list of numbers, simple ones first, or { from = ..., to = ... }"
            raise InvalidInputError(f"{origin}: family.{name} {rule}, got {shorten(values)}", f"family.{name}")
    return found


def _domain(table: Any, origin: str) -> Domain:
    """Return the domain of a table with a kind, or of its kind alone."""
    table = {"kind": table} if isinstance(table, str) else table
    kind = table.get("kind") if isinstance(table, dict) else None
    if not isinstance(kind, str) or kind not in domains.KINDS:
        said = f"domain has kind {shorten(kind)}" if isinstance(table, dict) else f"domain is {shorten(table)}"
        raise InvalidInputError(f"{origin}: {said}; known are {', '.join(domains.KINDS)}", "domain")
    rest = {key: _plain(value) for key, value in table.items() if key != "kind"}
    _require_keys(kind, rest, origin)
    try:
        if kind == "product":
            parts = rest.get("parts", ())
            return domains.Product(*(_domain(part, origin) for part in parts))
        made: Domain = domains.KINDS[kind](**rest)
    except InvalidValueError as error:
        raise error.inside("domain", origin) from None
    except TypeError as error:
        raise InvalidInputError(
            f"{origin}: domain {kind} cannot be made of {shorten(rest)}: {error}", "domain"
        ) from None
    return made


def _require_keys(kind: str, given: Mapping[str, Any], origin: str) -> None:
    """Refuse keys that a domain does not have, and say which ones it has."""
    product = kind == "product"
    known = {} if product else dict(inspect.signature(domains.KINDS[kind]).parameters)
    needed = ["parts"] if product else [name for name, one in known.items() if one.default is one.empty]
    allowed = needed if product else list(known)
    wrong = [f"{name} is not a known key" for name in given if name not in allowed]
    wrong += [f"{name} is missing" for name in needed if name not in given]
    if wrong:
        keys = f"its keys are kind, {', '.join(allowed)}" if allowed else "it has no key but kind"
        raise InvalidInputError(f"{origin}: domain {kind}: {'; '.join(wrong)}; {keys}", "domain")


def _plain(value: Any) -> Any:
    if isinstance(value, list):
        return tuple(map(_plain, value))
    return {"inf": float("inf"), "-inf": float("-inf")}.get(value, value) if isinstance(value, str) else value
