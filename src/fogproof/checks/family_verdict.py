"""What a search through a family has found: the simplest member that is wrong, and where those lie that are."""

from __future__ import annotations

import numbers
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from fogproof.checks.family_search import Search, doubt_of
from fogproof.checks.verdict import Finding, Outcome, Verdict


def verdict_of(search: Search, alpha: float, seconds: float) -> Verdict:
    """Return the verdict of a whole search: the simplest member that is rejected, or what all that were tried say."""
    tried = list(search.tried.values())
    if search.simplest is not None:
        parameter, rejected = search.simplest
        found = search.explained(parameter, rejected)
        wrong = sum(verdict.outcome == "rejected" for _, verdict in tried)
        message = f"wrong at {parameter!r}, the simplest of {wrong} rejected{_where(tried)}"
        p = min((f.p_value for f in found.findings if f.outcome == "rejected" and f.p_value is not None), default=None)
        family = Finding("family", "rejected", message, p, alpha, cause=found.cause)
        return replace(
            found,
            findings=(family, *found.findings),
            alpha=alpha,
            samples=search.drawn,
            seed=search.seed,
            seconds=seconds,
            settings={**found.settings, "parameter": repr(parameter)},
        )
    unsure = [(parameter, verdict) for parameter, verdict in tried if verdict.outcome == "inconclusive"]
    least = min(verdict.samples for _, verdict in tried)
    most = max(verdict.samples for _, verdict in tried)
    message = f"{len(tried)} parameters, {least} samples each, {most} where doubt was greatest"
    if unsure:
        worst_off = min(unsure, key=lambda each: doubt_of(each[1]))
        message += f"; no decision at {len(unsure)} of them. {_why(*worst_off, search.budget)}"
    worst = max(
        (verdict.resolution for _, verdict in tried if verdict.resolution is not None),
        key=lambda r: r.value,
        default=None,
    )
    outcome: Outcome = "inconclusive" if unsure else "not rejected"
    finding = Finding("family", outcome, message, alpha=alpha, resolution=worst)
    return Verdict((finding,), alpha, search.drawn, search.seed, seconds)


def _why(parameter: Any, verdict: Verdict, budget: int) -> str:
    """Return what one member lacks for a decision, in its own words, and how much of the search it has to get."""
    reason = next(f.message for f in verdict.findings if f.outcome == "inconclusive")
    share = (
        f"it got 1 / {budget / verdict.samples:.3g} of samples={budget}; with more, each member gets as many times more"
    )
    return f"At {parameter!r}, with {verdict.samples}: {reason}. {share[0].upper()}{share[1:]}"


def _where(tried: list[tuple[Any, Verdict]]) -> str:
    """Return on which side of which number the rejected parameters lie, if one number tells them apart."""
    rows = [(_coordinates(parameter), verdict.outcome == "rejected") for parameter, verdict in tried]
    if not all(row for row, _ in rows) or len({tuple(row) for row, _ in rows}) > 1:
        return ""
    for name in rows[0][0]:
        wrong = [row[name] for row, bad in rows if bad]
        right = [row[name] for row, bad in rows if not bad]
        if right and max(wrong) < min(right):
            return f"; not rejected for {name} >= {min(right):g}, rejected for {name} <= {max(wrong):g}"
        if right and min(wrong) > max(right):
            return f"; not rejected for {name} <= {max(right):g}, rejected for {name} >= {min(wrong):g}"
    return ""


def _coordinates(parameter: Any) -> dict[str, float]:
    """Return the numbers a parameter is made of, by name."""
    if isinstance(parameter, numbers.Real):
        return {"parameter": float(parameter)}
    if isinstance(parameter, Mapping):
        named = {str(key): value for key, value in parameter.items()}
    elif isinstance(parameter, tuple):
        named = {f"parameter[{i}]": value for i, value in enumerate(parameter)}
    else:
        named = {key: value for key, value in getattr(parameter, "__dict__", {}).items() if not key.startswith("_")}
    return {key: float(value) for key, value in named.items() if isinstance(value, numbers.Real)}
