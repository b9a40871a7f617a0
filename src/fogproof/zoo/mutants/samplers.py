"""Errors of samplers: of the uniforms, of the points and what is returned beside them, of how the sampler is written."""

from __future__ import annotations

import numpy as np

from fogproof.catalogue import SamplerCase
from fogproof.zoo.bug import Bug
from fogproof.zoo.mutants.mutation import Mutation, mutants
from fogproof.zoo.mutants.of_calls import paired, stateful, writing
from fogproof.zoo.mutants.of_draws import OfDraws, atom, density_scaled, label, mirrored_points, nan, returned
from fogproof.zoo.mutants.of_uniforms import (
    BEND,
    RIPPLE,
    SKIPPED,
    TAIL,
    OfUniforms,
    as_first,
    bent,
    coarse,
    lumped,
    of_the_first,
    of_the_last,
    ripple,
    skip,
    without,
)

OTHER_LAW = (
    "wrong probability of an atom",
    "shape",
    "another law",
    "another parameter",
    "wrong scale",
    "wrong power",
    "few entries",
)
MISSING = (
    "skipped band",
    "skipped region",
    "missing tail",
    "never drawn",
    "few entries",
    "atom",
    "clamped",
    "claimed hole",
)


MUTATIONS: tuple[Mutation[SamplerCase], ...] = (
    Mutation("pdf-scaled", "the pdf is 1 % too large", ("normalisation", "wrong measure"), density_scaled),
    Mutation("bent", "first uniform to the power 1.1", OTHER_LAW, OfUniforms(of_the_first(lambda v: v**BEND), bent)),
    Mutation(
        "bent-last", "last uniform to the power 1.1", OTHER_LAW,
        OfUniforms(of_the_last(lambda v: v**BEND), lambda u: bent(u[:, -1:]), 2),
    ),
    Mutation(
        "ripple", "first uniform with a ripple of 10 %", OTHER_LAW,
        OfUniforms(of_the_first(ripple), lambda u: 1 + RIPPLE * np.sin(6 * np.pi * u[:, 0])),
    ),
    Mutation(
        "skipped", "a piece of mass .01 is never drawn", MISSING,
        OfUniforms(of_the_first(skip), without(0.41, 0.41 + SKIPPED)),
    ),
    Mutation(
        "tail", "the last .001 is never drawn", MISSING,
        OfUniforms(of_the_first(lambda v: v * (1 - TAIL)), without(1 - TAIL, 1.0)),
    ),
    Mutation("reused", "second uniform is the first", ("correlation", "shape", *MISSING), OfUniforms(as_first, None, 2)),
    Mutation("lump", "one point in a thousand is the same", ("repeated samples", "atom"), lumped),
    Mutation("coarse", "uniforms of 12 bits", ("coarse numbers",), OfUniforms(coarse)),
    Mutation("mirrored", "points are mirrored", ("sign convention", "claimed hole"), mirrored_points),
    Mutation("nan", "one point in a thousand is no number", ("not a number", "outside the domain"), OfDraws(nan)),
    Mutation("returned-pdf", "the pdf returned is .1 % too large", ("wrong pdf returned",), returned("pdf", 1.001)),
    Mutation("weight", "weights are 1 % too large", ("wrong weight",), returned("weight", 1.01)),
    Mutation("label", "one label in fifty is wrong", ("wrong event label",), label),
    Mutation("atom", "one hit of an atom in five is drawn anew", ("wrong probability of an atom", "atom"), atom),
    Mutation("stateful", "every second call has its rows reversed", ("hidden state", "order of the rows"), stateful),
    Mutation("paired", "every point is returned twice", ("repeated samples", "order of the rows", "size of the call"), paired),
    Mutation("writing", "the uniforms are written into", ("writes into its uniforms",), writing),
)  # fmt: skip


def bugs() -> list[Bug]:
    """Return each error in each sampler of the catalogue."""
    return mutants(SamplerCase, MUTATIONS)
