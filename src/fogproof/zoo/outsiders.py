"""Three errors in each sampler of the outsiders' suite: densities as renderers and libraries have them, foreign to this project."""

from __future__ import annotations

from dataclasses import replace
from functools import partial
from typing import Any

from fogproof.catalogue import SamplerCase, all_cases
from fogproof.catalogue.outsiders.subjects import ERRORS
from fogproof.zoo.bug import Bug

_LAW = ("shape", "another law", "another parameter", "wrong scale", "wrong power", "few entries")
_MISSING = ("skipped band", "skipped region", "missing tail", "never drawn", "few entries", "claimed hole")
CAUSES = {
    "pdf x .98": ("normalisation", "wrong measure"),
    "shifted": (*_LAW, "shifted", "wrong probability of an atom"),
    "a piece of mass .02 is missing": _MISSING,
}
"""Error -> causes that are right."""


def bugs() -> list[Bug]:
    """Return each error in each outsider."""
    found = []
    for case in all_cases():
        if not isinstance(case, SamplerCase) or not case.name.startswith("outsiders/"):
            continue
        for error, causes in CAUSES.items():
            name = f"outsiders/{error.replace(' ', '-')}/{case.name.partition('/')[2]}"
            broken = replace(case, name=name, make=partial(_broken, case, error), twin=None)
            found.append(Bug(name, f"{case.title}: {error}", case.source, causes, broken))
    return found


def _broken(case: SamplerCase, error: str) -> Any:
    return ERRORS[error](case.make())  # type: ignore[arg-type]  # these cases make outsiders
