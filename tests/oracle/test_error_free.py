"""Invariant: value + low is the exact sum or product, and no finite input overflows on the way."""

from fractions import Fraction

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from fogproof.analytic.arithmetic.error_free import TINY, two_prod, two_sum

finite = st.floats(allow_nan=False, allow_infinity=False)
strict = {"over": "raise", "invalid": "raise", "divide": "raise"}


@given(finite, finite)
def test_two_sum_is_exact(a, b):
    value, low = two_sum(a, b)
    if np.isfinite(value):
        assert Fraction(float(value)) + Fraction(float(low)) == Fraction(a) + Fraction(b)
    else:
        assert low == 0


@given(finite, finite)
def test_two_prod_is_exact_or_off_by_an_underflow(a, b):
    with np.errstate(**strict):
        value, low = two_prod(a, b)
    product = Fraction(a) * Fraction(b)
    if np.isfinite(value):
        off = abs(Fraction(float(value)) + Fraction(float(low)) - product)
        assert off <= (0 if abs(product) > Fraction(1e-290) else 2 * Fraction(TINY))
    else:
        assert low == 0


def test_plain_products_would_lose_what_low_keeps():
    a = 1 + 2.0**-30
    value, low = two_prod(a, a)
    assert value == a * a
    assert low == 2.0**-60
