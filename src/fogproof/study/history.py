"""Two runs compared, before and after a change: what became slower, noisier or biased, beyond noise.

Machines have moods: the common change of all estimators' times is taken out, and how much the times of the others wander says how
much a single one must change to be noticed.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from fogproof.checks.statistics.moments import Moments
from fogproof.checks.statistics.tails import normal_quantile, normal_two_sided
from fogproof.checks.statistics.welch import difference_test
from fogproof.study.convergence import Z

_LEAST = 4
"""Estimators that are needed to tell the machine's mood from a change of one."""
_MAD = 1.4826
"""From the median absolute deviation to the standard deviation of a normal law."""


def compare(before: dict[str, Any], after: dict[str, Any], alpha: float = 1e-6) -> dict[str, Any]:
    """Return what changed between the records of two studies, inside one false-alarm probability alpha."""
    pairs, gone, new = _pairs(before, after)
    mood, wander = _mood(pairs)
    share = alpha / max(1, 3 * len(pairs))
    changes = [_change(old, young, scene, mood, wander, share) for scene, old, young in pairs]
    found = {word: [_title(c) for c in changes if word in c["became"]] for word in _WORDS}
    said = [f"{word}: {', '.join(names)}" for word, names in found.items() if names]
    text = "; ".join(said) if said else "nothing changed beyond noise"
    if sum(_time_ratio(old, young) is not None for _, old, young in pairs) < _LEAST:
        text += f"; of less than {_LEAST} estimators a change of speed is hardly told from a mood of the machine"
    return {
        "before": {
            key: before[key] for key in ("title", "started", "fogproof", "fingerprint", "digest", "environment")
        },
        "same_draws": not gone and not new and all(old["moments"] == young["moments"] for _, old, young in pairs),
        "alpha": alpha,
        "mood": mood,
        "wander": wander,
        "gone": gone,
        "new": new,
        "changes": changes,
        "worse": bool(found["slower"] or found["noisier"] or found["biased"]),
        "text": text,
    }


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


def _time_ratio(old: dict[str, Any], young: dict[str, Any]) -> float | None:
    """Return the logarithm of how much longer a realisation takes."""
    if not (old["speed"] and young["speed"]):
        return None
    a, b = old["speed"]["cpu"]["value"], young["speed"]["cpu"]["value"]
    return math.log(b / a) if a > 0 and b > 0 else None


def _mood(pairs: list[_Pair]) -> tuple[float, float]:
    """Return the common factor of all times, and how far the logarithms of single ones wander from it."""
    ratios = [ratio for _, old, young in pairs if (ratio := _time_ratio(old, young)) is not None]
    if len(ratios) < _LEAST:
        return 1.0, math.log(2)
    middle = float(np.median(ratios))
    return math.exp(middle), _MAD * float(np.median(np.abs(np.array(ratios) - middle)))


def _change(
    old: dict[str, Any], young: dict[str, Any], scene: str, mood: float, wander: float, alpha: float
) -> dict[str, Any]:
    became = [*_biased(old, young, alpha), *_noisier(old, young, alpha)]
    ratio = _time_ratio(old, young)
    time = None
    if ratio is not None:
        own = math.hypot(*(_spread(e["speed"]["cpu"]) for e in (old, young)))
        spread = math.hypot(own, wander)
        off = ratio - math.log(mood)
        if spread > 0 and normal_two_sided(off / spread) <= alpha:
            became.append("slower" if off > 0 else "faster")
        reach = math.exp(Z * spread)
        time = {"value": math.exp(off), "low": math.exp(off) / reach, "high": math.exp(off) * reach}
    return {"scene": scene, "estimator": young["name"], "became": became, "time": time, "variance": _ratio(old, young)}


def _spread(time: dict[str, float]) -> float:
    return math.log(time["high"] / time["low"]) / (2 * Z) if 0 < time["low"] < time["high"] else 0.0


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
    if young["points"] == "sobol" or old["moments"] == young["moments"]:
        return []
    finding = difference_test("difference", _moments(old), _moments(young), alpha)
    return ["different"] if finding.outcome == "rejected" else []


def _ratio(old: dict[str, Any], young: dict[str, Any]) -> dict[str, float] | None:
    """Return the ratio of the measured variances and its interval."""
    a, b = old["variance"], young["variance"]
    if not a or not b or not (a["measured"] > 0 and b["measured"] > 0) or young["axis"] != "samples":
        return None
    reach = math.exp(math.hypot(math.log(a["high"] / a["measured"]), math.log(b["high"] / b["measured"])))
    ratio = b["measured"] / a["measured"]
    return {"value": ratio, "low": ratio / reach, "high": ratio * reach}


def _noisier(old: dict[str, Any], young: dict[str, Any], alpha: float) -> list[str]:
    ratio = _ratio(old, young)
    if ratio is None or old["moments"] == young["moments"]:
        return []
    spread = math.log(ratio["high"] / ratio["value"]) / Z
    off = math.log(ratio["value"])
    if spread > 0 and abs(off) > normal_quantile(alpha / 2) * spread:
        return ["noisier" if off > 0 else "less noisy"]
    return []


def _title(change: dict[str, Any]) -> str:
    return f"{change['scene']} / {change['estimator']}"
