"""What a spec declares about recorded samples besides their densities: each is the mean of something in the file."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from typing import Any, NamedTuple

import numpy as np

from fogproof.checks import Finding, check_estimator
from fogproof.checks.subject import Subject
from fogproof.contracts import Draw

_ROUNDING = {"float64": 1e-12, "float32": 1e-6}
_PRINTED = 1e-4  # relative, of a probability as files print it


class _Mean(NamedTuple):
    """Values (n,) or (n, channels), what they average to, bounds of them, and the cause if they do not."""

    name: str
    values: np.ndarray
    expected: Any
    bounds: tuple[float, float] | None
    cause: str


def declared_means(subject: Subject, draw: Draw, alpha: float, seed: int | None) -> list[Finding]:
    """Hold weights to the albedo, labels to the events, points to the atoms, cosines to their mean; together they have `alpha`."""
    means = list(_means(subject, draw))
    findings = list(_probabilities_returned(subject, draw))
    for one in means:
        told: dict[str, Any] = {"bounds": one.bounds} if one.bounds else {"nonnegative": True}
        rounding = _ROUNDING[subject.precision]
        verdict = check_estimator(
            one.values,
            one.expected,
            tolerance=rounding,
            alpha=alpha / len(means),
            seed=seed,
            precision=subject.precision,
            **told,
        )
        for finding in verdict.findings:
            if finding.check.startswith("mean") or finding.outcome != "not rejected":
                cause = (finding.cause if finding.cause == "not a number" else one.cause) if finding.cause else ""
                findings.append(replace(finding, check=f"{one.name}, {finding.check}", cause=cause))
    return findings


def _means(subject: Subject, draw: Draw) -> Iterator[_Mean]:
    kept = np.ones(len(draw.x), bool) if draw.valid is None else draw.valid
    if draw.weight is not None and subject.albedo is not None:
        kept_rows = kept.reshape(-1, *(1,) * (draw.weight.ndim - 1))
        yield _Mean("weight", np.where(kept_rows, draw.weight, 0.0), subject.albedo, None, "wrong weight")
    if draw.event is not None:
        for label, probability in subject.events.items():
            yield _Mean(f"event {label}", (draw.event == label).astype(float), probability, (0, 1), "wrong event label")
    for point, hit in subject.at_atom(draw.x).items():
        share = subject.atoms[point]
        yield _Mean(f"atom {point}", hit.astype(float), share, (0, 1), "wrong probability of an atom")
    if subject.mean_cosine is not None and subject.axis is not None:
        mu = np.clip(draw.x @ np.asarray(subject.axis), -1, 1)
        yield _Mean("mean cosine", mu[kept], subject.mean_cosine, (-1, 1), "wrong mean cosine")


def _probabilities_returned(subject: Subject, draw: Draw) -> Iterator[Finding]:
    """At an atom the column of densities holds its probability."""
    for point, hit in subject.at_atom(draw.x).items():
        if draw.pdf is None or not hit.any():
            continue
        declared = subject.atoms[point]
        off = float(np.abs(draw.pdf[hit] - declared).max())
        told = (
            f"at {point} the file gives {draw.pdf[hit][0]:.6g}, where the spec declares the probability {declared:.6g}"
        )
        if off > _PRINTED * declared:
            yield Finding("returned probability", "rejected", told, effect=off, cause="wrong pdf returned")
        else:
            yield Finding("returned probability", "not rejected", told, effect=off)
