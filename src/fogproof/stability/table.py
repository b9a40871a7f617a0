"""Every formula whose stability is measured: what the modules of `formulas` hold, found and not listed."""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache

from fogproof.stability import formulas as themes
from fogproof.stability.formula import Formula


@cache
def formulas() -> tuple[Formula, ...]:
    """Return every formula, in the order of their names."""
    found: list[Formula] = []
    for module in pkgutil.iter_modules(themes.__path__):
        found += getattr(importlib.import_module(f"{themes.__name__}.{module.name}"), "FORMULAS", ())
    names = [formula.name for formula in found]
    assert len(set(names)) == len(names), f"two formulas have one name: {sorted(names)}"
    return tuple(sorted(found, key=lambda formula: formula.name))
