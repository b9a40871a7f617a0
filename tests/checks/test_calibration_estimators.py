"""Right estimators of every kind are rejected no more often than alpha; the short form of `tools/calibrate_estimators.py`."""

import pytest
from calibrate_estimators import ALPHA, RIGHT, false_alarms
from scipy.stats import binom

from fogproof.checks import fresh_seed


@pytest.mark.parametrize("name", RIGHT)
def test_right_estimators_are_rejected_no_more_often_than_said(name):
    seed, verdicts = fresh_seed() >> 2, 25
    count = false_alarms(name, verdicts, 2000, seed)
    assert binom.sf(count - 1, verdicts, ALPHA) > 1e-9, f"{count} of {verdicts}, seed {seed}"
