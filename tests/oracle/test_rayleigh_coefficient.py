"""Invariant: the Rayleigh scattering coefficient is the lecture's formula within its stated error, for real and complex
indices; its agreement with Lorenz-Mie is tested with that."""

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from fogproof.analytic import rayleigh_scattering_coefficient
from fogproof.errors import InvalidValueError

EPS = 2.0**-52
positive = st.floats(-12, 3).map(lambda e: 10.0**e)
indices = st.one_of(
    st.floats(-15, 1).map(lambda e: 1 + 10.0**e),
    st.floats(0, 1),
    st.builds(complex, st.floats(0, 3), st.floats(0, 5)),
    st.builds(complex, st.floats(0, 1e-6), st.floats(2**0.5 - 1e-9, 2**0.5 + 1e-9)),
)


@settings(max_examples=300, deadline=None)
@given(d=positive, eta=indices, rho=st.floats(0, 1e30), lam=positive)
def test_value_is_within_its_error(d, eta, rho, lam):
    result = rayleigh_scattering_coefficient(d, eta, rho, lam)
    with mp.workdps(60):
        square = mp.mpmathify(eta) ** 2
        factor = abs((square - 1) / (square + 2)) ** 2
        truth = mp.mpf(rho) * 2 * mp.pi**5 * mp.mpf(d) ** 6 / (3 * mp.mpf(lam) ** 4) * factor
        assert abs(mp.mpf(float(result.value)) - truth) <= mp.mpf(float(result.error))
    if result.value > 1e-280:
        assert result.error <= 41 * EPS * result.value


def test_the_sky_is_blue():
    blue, red = rayleigh_scattering_coefficient(1e-9, 1.3, 1e25, [450e-9, 650e-9]).value
    assert blue / red == pytest.approx((650 / 450) ** 4, rel=1e-14)


def test_arguments_broadcast_and_are_checked():
    assert rayleigh_scattering_coefficient([[1e-9], [2e-9]], [1.3, 1.3 + 0.1j, 1.0], 1e25, 5e-7).value.shape == (2, 3)
    assert rayleigh_scattering_coefficient(1e-9, 1.0, 1e25, 5e-7).value == 0
    bad = [
        ((-1e-9, 1.3, 1e25, 5e-7), "diameter must be finite and >= 0"),
        ((1e-9, "glass", 1e25, 5e-7), "refractive_index must be a number"),
        ((1e-9, np.nan, 1e25, 5e-7), "refractive_index must be finite"),
        ((1e-9, 1.3, np.inf, 5e-7), "number_density must be finite"),
        ((1e-9, 1.3, 1e25, 0), "wavelength must be finite and > 0"),
    ]
    for arguments, message in bad:
        with pytest.raises(InvalidValueError, match=message):
            rayleigh_scattering_coefficient(*arguments)
