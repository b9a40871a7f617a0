"""The oracle's own error is measured against proven values, and a promise that is broken is seen."""

import dataclasses
import math

import numpy as np
import pytest

from fogproof import oracle_error
from fogproof.analytic.proven.golden import Golden
from fogproof.contracts import Reference
from fogproof.oracle_error import compare, oracle_errors
from fogproof.quantities import quantities


def test_every_quantity_keeps_its_promise_on_the_golden_tables():
    rows = oracle_errors()
    assert {row.quantity for row in rows} >= {"transmittance", "ambient_fog", "airlight_integral"}
    for row in rows:
        assert row.broken == 0
        assert 0 <= row.share <= 1
        assert row.relative < 1e-14


def test_a_quantity_that_fails_breaks_its_promise_and_costs_no_other(monkeypatch):
    def fails(**_):
        raise ZeroDivisionError

    known = dict(quantities())
    known["transmittance"] = dataclasses.replace(known["transmittance"], function=fails)
    monkeypatch.setattr(oracle_error, "quantities", lambda: known)
    rows = {row.quantity: row for row in oracle_errors()}
    assert rows["transmittance"].broken == rows["transmittance"].values > 0
    assert rows["ambient_fog"].broken == 0


@pytest.mark.parametrize(
    ("proven", "radius", "value", "error", "relative", "share"),
    [
        ("1", "0", 1.5, 1.0, 0.5, 0.5),
        ("1", "0", 1.5, 0.25, 0.5, 2.0),
        ("1", "0", 1.0, 0.0, 0.0, 0.0),
        ("1", "0", 1.5, 0.0, 0.5, math.inf),
        ("0", "0", 0.0, 0.0, 0.0, 0.0),
        ("-2e0", "1e-1", -2.0, 1.0, 0.1 / 2.1, 0.0),
        ("inf", "0", math.inf, 0.0, 0.0, 0.0),
        ("inf", "0", 1e300, 1.0, math.inf, math.inf),
        ("1", "0", math.nan, math.nan, math.inf, math.inf),
        ("1", "0", 7.0, math.inf, 6.0, 0.0),
    ],
)
def test_distance_from_the_truth(proven, radius, value, error, relative, share):
    found = compare(Golden({}, proven, radius), Reference(np.array(value), np.array(error), "", ""))
    assert found == pytest.approx((relative, share), rel=1e-12)
