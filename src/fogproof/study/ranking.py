"""Which estimator is best in a scene, in words too. Whoever is rejected is out; whoever is in doubt cannot win."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from fogproof.study.measures import Measured


def ranked(scene: Sequence[Measured]) -> dict[str, Any]:
    """Return the ranking of a scene's estimators with random points, the best, and a sentence; writes relative efficiencies.

    Exact estimators come first, the fastest ahead; then random ones by efficiency; then those whose judgement is inconclusive.
    Sobol points are compared with random ones of the same estimator.
    """
    plain = [m for m in scene if m.cell.points == "random" and m.efficiency is not None]
    sure = [m for m in plain if m.judged.outcome == "not rejected"]
    order = sorted(sure, key=_key) + sorted((m for m in plain if m not in sure), key=_key)
    exact = [m for m in sure if _is_exact(m)]
    random = [m for m in sorted(sure, key=_key) if not _is_exact(m)]
    best = order[0] if sure else None
    best_random = random[0] if random else None
    for measured in scene:
        _compare(measured, scene, order, best_random or best)
    return {
        "best": None if best is None else best.cell.name,
        "best_random": None if best_random is None else best_random.cell.name,
        "ranking": [m.cell.name for m in order],
        "out": [m.cell.name for m in scene if m.efficiency is None],
        "text": _sentences(scene, order, exact, random),
    }


def _is_exact(m: Measured) -> bool:
    return m.efficiency is not None and math.isinf(m.efficiency.value)


def _key(m: Measured) -> tuple[float, float]:
    assert m.efficiency is not None
    return (-m.efficiency.value, m.record["speed"]["cpu"]["value"])


def _compare(m: Measured, scene: Sequence[Measured], order: list[Measured], best: Measured | None) -> None:
    speed = m.record["speed"]
    if speed is None:
        return
    speed["efficiency"], speed["relative"], speed["rank"], speed["gain"] = None, None, None, None
    if m.efficiency is None:
        return
    speed["efficiency"] = m.efficiency.value
    if best is not None and best.efficiency is not None:
        speed["relative"] = asdict(m.efficiency.relative_to(best.efficiency))
    if m in order:
        speed["rank"] = order.index(m) + 1
    if m.cell.points == "sobol":
        twin = next(o for o in scene if o.cell.method is m.cell.method and o.cell.points == "random")
        if twin.efficiency is not None:
            speed["gain"] = asdict(m.efficiency.relative_to(twin.efficiency))


def _sentences(scene: Sequence[Measured], order: list[Measured], exact: list[Measured], random: list[Measured]) -> str:
    said = []
    if exact:
        first = exact[0]
        time = first.record["speed"]["cpu"]["value"]
        said.append(f"{first.record['label']} is best: it is exact, at {_seconds(time)} an estimate.")
    if random:
        first = random[0]
        target = first.record["speed"]["targets"][0]
        lead = "Of those that are random, " if exact else ""
        cost = "" if target["seconds"] is None else f": an error of 1 % takes {_seconds(target['seconds'])}"
        name = _inside(first.record["label"]) if exact else first.record["label"]
        said.append(f"{lead}{name} is best{cost}.")
        others = [_times(other, first) for other in random[1:4]]
        if others:
            said.append(f"It is {_listed(others)}.")
        sobol = next((m for m in scene if m.cell.points == "sobol" and m.cell.method is first.cell.method), None)
        gain = sobol.record["speed"]["gain"] if sobol is not None and sobol.record["speed"] else None
        if sobol is not None and gain and sobol.judged.outcome == "not rejected":
            count = sobol.record["counts"][-1]["count"]
            smaller = first.record["counts"][-1]["rmse"] / max(sobol.record["counts"][-1]["rmse"], 1e-300)
            smaller *= math.sqrt(first.record["counts"][-1]["count"] / count)
            said.append(f"{count} Sobol points in the place of random ones make its error {smaller:.2g} times smaller.")
    if not exact and not random:
        said.append("No estimator can be called best: none was found to be right.")
    said += [_marched(m) for m in scene if m.record["march"]]
    doubtful = [_inside(m.record["label"]) for m in order if m.judged.outcome == "inconclusive"]
    if doubtful:
        said.append(f"Not judged, and so not ranked among the sure: {_listed(doubtful)}.")
    wrong = [_inside(m.record["label"]) for m in scene if m.status == "rejected"]
    if wrong:
        said.append(f"Rejected: {_listed(wrong)}.")
    return " ".join(said)


def _times(other: Measured, first: Measured) -> str:
    assert other.efficiency is not None
    assert first.efficiency is not None
    ratio = first.efficiency.relative_to(other.efficiency)
    sure = "" if ratio.low > 1 else ", which is within noise"
    return f"{ratio.value:.3g} times as efficient as {_inside(other.record['label'])}{sure}"


def _marched(m: Measured) -> str:
    march, value = m.record["march"], abs(float(m.cell.reference.value))
    if m.judged.outcome == "not rejected":
        return f"{m.record['label']} is exact here."
    first, last = m.record["counts"][0], m.record["counts"][-1]
    order = "" if march["order"] is None else f", of order steps^-{march['order']['value']:.2g}"
    off = f"{first['rmse'] / value:.2g} with {first['count']} steps and {last['rmse'] / value:.2g} with {last['count']}"
    return f"{m.record['label']} is biased, relatively by {off}{order}, and is not ranked."


def _inside(label: str) -> str:
    """Return a label inside a sentence; it begins with a plain word."""
    return label[:1].lower() + label[1:]


def _listed(items: Sequence[str]) -> str:
    return items[0] if len(items) == 1 else f"{', '.join(items[:-1])} and {items[-1]}"


def _seconds(seconds: float) -> str:
    for unit, size in (("s", 1.0), ("ms", 1e-3), ("µs", 1e-6)):
        if seconds >= size:
            return f"{seconds / size:.3g} {unit}"
    return f"{seconds / 1e-9:.3g} ns"
