"""Tests of pooled differences: sums over many pixels see what no pixel shows.

A right image differs from its reference by independent noise of mean 0, whatever its law and however unequal its variances. So
the sum of weighted differences is held to 0 by its own scatter (Student's t, its tail corrected for skewness; exact for two
values), with weights that depend on the reference alone: weights made from the noise would be biased by it. Where rare values
carry too much for such a test, bets see what is too bright, whatever the law; then nothing is said of what is too dark.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from fogproof.checks.statistics.bets import Bets
from fogproof.checks.statistics.known import NOTHING, Known
from fogproof.checks.statistics.means import mean_test
from fogproof.checks.statistics.moments import Moments
from fogproof.checks.verdict import EffectInterval, Finding, Resolution
from fogproof.images.regions import LEAST, families
from fogproof.images.residuals import Residuals

SHARES = {"image": 0.35, "regions": 0.35, "contrasts": 0.2, "bets": 0.1}
"""Shares of alpha; see `pooled_tests`."""


@dataclass(frozen=True)
class Pool:
    """Weighted differences whose mean is tested: `what` in words, the family, weights (rows, columns, channels)."""

    what: str
    family: str
    weight: np.ndarray
    channel: int


def pooled_tests(
    found: Residuals, alpha: float, names: tuple[str, ...], positive: bool = True
) -> tuple[list[Finding], list[str]]:
    """Return one finding a family, and in words what could not be tested.

    positive  reference and difference add up to radiances, which are never negative; those of two images do not
    """
    findings: list[Finding] = []
    unchecked: list[str] = []
    channels = range(found.difference.shape[2])
    whole = list(_whole(found, names))
    means = [_test(found, pool, SHARES["image"] * alpha / len(whole)) for pool in whole]
    for c in channels:
        own = [finding for finding, pool in zip(means, whole, strict=True) if pool.channel == c]
        open_ = [finding for finding in own if finding.outcome == "inconclusive"]
        if open_ and len(open_) < len(own):  # one of the two means is enough
            unchecked += [f"{finding.check}: {finding.message}" for finding in open_]
            own = [finding for finding in own if finding.outcome != "inconclusive"]
        findings += own
    labels = families(np.mean(found.reference, axis=2))
    for family, label in labels.items():
        share = SHARES["regions"] * alpha / len(labels)
        _add(findings, unchecked, family, _regions(found, family, label, share, names))
    contrasts = [pool for channel in channels for pool in _contrasts(found, channel, names)]
    tested = [_test(found, pool, SHARES["contrasts"] * alpha / len(contrasts)) for pool in contrasts]
    _add(findings, unchecked, "contrasts", tested)
    bets = [_bet(found, c, SHARES["bets"] * alpha / len(channels), names) for c in channels] if positive else []
    findings += [bet for bet in bets if bet is not None and bet.outcome == "rejected"]
    return findings, unchecked


def _whole(found: Residuals, names: tuple[str, ...]) -> Iterator[Pool]:
    for c in range(found.difference.shape[2]):
        yield Pool(f"mean of {names[c]}", "image", _bounded(found.reference[..., c]), c)
        if np.ptp(found.reference[..., c]) > 0:
            yield Pool(f"mean of {names[c]} relative to the reference", "image", _inverse(found.reference[..., c]), c)


def _bounded(reference: np.ndarray) -> np.ndarray:
    """Return weights 1 but where the reference exceeds twice its mean: close to a lamp a few pixels would be all there is."""
    top = 2 * float(np.mean(np.abs(reference)))
    return top / np.maximum(np.abs(reference), top) if top > 0 else np.ones(reference.shape)


def _inverse(reference: np.ndarray) -> np.ndarray:
    """Return weights mean / reference, no larger than at a tenth of the mean: what is nearly black tells little."""
    mean = float(np.mean(np.abs(reference)))
    return mean / np.maximum(np.abs(reference), 0.1 * mean) if mean > 0 else np.ones(reference.shape)


def _contrasts(found: Residuals, channel: int, names: tuple[str, ...]) -> Iterator[Pool]:
    """Yield sums that a shift, a blur and a curve of brightness change most."""
    reference = found.reference[..., channel]
    if min(reference.shape) < 3 or not np.ptp(reference) > 0:
        return
    reference = reference / np.max(np.abs(reference))  # the square of next to nothing would be nothing
    down, right = np.gradient(reference)
    bent = np.gradient(down, axis=0) + np.gradient(right, axis=1)
    mean = float(np.mean(reference))
    curve = reference * np.log(np.maximum(reference, 1e-3 * mean) / mean) if mean > 0 else reference
    curve = curve - mean_of(curve * reference) / mean_of(reference * reference) * reference
    for what, weight in (("to the right", right), ("downwards", down), ("blur", bent), ("curve of brightness", curve)):
        if not np.max(np.abs(weight)) > 1e-12 * abs(mean):
            continue
        # Noise grows with brightness, so what is bright counts less; and no pixel carries more than others can balance.
        weight = weight * _inverse(reference) ** 2
        size = np.abs(weight)
        if size.max() > 0:
            limit = 8 * float(np.sqrt(np.mean(np.minimum(size, np.quantile(size, 0.99)) ** 2)))
            yield Pool(f"contrast of {names[channel]}: {what}", "contrasts", np.clip(weight, -limit, limit), channel)


def mean_of(x: np.ndarray) -> float:
    """Return the mean as a plain number."""
    return float(np.mean(x))


def _test(found: Residuals, pool: Pool, alpha: float, inside: np.ndarray | None = None) -> Finding:
    """Test that the weighted mean of the differences is 0."""
    where = found.good if inside is None else found.good & inside
    weight = pool.weight[where]
    d, allowed = found.difference[..., pool.channel][where], found.allowed[..., pool.channel][where]
    if len(d) == 0 or not np.any(weight):
        return Finding(pool.what, "inconclusive", "there are no pixels", alpha=alpha)
    size = float(np.mean(np.abs(weight)))
    x = weight * d / size
    error = float(np.mean(np.abs(weight) * allowed)) / size
    base = float(np.mean(weight * found.reference[..., pool.channel][where])) / size
    data = Moments.of(x)
    if float(np.mean(np.abs(x))) <= error:  # what is there cannot be told from what is allowed, whatever its law
        message = f"{len(d)} pixels are the reference to within its error, rounding and tolerance"
        scale = abs(base) or 1.0
        return Finding(
            pool.what, "not rejected", message, alpha=alpha, effect=float(data.mean / scale),
            resolution=Resolution("relative bias of the image", 2 * error / scale, 1e-9) if pool.family == "image" else None,
        )  # fmt: skip
    if data.low == data.high:  # each pixel is off by the same: no noise at all
        x = x * (1 + 1e-12 * (np.arange(len(x)) % 2))
        data = Moments.of(x)
    finding = mean_test(pool.what, pool.what, data, 0.0, error, alpha, known=NOTHING, uncertain=0.0)
    return _in_words(finding, data, base, pool, len(d))


def _in_words(finding: Finding, data: Moments, base: float, pool: Pool, n: int) -> Finding:
    """Return the finding with effects relative to the reference, where that has a mean to be relative to."""
    relative = pool.family != "contrasts" and base > 0
    scale = base if relative else 1.0
    unit = "relative bias of the image" if relative and pool.family == "image" else "bias"
    stderr = data.stderr / scale
    message = f"{n} pixels are off by {data.mean / scale:+.3g} +- {stderr:.1g}" + (
        " of their reference" if relative else ""
    )
    if finding.outcome == "inconclusive":
        message += "; " + finding.message.partition(";")[2].strip().split(". ")[0] if ";" in finding.message else ""
    resolution, interval = finding.resolution, finding.interval
    return replace(
        finding,
        message=message,
        effect=data.mean / scale,
        resolution=None if resolution is None else Resolution(unit, resolution.value / scale, resolution.miss),
        interval=None
        if interval is None
        else EffectInterval(interval.low / scale, interval.high / scale, interval.confidence),
        region=(("too bright" if data.mean > 0 else "too dark"),)
        if finding.outcome == "rejected" and pool.family != "contrasts"
        else (),
    )


def _regions(found: Residuals, family: str, label: np.ndarray, alpha: float, names: tuple[str, ...]) -> list[Finding]:
    """Return a finding for each region that is large enough, in each channel."""
    kinds, counts = np.unique(label[found.good], return_counts=True)
    kinds = kinds[counts >= LEAST]
    channels = range(found.difference.shape[2])
    weights = [_bounded(found.reference[..., c]) for c in channels]
    results = []
    for kind in kinds:
        inside = label == kind
        y, x = np.nonzero(inside)
        place = {
            "rows": f"rows {y.min()} to {y.max()}",
            "columns": f"columns {x.min()} to {x.max()}",
            "tiles": f"columns {x.min()} to {x.max()}, rows {y.min()} to {y.max()}",
            "rings": f"ring {kind + 1} of {len(kinds)} about the middle",
            "brightness": f"part {kind + 1} of {len(kinds)} by brightness",
        }[family]
        for c in channels:
            pool = Pool(f"{family}, {place}" + (f", {names[c]}" if len(channels) > 1 else ""), "regions", weights[c], c)
            results.append(_test(found, pool, alpha / (len(kinds) * len(channels)), inside))
    return results


def _add(findings: list[Finding], unchecked: list[str], family: str, tested: list[Finding]) -> None:
    """Add what a family found: those regions that are rejected, or one finding that none is."""
    if not tested:
        return
    rejected = sorted((f for f in tested if f.outcome == "rejected"), key=lambda f: (f.p_value is not None, f.p_value))
    open_ = [f for f in tested if f.outcome == "inconclusive"]
    findings += rejected[:5]
    if open_:
        unchecked.append(f"{len(open_)} of {len(tested)} {family}: too skewed, or too few pixels")
    passed = [f for f in tested if f.outcome == "not rejected"]
    if passed and not rejected:
        least = min(passed, key=lambda f: 1.0 if f.p_value is None else f.p_value)
        words = f"none of {len(passed)} is off; the least likely: {least.check}"
        findings.append(replace(least, check=family, message=words, resolution=None))


def _bet(found: Residuals, channel: int, alpha: float, names: tuple[str, ...]) -> Finding | None:
    """Bet that pixels are brighter than claimed; that they are never negative is all that is relied on."""
    good = found.good & (found.reference[..., channel] > 0)
    good &= found.allowed[..., channel] <= 1e-3 * found.reference[..., channel]
    reference, d = found.reference[..., channel][good], found.difference[..., channel][good]
    if not len(d):
        return None
    relative = 1 + d / reference
    if relative.min() < 0:
        return None
    high = 1 + float(np.max(found.allowed[..., channel][good] / reference))
    bets = Bets(1.0, high, Known(low=0.0), len(d), alpha).after(relative)
    what = f"bets on {names[channel]}"
    rejected = bets.p_value <= alpha
    message = f"{len(d)} pixels are brighter than the reference, whatever the law of their noise"
    return Finding(
        what,
        "rejected" if rejected else "not rejected",
        message,
        bets.p_value,
        alpha,
        region=("too bright",),
        distribution_free=True,
    )
