"""Integrals that no quadrature settles, estimated on points of a known law: the mean cosine, and the albedo."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fogproof.checks.mixture import MixtureTest
from fogproof.checks.statistics.cells import MISS
from fogproof.checks.statistics.integrated import Integrated
from fogproof.checks.statistics.tails import normal_quantile
from fogproof.checks.streams import batch_generator
from fogproof.checks.subject import call
from fogproof.checks.verdict import Finding, Outcome, Resolution

_POINTS = 1 << 18
_BEYOND_DOUBT = 8.0  # standard errors: a false alarm has probability 1e-15

_RARE = 24.0  # expected points like the largest, of which one at most is seen with probability 1e-9


def mean_cosine(mixture: MixtureTest) -> Finding:
    """The mean of x . axis under the pdf must be the declared one."""
    subject = mixture.subject
    assert subject.mean_cosine is not None
    axis = np.asarray(subject.axis)
    finding = _estimated("mean cosine", mixture, lambda x: mixture.density(x) * (x @ axis), subject.mean_cosine)
    return finding.because("sign convention") if finding.outcome == "rejected" else finding


def albedo(mixture: MixtureTest) -> list[Finding]:
    """The integral of `eval` over the domain must be the declared albedo, channel by channel."""
    subject = mixture.subject
    claims = np.atleast_1d(np.asarray(subject.albedo, dtype=float))
    findings = []
    for channel, claim in enumerate(claims.tolist()):

        def f(x: np.ndarray, channel: int = channel) -> np.ndarray:
            assert subject.eval is not None
            inside = subject.domain.contains(x, 16 * subject.roundoff)
            values = np.asarray(call("eval(x)", subject.eval, x), dtype=np.float64)
            return np.where(inside, values if values.ndim == 1 else values[:, channel], 0.0)

        name = "albedo" if len(claims) == 1 else f"albedo of channel {channel}"
        finding = _estimated(name, mixture, f, claim)
        findings.append(finding.because("wrong weight") if finding.outcome == "rejected" else finding)
    return findings


def reach(found: Integrated) -> float:
    """Return how far chance moves the mean: where few points tell how often high ones come, by a Poisson law beside the normal."""
    return _BEYOND_DOUBT * found.error + (_RARE * found.largest if found.dominated else 0.0)


def _estimated(name: str, mixture: MixtureTest, f: Callable[[np.ndarray], np.ndarray], claim: float) -> Finding:
    x, q = mixture.known(batch_generator(mixture.seed, name, 0, 0), _POINTS)
    with np.errstate(all="ignore"):
        found = Integrated.of(f(x) / q)
    if found.why_unknown:
        return Finding(name, "inconclusive", f"{name} of the pdf is not known: {found.why_unknown}")
    mean, error = found.mean, found.error
    message = f"{name} of the pdf is {mean:.6g} +- {error:.1g} by points of a known law, declared {claim:.9g}"
    far = reach(found)
    resolution = Resolution(f"error of the {name}", far + normal_quantile(MISS) * error, MISS)
    outcome: Outcome = "rejected" if abs(mean - claim) > far + 1e-12 else "not rejected"
    return Finding(name, outcome, message, effect=mean - claim, resolution=resolution)
