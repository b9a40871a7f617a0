"""Two runs compared, before and after a change: what became slower, noisier or biased, beyond noise.

How a change of speed is told from a change of the machine, see `speed_change`.
"""

from __future__ import annotations

import json
import math
from collections.abc import Sequence
from dataclasses import asdict
from typing import Any

from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import normal_quantile
from fogproof.checks.statistics.welch import difference_test
from fogproof.study.convergence import Z
from fogproof.study.speed import scaled
from fogproof.study.speed_change import LEAST, SpeedChange, Speeds, estimate, speed_changes
from fogproof.study.speed_change import became as became_speed


def compare(before: dict[str, Any], after: dict[str, Any], alpha: float = 1e-6) -> dict[str, Any]:
    """Return what changed between the records of two studies, inside one false-alarm probability alpha."""
    pairs, gone, new = _pairs(before, after)
    speeds = speed_changes([(old, young) for _, old, young in pairs], len(_machines(before) | _machines(after)) == 1)
    share = alpha / max(1, 3 * len(pairs))
    changes = [_change(*pair, speed, share) for pair, speed in zip(pairs, speeds.changes, strict=True)]
    found = {word: [_title(c) for c in changes if word in c["became"]] for word in _WORDS}
    said = [f"{word}: {', '.join(names)}" for word, names in found.items() if names]
    same = _one_run(before, after)
    if same:
        text = "both are one and the same run"
    elif not pairs:
        text = "no estimator is in both runs: nothing was compared"
    else:
        text = "; ".join(said) if said else "nothing changed beyond noise"
        even = [_title(c) for c in changes if {"slower", "noisier"} & set(c["became"]) and not c["worse"]]
        text += f"; to the same error as soon as before, for all that was seen: {', '.join(even)}" if even else ""
        text += _perhaps(changes) + _of_speeds(speeds, changes)
    text += f"; gone: {_some(gone)}" if gone and pairs else ""
    return {
        "before": {
            key: before[key] for key in ("title", "started", "fogproof", "fingerprint", "digest", "environment")
        },
        "same_draws": not gone and not new and all(old["moments"] == young["moments"] for _, old, young in pairs),
        "alpha": alpha,
        "mood": speeds.machine,
        "wander": speeds.wander,
        "against": speeds.against,
        "gone": gone,
        "new": new,
        "changes": changes,
        "worse": any(change["worse"] for change in changes),
        "text": text,
    }


_SHOWN = 3
_HARDLY = 10.0
"""A change of speed that must be larger than this to be seen is hardly told."""
_WORDS = ("biased", "different", "noisier", "less noisy", "slower", "faster")
_Pair = tuple[str, dict[str, Any], dict[str, Any]]


def _pairs(before: dict[str, Any], after: dict[str, Any]) -> tuple[list[_Pair], list[str], list[str]]:
    old, young = (
        {(scene["name"], e["name"]): e for scene in record["scenes"] for e in scene["estimators"]}
        for record in (before, after)
    )
    pairs = [(scene, old[scene, name], young[scene, name]) for scene, name in young if (scene, name) in old]
    gone = [" / ".join(key) for key in old if key not in young]
    return pairs, gone, [" / ".join(key) for key in young if key not in old]


def _machines(record: dict[str, Any]) -> set[str]:
    """Return the machines and versions, fogproof's own code aside, that a study was drawn with."""
    drawn = [session["environment"] for session in record.get("sessions", ())] or [record["environment"]]
    return {json.dumps({k: v for k, v in table.items() if k != "code"}, sort_keys=True) for table in drawn}


def _one_run(before: dict[str, Any], after: dict[str, Any]) -> bool:
    one, other = ({key: told for key, told in record.items() if key != "history"} for record in (before, after))
    return one == other


def _slipped(change: dict[str, Any]) -> bool:
    """Return whether an estimator became slower or noisier, and not so much less of the other that its errors come as soon."""
    became, time, variance = set(change["became"]), change["time"], change["variance"]
    if not {"slower", "noisier"} & became:
        return False
    if not {"faster", "less noisy"} & became or not (time and variance):
        return True
    off = math.log(time["value"]) + math.log(
        variance["value"]
    )  # time to an error: that of a sample, times the variance
    below = (math.log(one["value"] / one["low"]) if one["low"] > 0 else math.inf for one in (time, variance))
    return off > math.hypot(*below)


def _perhaps(changes: Sequence[dict[str, Any]]) -> str:
    """Name those whose interval does not hold "no change", though so much is not beyond noise."""
    found = [
        f"{_title(c)}, {t['value']:.2g} [{t['low']:.2g}, {t['high']:.2g}] of the time"
        for c in changes
        if (t := c["time"]) and not t["low"] <= 1 <= t["high"] and not {"slower", "faster"} & set(c["became"])
    ]
    return f"; perhaps, and not beyond noise: {_some(found)}" if found else ""


def _some(names: Sequence[str]) -> str:
    more = len(names) - _SHOWN
    return ", ".join(names if more <= 1 else [*names[:_SHOWN], f"and {more} more"])


def _of_speeds(speeds: Speeds, changes: Sequence[dict[str, Any]]) -> str:
    """Say how small a change of speed would have been told."""
    resolutions = [change["time"]["resolution"] for change in changes if change["time"]]
    if speeds.against == "nothing":
        return f"; of less than {LEAST} estimators a change of speed is hardly told from a change of the machine"
    best, worst = (f"{min(end(resolutions), _HARDLY):.3g}" for end in (min, max))
    told = best if best == worst else f"{best} to {worst}"
    more = "; raise replicates to see less" if max(resolutions) >= _HARDLY else ""
    return f"; an estimator {told} times as slow, or as fast, would have been seen{more}"


def _change(
    scene: str, old: dict[str, Any], young: dict[str, Any], speed: Sequence[SpeedChange], alpha: float
) -> dict[str, Any]:
    became = [*_biased(old, young, alpha), *_noisier(old, young, alpha), *became_speed(speed, alpha)]
    time = estimate(speed, alpha) if speed else None
    change = {
        "scene": scene,
        "estimator": young["name"],
        "became": became,
        "time": time,
        "variance": _ratio(old, young),
    }
    return {**change, "worse": "biased" in became or _slipped(change)}


def _moments(estimator: dict[str, Any]) -> Moments:
    m = {key: float(value) for key, value in estimator["moments"].items()}
    return Moments(int(m["n"]), m["mean"], m["m2"], m["m3"], m["m4"], m["low"], m["high"], None)


def _biased(old: dict[str, Any], young: dict[str, Any], alpha: float) -> list[str]:
    """Say whether an estimator was found wrong that was right, or has another mean than it had."""
    if young["status"] == "rejected" and old["status"] != "rejected":
        return ["biased"]
    if young["axis"] != "samples":
        offs = [e["bias"]["value"] if e["bias"] else 0.0 for e in (old, young)]
        worse = abs(offs[1]) > 2 * abs(offs[0]) and young["outcome"] == "rejected"
        return ["biased"] if worse else []
    if young["points"] == "sobol" or old["moments"] == young["moments"] or not _independent(old, young):
        return []
    finding = difference_test("difference", _moments(old), _moments(young), alpha)
    return ["different"] if finding.outcome == "rejected" else []


def _independent(*runs: dict[str, Any]) -> bool:
    """Return whether realisations are independent of each other as far as was seen: else their moments say nothing of a mean."""
    return all(run.get("calls", "independent") == "independent" for run in runs)


def _ratio(old: dict[str, Any], young: dict[str, Any]) -> dict[str, float] | None:
    """Return the ratio of the measured variances and its interval."""
    a, b = old["variance"], young["variance"]
    if not a or not b or not (a["measured"] > 0 and b["measured"] > 0) or young["axis"] != "samples":
        return None
    (below, above), (own_below, own_above) = (_reach(one) for one in (a, b))
    ratio = b["measured"] / a["measured"]
    return asdict(scaled(ratio, math.hypot(own_below, above), math.hypot(own_above, below)))


def _reach(variance: dict[str, Any]) -> tuple[float, float]:
    """Return how far the logarithm of a variance reaches below and above; a heavy tail leaves no upper end, "inf" in a record."""
    low, value, high = (float(variance[end]) for end in ("low", "measured", "high"))
    return math.log(value / low) if low > 0 else math.inf, math.log(high / value)


def _noisier(old: dict[str, Any], young: dict[str, Any], alpha: float) -> list[str]:
    ratio = _ratio(old, young)
    if ratio is None or old["moments"] == young["moments"]:
        return []
    off = math.log(ratio["value"])
    towards = ratio["low"] if off > 0 else ratio["high"]  # no change lies on that side
    spread = abs(math.log(towards / ratio["value"])) / Z if 0 < towards < math.inf else math.inf
    if spread > 0 and abs(off) > normal_quantile(alpha / 2) * spread:
        return ["noisier" if off > 0 else "less noisy"]
    return []


def _title(change: dict[str, Any]) -> str:
    return f"{change['scene']} / {change['estimator']}"
