"""The causes that findings and hypotheses name, and which of them is the most telling."""

from __future__ import annotations

from collections.abc import Iterable

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
    "lost contribution",
    "wrong event label",
    "lost samples",
    "wrong probability of an atom",
    "wrong formula",
    "wrong bound",
    "cancellation",
    "edge of the uniforms",
    "repeated samples",
    "coarse numbers",
    "stratified samples",
    "dependent samples",
    "atom",
    "pdf outside the support",
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
