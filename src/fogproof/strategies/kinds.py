"""From a kind to its strategy: field by field, or as a whole where fields one by one make no sense."""

from __future__ import annotations

import dataclasses
import importlib.util
from typing import Any

import numpy as np
from hypothesis import strategies as st

from fogproof.scene.phase import KINDS as PHASES
from fogproof.scene.phase import Mixture, Tabulated
from fogproof.strategies.fields import FIELDS
from fogproof.strategies.own_fields import OWN
from fogproof.strategies.values import numbers

_NEEDS = {"mie": "miepython", "polydisperse-mie": "miepython"}
"""kind -> the package without which the oracle says nothing of it."""


def known(kind: str) -> bool:
    """Return whether the oracle can tell of this kind here; what it cannot is drawn only where it is asked for by name."""
    return kind not in _NEEDS or importlib.util.find_spec(_NEEDS[kind]) is not None


def _tables() -> st.SearchStrategy[Tabulated]:
    @st.composite
    def table(draw: st.DrawFn) -> Tabulated:
        inner = draw(st.lists(st.integers(-63, 63), max_size=4, unique=True))
        cosines = [-1.0, *sorted(k / 64 for k in inner), 1.0]
        values = draw(st.lists(numbers(0, 10), min_size=len(cosines), max_size=len(cosines)))
        return Tabulated.normalised(cosines, values if sum(values) > 0.01 else [1.0] * len(cosines))

    return table()


def _mixtures() -> st.SearchStrategy[Mixture]:
    lobes = st.one_of([st.from_type(made) for kind, made in PHASES.items() if kind != "mixture" and known(kind)])

    @st.composite
    def mixture(draw: st.DrawFn) -> Mixture:
        parts = draw(st.lists(lobes, min_size=1, max_size=3))
        raw = np.array(draw(st.lists(st.integers(1, 8), min_size=len(parts), max_size=len(parts))), dtype=float)
        return Mixture(tuple(parts), tuple((raw / raw.sum()).tolist()))

    return mixture()


WHOLE: dict[str, Any] = {"tabulated": _tables, "mixture": _mixtures}
"""kind -> strategy of the whole thing, where fields one by one make no sense."""


def of_kind(kind: str, made: type) -> st.SearchStrategy[Any]:
    """Return the strategy of one kind; a field of which nothing is known keeps its default, or is an error that names it."""
    if kind in WHOLE:
        whole: st.SearchStrategy[Any] = WHOLE[kind]()
        return whole

    @st.composite
    def thing(draw: st.DrawFn) -> Any:
        together = OWN[kind](draw) if kind in OWN else {}
        names = [f for f in dataclasses.fields(made) if f.init and f.name not in together]
        for f in names:
            if f.name in FIELDS:
                together[f.name] = draw(FIELDS[f.name])
            elif f.default is dataclasses.MISSING and f.default_factory is dataclasses.MISSING:
                raise LookupError(f"no strategy for the field {f.name!r} of {kind}: add one to FIELDS or OWN")
        return made(**together)

    return thing()
