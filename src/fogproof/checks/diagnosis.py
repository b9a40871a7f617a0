"""What kind of error is it? The findings of one verdict, read together."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from fogproof.checks.density.grid import Marginal
from fogproof.checks.verdict import Finding

CAUSES = (
    "writes into its uniforms",
    "hidden state",
    "ignores its uniforms",
    "order of the rows",
    "size of the call",
    "not a number",
    "outside the domain",
    "claimed hole",
    "wrong measure",
    "normalisation",
    "sign convention",
    "wrong pdf returned",
    "wrong weight",
    "wrong event label",
    "lost samples",
    "wrong probability of an atom",
    "wrong formula",
    "wrong bound",
    "cancellation",
    "edge of the uniforms",
    "repeated samples",
    "coarse numbers",
    "dependent samples",
    "atom",
    "missing tail",
    "skipped band",
    "shape",
    "correlation",
    "bias",
    "wrong variance",
    "wrong cost",
    "wrong standard errors",
)
"""All causes a finding may name, the most telling first: what explains most of the others."""


def likely_cause(findings: Iterable[Finding]) -> str:
    """Return the most telling cause among the rejected findings, "" if nothing was rejected."""
    named = {f.cause for f in findings if f.outcome == "rejected" and f.cause}
    return min(named, key=CAUSES.index, default="")


def mirrored(marginal: Marginal, counts: np.ndarray) -> bool:
    """Return whether the samples fit the marginal once its axis is turned round: forward taken for backward.

    Only for an axis whose counted coordinate is symmetric about its middle, such as the versine.
    """
    n = counts.sum()
    share = np.concatenate([[0.0], np.cumsum(counts)]) / max(n, 1)
    across = marginal.edges[0] + marginal.edges[-1] - marginal.edges
    reflected = 1 - np.interp(across, marginal.edges, share)
    as_is, reversed_ = (float(np.max(np.abs(s - marginal.cdf))) for s in (share, reflected))
    return as_is > 0.02 and reversed_ < 0.2 * as_is
