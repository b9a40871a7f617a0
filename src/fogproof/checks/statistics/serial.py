"""Serial correlation: does a sample know those before it?

Sorted, stratified or antithetic output, generators that start again, parameters that are set one call too late, numbers that the
next sample uses once more: the distribution can be perfect and the samples still not independent. Looked at are lags of 1 to 64,
within each axis and across, and the two halves of a call. A sample may know how far from the middle another is and not on which
side (the tent map, x -> 1 - |2 x - 1|, is not correlated with itself): each axis has a second score, the distance from its middle.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields

import numpy as np
from numpy.lib.stride_tricks import as_strided

from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.tails import normal_quantile
from fogproof.checks.verdict import Finding, Outcome, Resolution

LAGS = 64
_UNIT = 2.0**15  # of scores, for the lag of 1
_BITS = 9  # dropped of them for the others: products of what is left are exact in single precision
_STRONG = 0.5  # a correlation that leaves little of the sample
_ANTITHETIC = 0.4  # half of the pairs of neighbours are no antithetic pair
_LEAST = 100  # pairs


@dataclass(frozen=True)
class Successions:
    """Sums over the scores (n, k) of one stream of samples, less their claimed mean 1/2, as whole numbers.

    The first half of the k scores are those of the axes, the second half twice their distances from the middle.

    Whole numbers add up to the same in any order: batches may be counted anywhere.

    sums     (k,) of the scores, in units of 2^-15
    squares  (k,) of their squares
    next     (k, k) of each sample's scores with the next one's
    counts   (2,) how many samples and successions those are
    coarse   (k,) as `sums`, in units of 2^-6, of the samples below
    powers   (k,) as `squares`
    lagged   (64, k, k) of each sample's scores with those 1, 2, ... 64 later, among the first samples
    halves   (k, k) of the scores in the first half of a call with those at the same place in its second half
    many     (66,) how many samples, pairs of each lag, and pairs of halves those are
    """

    sums: np.ndarray
    squares: np.ndarray
    next: np.ndarray
    counts: np.ndarray
    coarse: np.ndarray
    powers: np.ndarray
    lagged: np.ndarray
    halves: np.ndarray
    many: np.ndarray

    @staticmethod
    def of(d: list[np.ndarray], first: bool) -> Successions:
        """Return the sums of one batch; d holds the scores (n,) of each axis, in units, see `in_units`.

        first  whether it is one of the first batches, in which all lags are looked at

        In double precision sums of up to 2^23 products are exact, and three times as fast as those of integers.
        """
        d = [*d, *(2 * np.abs(one) - _UNIT / 2 for one in d)]
        n, k = len(d[0]), len(d)
        sums = np.array([one.sum() for one in d]).astype(np.int64)
        squares = np.array([one @ one for one in d]).astype(np.int64)
        following = np.array([[one[:-1] @ other[1:] for other in d] for one in d]).astype(np.int64)
        counts = np.array([n, max(n - 1, 0)])
        whole = n - n % LAGS if first else 0
        c = [_fewer_bits(one[:whole]) for one in d]
        many = np.concatenate([[whole], np.maximum(whole - np.arange(1, LAGS + 1), 0), [n // 2 if first else 0]])
        products = [np.rint(float(one @ one)) for one in c]
        early, late = _halves(d, 0, first), _halves(d, 1, first)
        half = [[np.rint(float(one @ other)) for other in late] for one in early]
        return Successions(
            sums,
            squares,
            following,
            counts,
            np.array([int(one.sum(dtype=np.float64)) for one in c]),
            np.array(products).astype(np.int64),
            _lagged(c) if whole else np.zeros((LAGS, k, k), dtype=np.int64),
            np.array(half).astype(np.int64),
            many,
        )

    def merged(self, other: Successions) -> Successions:
        """Return the sums of both streams."""
        return Successions(*(getattr(self, f.name) + getattr(other, f.name) for f in fields(self)))


def _halves(d: list[np.ndarray], second: int, first: bool) -> list[np.ndarray]:
    """Return the coarse scores of the first or the second half of a call, whatever its size; none but of the first batches."""
    half = len(d[0]) // 2 if first else 0
    begin = second * (len(d[0]) - half)
    return [_fewer_bits(one[begin : begin + half]) for one in d]


def _lagged(c: list[np.ndarray]) -> np.ndarray:
    """Return (64, k, k) sums of products of scores 1 to 64 apart, by two matrix products over rows of 64 samples.

    Within a row and from a row to the next one, gram[a, i, b, j] sums score a at place i times score b at place j, j up to 127: a
    lag is a diagonal, j - i.
    """
    k = len(c)
    rows = np.concatenate([one.reshape(-1, LAGS) for one in c], axis=1)
    gram = np.empty((k, LAGS, k, 2 * LAGS))
    gram[..., :LAGS] = (rows.T @ rows).reshape(k, LAGS, k, LAGS)
    gram[..., LAGS:] = (rows[:-1].T @ rows[1:]).reshape(k, LAGS, k, LAGS)
    a, i, b, j = gram.strides
    diagonals = as_strided(gram[..., 1:], (LAGS, k, k, LAGS), (j, a, b, i + j), writeable=False)
    return np.rint(diagonals.sum(axis=3)).astype(np.int64)


def in_units(scores: np.ndarray) -> np.ndarray:
    """Return scores on (0, 1) less 1/2, in whole units."""
    return np.rint((scores - 0.5) * _UNIT)


def _fewer_bits(scores: np.ndarray) -> np.ndarray:
    """Return scores in units larger by 2^9, rounded down, in single precision."""
    return np.floor(scores * 2.0**-_BITS).astype(np.float32)


def serial_test(name: str, sums: Successions | None, alpha: float) -> Finding:
    """Test that samples are uncorrelated with the next one, with those up to 64 later, and with the other half of their call.

    Products of centred scores of independent samples are martingale differences, so Bernstein's inequality (Freedman 1975) bounds
    the tail of their sum whatever the law of the scores; half the level goes to the next sample, half to all other pairs together.
    """
    if sums is None or sums.counts[1] < _LEAST:
        return Finding(name, "not rejected", "too few samples to see a correlation", 1.0, alpha)
    mean, variance = _moments(sums.sums, sums.squares, int(sums.counts[0]))
    best = _largest(sums.next[None], sums.counts[1:], mean, variance, _UNIT / 2)
    what, tries = "of successive samples", 2.0 * sums.next.size
    if sums.many[0] >= _LEAST * LAGS:
        mean, variance = _moments(sums.coarse, sums.powers, int(sums.many[0]))
        products = np.concatenate([sums.lagged[1:], sums.halves[None]])
        other = _largest(products, sums.many[2:], mean, variance, _UNIT / 2**_BITS / 2)
        rivals = 2.0 * products.size
        if other.p * rivals < best.p * tries:
            place = other.index // sums.next.size
            what = "of the two halves of a call" if place == LAGS - 1 else f"of samples {place + 2} apart"
            best, tries = other, rivals
    p = min(1.0, best.p * tries)
    rejected = p <= alpha
    outcome: Outcome = "rejected" if rejected else "not rejected"
    message = f"the largest correlation, {what}, is {best.coefficient:+.3g}"
    message += _kind(best, len(sums.sums)) if rejected else ""
    cause = "dependent samples" if abs(best.coefficient) > _STRONG else "correlation"
    pairs = int(sums.many[1]) if sums.many[0] else int(sums.counts[1])
    seen = Resolution(f"correlation at a lag up to {LAGS}", _seen(pairs, 2.0 * LAGS * sums.next.size, alpha), MISS)
    return Finding(
        name, outcome, message, p, alpha, False, best.z, best.coefficient, seen, cause=cause if rejected else ""
    )


def _kind(best: _Largest, k: int) -> str:
    """Return in words what a rejected correlation of two of k scores is, "" if it is a plain one."""
    folded = [score >= k // 2 for score in divmod(best.index % (k * k), k)]
    if all(folded):
        return ": how far from the middle a sample is tells how far another is"
    if any(folded):
        return ": how far from the middle a sample is goes with where another is"
    return ": an antithetic stream" if best.coefficient < -_ANTITHETIC else ""


def _seen(pairs: int, rivals: float, alpha: float) -> float:
    """Return the correlation of uniform scores that so many pairs show, but for `MISS`.

    Bernstein's exponent z^2 / (2 (1 + z / sqrt(pairs))) must reach the level, and products of correlated scores scatter more.
    """
    root, level = math.sqrt(max(pairs, 1)), math.log(2 * rivals / alpha)
    critical = level / root + math.sqrt((level / root) ** 2 + 2 * level)
    return min((critical + normal_quantile(MISS) * (1 + critical / root)) / root, 1.0)


@dataclass(frozen=True)
class _Largest:
    """The most conspicuous of many sums of products: a bound on its own p-value, its z, its correlation, and which one it is."""

    p: float
    z: float
    coefficient: float
    index: int


def _moments(sums: np.ndarray, squares: np.ndarray, n: int) -> tuple[np.ndarray, np.ndarray]:
    mean = sums / n
    return mean, np.maximum(squares / n - mean**2, 0.0)


def _largest(products: np.ndarray, pairs: np.ndarray, mean: np.ndarray, variance: np.ndarray, bound: float) -> _Largest:
    """Return the largest of sums of products (m, k, k) over `pairs` (m,) pairs of scores within +-`bound`."""
    number = np.maximum(pairs, 1)[:, None, None]
    excess = products - number * np.outer(mean, mean)
    spread = number * np.outer(variance, variance)
    limit = (bound + np.abs(mean).max()) ** 2
    with np.errstate(divide="ignore", invalid="ignore"):
        exponent = np.where(spread > 0, excess**2 / (2 * (spread + limit * np.abs(excess) / 3)), 0.0)
        z = np.where(spread > 0, excess / np.sqrt(spread), 0.0)
    i = int(np.argmax(exponent))
    coefficient = float((z / np.sqrt(number)).flat[i])
    return _Largest(min(1.0, 2 * math.exp(-float(exponent.flat[i]))), float(z.flat[i]), coefficient, i)
