"""What goes wrong with numbers: scales, shifts, signs, powers of the coordinate, logarithms of another base."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import partial

import numpy as np

from fogproof.checks.diagnosis import families, folds, stretches
from fogproof.checks.diagnosis.contrast import Density
from fogproof.checks.diagnosis.grids import SHIFTS
from fogproof.checks.diagnosis.hypothesis import Hypothesis, Setting, known_number
from fogproof.domains import HalfLine, Interval, RealLine

_MIDDLE = 0.05  # of a standard deviation: a claim's middle is told no closer
_MEASURED = 0.03  # relative error of a claim's deviation, told by points of the known law
_WHOLE = 0.01  # relative standard error of a power that is whole
_PARABOLA = 1e-6  # share of the variance of a logarithm that a parabola leaves
SCALES = (0.001, 0.01, 0.1, 0.3, 0.5, 0.8, 0.95, 1.05, 1.25, 2.0, 3.0, 10.0, 100.0, 1000.0)
_POWERS = (-2.0, -1.5, -1.0, -0.5, -0.2, 0.2, 0.5, 1.0, 1.5, 2.0)
_NAMES = {
    math.log(10): "the decimal logarithm was taken for the natural one",
    1 / math.log(10): "the natural logarithm was taken for the decimal one",
    math.log(2): "the binary logarithm was taken for the natural one",
    1 / math.log(2): "the natural logarithm was taken for the binary one",
    180 / math.pi: "radians were taken for degrees",
    math.pi / 180: "degrees were taken for radians",
    2.0: "a factor of 2",
    0.5: "a factor of 1/2",
    4.0: "a factor of 4",
    0.25: "a factor of 1/4",
    2 * math.pi: "a factor of 2 pi",
    4 * math.pi: "a factor of 4 pi",
    math.pi: "a factor of pi",
}
_EXPONENTS = known_number(
    {
        1 / k if "taken" in words and "log" not in words else k: words
        for k, words in _NAMES.items()
        if "binary" not in words  # a deviation of 1.2 is no logarithm of Box and Muller's (1958)
    }
)
_EXPONENT = "these samples fit the pdf of an exponent {value} times as large"
_STRETCHES = {1 / k if "log" in words else k: words for k, words in _NAMES.items()}
STRETCHED = known_number(_STRETCHES)


def hypotheses(setting: Setting) -> Iterator[Hypothesis]:
    """Yield what may have happened to numbers, the simplest first."""
    domain, x = setting.domain, setting.contrast.x
    spread = float(np.subtract(*np.quantile(x, [0.75, 0.25]))) or 1.0
    origin = domain.a if isinstance(domain, (HalfLine, Interval)) else 0.0
    if isinstance(domain, (HalfLine, Interval)):
        words = "these samples fit the pdf over x: a square root is missing, or a factor x"
        yield Hypothesis(
            "missing Jacobian", words, lambda s, _: lambda x: s.p(x) / np.maximum(np.abs(x - origin), 1e-12)
        )
    if isinstance(domain, Interval):
        yield from _over_sines()
        yield from _turned_or_shifted_round(domain)
    else:
        yield Hypothesis("sign convention", "these samples fit the pdf of -x", lambda s, _: lambda x: s.p(-x))
    if isinstance(domain, RealLine):
        yield from folds.hypotheses(setting, "x")
        yield from _of_another_deviation(setting)
    yield from _of_another_scale(setting, origin)
    if not isinstance(domain, Interval):
        yield from families.hypotheses(setting)
    if isinstance(domain, HalfLine):
        yield Hypothesis(
            "wrong power",
            "these samples fit the pdf of x raised to the power {value}",
            lambda s, a: lambda x: s.p(origin + _raised(x - origin, 1 / a)) * _raised(x - origin, 1 / a - 1),
            (0.5, 0.8, 0.95, 1.05, 1.25, 2.0),
            null=1.0,
        )
    yield Hypothesis(
        "shifted",
        "these samples fit the pdf shifted by {value}",
        lambda s, d: lambda x: s.p(x - d),
        tuple(spread * f for f in (-3.0, -1.0, -0.3, -0.1, 0.1, 0.3, 1.0, 3.0)),
        null=0.0,
    )
    yield from _of_another_measure(origin)
    yield from stretches.hypotheses(setting)


def _turned_or_shifted_round(domain: Interval) -> Iterator[Hypothesis]:
    length = domain.b - domain.a
    yield Hypothesis("uniform law", "these samples are uniform", lambda s, _: lambda x: np.ones(len(x)))
    yield Hypothesis(
        "sign convention",
        "these samples fit the pdf with its axis turned round",
        lambda s, _: lambda x: s.p(domain.a + domain.b - x),
    )
    yield Hypothesis(
        "shifted",
        "these samples fit the pdf shifted round by {value}",
        lambda s, d: lambda x: s.p(domain.a + (x - d - domain.a) % length),
        tuple(length * f for f in SHIFTS),
        null=0.0,
    )


def _of_another_scale(setting: Setting, origin: float) -> Iterator[Hypothesis]:
    """Yield a stretch, and a power of the pdf: that is another scale too where its logarithm is a parabola, or a line."""
    powers = partial(Hypothesis, density=_to_the_power, trials=SCALES, null=1.0, power=True)
    if _parabolic(setting):
        yield powers("wrong scale", _EXPONENT, named=_EXPONENTS)
        yield _stretched(origin, "")
    else:
        yield _stretched(origin, "")
        words = "these samples fit the pdf raised to the power {value}, as of another parameter of its tails"
        yield powers("another parameter", words)


def of_another_exponent(where: str) -> Hypothesis:
    """Return that the logarithm of the claim is multiplied by a number, as of a normal law of another deviation."""
    return Hypothesis("wrong scale", _EXPONENT + where, _to_the_power, SCALES, _EXPONENTS, null=1.0, power=True)


def _to_the_power(setting: Setting, power: float) -> Density:
    return lambda x: np.maximum(setting.p(x), 0.0) ** power


def _parabolic(setting: Setting) -> bool:
    """Return whether the logarithm of the claim is a polynomial of degree 2 at most where the samples are."""
    x = setting.claimed_points(512)
    p = setting.p(x)
    if not np.all((p > 0) & np.isfinite(p)) or np.ptp(x) == 0:
        return False
    u = (x - x.mean()) / np.ptp(x)
    left = np.log(p) - np.polyval(np.polyfit(u, np.log(p), 2), u)
    return float(np.var(left)) <= _PARABOLA * float(np.var(np.log(p)))


def _stretched(origin: float, where: str, names: dict[float, str] | None = None) -> Hypothesis:
    return Hypothesis(
        "wrong scale",
        "these samples fit the pdf stretched by {value}" + where,
        lambda s, a: lambda x: s.p(origin + (x - origin) / a),
        SCALES,
        lambda value, error: STRETCHED(value, error) or _of_the_claim(value, error, names or {}),
        null=1.0,
    )


def _of_another_measure(origin: float) -> Iterator[Hypothesis]:
    yield Hypothesis(
        "missing Jacobian",
        "these samples fit the pdf times a power of x, {value}",
        lambda s, a: lambda x: s.p(x) * np.maximum(np.abs(x - origin), 1e-12) ** a,
        _POWERS,
        known_number(
            {-1.0: "a factor x is missing", 1.0: "a factor x too many", -2.0: "a factor x^2 is missing"}, _WHOLE
        ),
        otherwise="wrong power",
        null=0.0,
    )
    if origin != 0.0:
        yield Hypothesis(
            "missing Jacobian",
            "these samples fit the pdf divided by x: a factor x is missing",
            lambda s, _: lambda x: s.p(x) / np.maximum(np.abs(x), 1e-12),
        )
    yield Hypothesis(
        "missing Jacobian",
        "these samples fit the pdf times sin x: an angle was taken for its cosine, or a sine is too many",
        lambda s, _: lambda x: s.p(x) * np.abs(np.sin(x)),
    )
    yield from _over_sines()


def _over_sines() -> Iterator[Hypothesis]:
    yield Hypothesis(
        "missing Jacobian",
        "these samples fit the pdf over sin x: a sine is missing",
        lambda s, _: lambda x: s.p(x) / np.maximum(np.abs(np.sin(x)), 1e-9),
    )


def _of_the_claim(value: float, error: float, names: dict[float, str]) -> str:
    """Return what a stretch is by what the claim itself measures, which is known to a few per cent."""
    near = [words for number, words in names.items() if abs(value / number - 1) < _MEASURED + 3 * error / number]
    return near[0] if len(near) == 1 and abs(value - 1) > 3 * _MEASURED else ""


def _raised(x: np.ndarray, power: float) -> np.ndarray:
    return np.asarray(np.maximum(x, 1e-300) ** power)


def _of_another_deviation(setting: Setting) -> Iterator[Hypothesis]:
    """Yield that the samples are spread otherwise about where the claim is."""
    n = len(setting.contrast.x)
    order = np.argsort(setting.contrast.z)
    z, law = setting.contrast.z[order], setting.law
    u, ratio = law.coordinates(z, np.full((len(z), 1), 0.5))[:, 0], setting.values[n:][order] / law.density(z)
    share = np.concatenate([[0.0], np.cumsum(0.5 * (ratio[1:] + ratio[:-1]) * np.diff(u))])  # closer than by chance
    if not (np.isfinite(share[-1]) and share[-1] > 0):
        return
    low, middle, high = np.interp((0.158655, 0.5, 0.841345), share / share[-1], z).tolist()
    deviation = 0.5 * (high - low)
    if not deviation > 0:
        return
    middle = round(middle, -math.floor(math.log10(_MIDDLE * deviation)))
    names = {deviation: "as if a variance stood for the standard deviation"}
    names[deviation**-0.5] = "as if the standard deviation stood for a variance"
    yield _stretched(0.0, "", names)
    if abs(middle) > _MIDDLE * deviation:
        yield _stretched(middle, f" about {middle:.4g}", names)
