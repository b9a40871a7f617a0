"""Tests of samplers that others use, written anew from what is published of them, to be put to the same subjects.

A module here with a `TEST` is one of them; nothing lists the modules.
"""

from __future__ import annotations

import importlib
import pkgutil
from functools import cache
from typing import Any

import numpy as np

from fogproof.catalogue import SamplerCase
from fogproof.checks.streams import batch_generator
from fogproof.zoo.others.test import OtherTest

__all__ = ["OtherTest", "other_tests", "p_values"]


@cache
def other_tests() -> tuple[OtherTest, ...]:
    """Return them, in the order of their modules' names."""
    names = sorted(f"{__name__}.{found.name}" for found in pkgutil.iter_modules(__path__))
    modules = [importlib.import_module(name) for name in names]
    return tuple(test for module in modules for test in getattr(module, "TESTS", ()))


def p_values(case: Any, seed: int) -> dict[str, float | None]:
    """Return the p-value of every test on a case; None where it does not apply, NaN where it failed to decide."""
    if not isinstance(case, SamplerCase):
        return {test.name: None for test in other_tests()}
    sampler = case.make()
    found: dict[str, float | None] = {}
    for index, test in enumerate(other_tests()):
        if not test.applies(sampler):
            found[test.name] = None
            continue
        with np.errstate(all="ignore"):
            found[test.name] = test.p_value(sampler, batch_generator(seed, f"others/{test.name}", index, 0))
    return found
