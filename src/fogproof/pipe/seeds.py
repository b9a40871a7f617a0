"""A program that draws its own numbers must draw the same ones from the same seed: otherwise no verdict on it can be repeated."""

from __future__ import annotations

import numpy as np

from fogproof.checks import Finding
from fogproof.pipe.program import Program
from fogproof.pipe.spec import Spec

_ROWS = 64
_SEED = 20_011
_ROUNDING = 1e-5  # relative: threads may add up in any order
_FEW = 0.01  # of the rows: a rounding may tip a choice


def function_of_its_seed(program: Program, spec: Spec) -> Finding | None:
    """Ask for the same seed twice, with another in between; None if all randomness comes from the uniforms of the request."""
    samples = program.greeting.samples
    if samples and spec.dimensions is not None:
        return None
    columns = len(program.greeting.columns)
    u = np.random.default_rng(_SEED).random((_ROWS, spec.dimensions or 0))
    first, _, again = (
        program.ask("sample" if samples else "draw", u, _ROWS, columns, seed, spec.parameters)
        for seed in (_SEED, _SEED + 1, _SEED)
    )
    same = np.isclose(first, again, rtol=_ROUNDING, atol=0.0, equal_nan=True).all(axis=1)
    share, name = float(np.mean(~same)), "function of its seed"
    if share <= _FEW:
        return Finding(name, "not rejected", f"{_ROWS} rows are the same when their seed comes again")
    message = f"the same seed gives other numbers the second time ({share:.0%} of the rows): draw them from the seed of the request"
    return Finding(name, "rejected", message, effect=share, cause="hidden state")
