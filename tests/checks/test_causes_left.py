"""What a cause on a line leaves is held to exact integrals: they see what points of a known law beside the samples do not."""

import numpy as np
import pytest

from fogproof import Interval, check_sampler
from fogproof.checks.diagnosis.explaining import setting_of
from fogproof.checks.diagnosis.integrated import left_on_a_line
from fogproof.checks.subject import Subject

SIGMA, WALL = np.array([0.3, 1.0, 4.0]), 1.5  # of three channels [1/m], and where distances end [m]
REACH = np.exp(-SIGMA * WALL).mean()


def rounded_channel(u):
    """Channels with the weights 1/4, 1/2, 1/4: a number that is rounded where it should be cut off."""
    return np.minimum(-np.log1p(-u[:, 0]) / SIGMA[np.rint(2 * u[:, 1]).astype(int)], WALL)


def equal_channels(t):
    return np.mean(SIGMA * np.exp(-SIGMA * t[:, None]), axis=-1)


@pytest.mark.parametrize("seed", range(3))
def test_a_law_that_the_same_samples_refuse_is_no_cause(seed):
    """Another scale, or another power, explains 95 % of it: neither is what happened."""
    verdict = check_sampler(
        rounded_channel,
        equal_channels,
        Interval(0, WALL),
        dimensions=2,
        atoms={WALL: REACH},
        samples=300_000,
        seed=seed,
    )
    assert verdict.cause == "shape", str(verdict)


def rippled(size):
    return lambda x: 1 + size * np.cos(2 * np.pi * x)


@pytest.mark.parametrize("seed", range(4))
def test_only_what_is_no_chance_is_left(seed):
    subject = Subject(lambda u: u[:, 0], rippled(0), Interval(0, 1), 1)
    setting = setting_of(subject, 60_000, seed)
    assert left_on_a_line(subject, setting.contrast, rippled(0)) == 0
    assert left_on_a_line(subject, setting.contrast, lambda x: 7 * rippled(0)(x)) == 0, "a constant is none of it"
    lost = 60_000 * 0.05**2 / 4  # of log-likelihood, by a ripple of 5 %
    assert left_on_a_line(subject, setting.contrast, rippled(0.05)) == pytest.approx(lost, rel=0.6)
