"""The causes that findings and hypotheses name, and which of them is the most telling."""

from __future__ import annotations

from collections.abc import Iterable

from fogproof.checks.verdict import Finding

CAUSES = (
    "writes into its uniforms",
    "writes into its points",
    "hidden state",
    "ignores its uniforms",
    "ignores its generator",
    "order of the rows",
    "size of the call",
    "not a number",
    "outside the domain",
    "negative pdf",
    "complementary cdf",
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
    "wrong mean cosine",
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


_BULK = {"shape", "sign convention"}  # what is found where atoms have no part in it
_LAWS = _BULK | {"missing tail", "skipped band", "correlation"}  # what many samples tell


def likely_cause(findings: Iterable[Finding]) -> str:
    """Return the most telling cause among the rejected findings, "" if nothing was rejected.

    A full place is an atom only if points come back there: what looks for repeated ones has the last word.
    """
    found = list(findings)
    named = {f.cause for f in found if f.outcome == "rejected" and f.cause}
    if "wrong probability of an atom" in named and named & _BULK:  # the law between the atoms is wrong, and so are they
        named = named - {"wrong probability of an atom"}
    if "atom" in named and any(f.check == "repeated points" and f.outcome == "not rejected" for f in found):
        named = named - {"atom"} | {"shape"}
    if "edge of the uniforms" in named and any(
        f.p_value is not None and f.cause in _LAWS for f in found if f.outcome == "rejected"
    ):
        named = named - {"edge of the uniforms"}  # which are too rare to move a law
    if any(f.check in ("domain", "returned pdf") and f.cause == "coarse numbers" for f in found):
        return "coarse numbers"  # rounded points are missing where they should be, and edges are rounded too
    if "repeated samples" in named and any(f.check == "size of the call" for f in found):
        named = named - {
            "size of the call"
        }  # a stream that starts again with every call gives small calls its first points
    return min(named, key=CAUSES.index, default="")
