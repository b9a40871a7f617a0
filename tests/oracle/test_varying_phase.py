"""Invariant: a phase function that varies in space is a normalised blend at every place."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from fogproof.analytic import phase_pdf, phase_pdf_at
from fogproof.analytic.phase.varying import share_at
from fogproof.errors import InvalidValueError
from fogproof.scene import HenyeyGreenstein, Isotropic, Ramp, Rayleigh, VaryingPhase

FIRST, SECOND = HenyeyGreenstein(0.8), Rayleigh()
coordinates = st.tuples(*[st.floats(-5, 5).filter(lambda x: x == 0 or abs(x) > 1e-90)] * 3)


@given(coordinates, coordinates.filter(lambda p: np.linalg.norm(p) > 0.1), coordinates)
def test_ramp_is_the_exact_projection(start, way, x):
    end = tuple(np.add(start, way))
    if start == end:
        return
    found = share_at(VaryingPhase(FIRST, SECOND, Ramp(start, end)), x)
    along = [Fraction(b) - Fraction(a) for a, b in zip(start, map(float, end), strict=True)]
    above = sum((Fraction(c) - Fraction(a)) * w for a, c, w in zip(start, x, along, strict=True))
    share = min(max(above / sum(w * w for w in along), Fraction(0)), Fraction(1))
    assert abs(Fraction(float(found)) - share) <= Fraction(2) ** -52 * share + Fraction(2) ** -90


@pytest.mark.parametrize("share", [Ramp((0, 0, -1), (0, 0, 2)), lambda x: np.abs(np.sin(x[..., 2]))])
def test_blend_is_normalised_and_reaches_both_ends(share):
    phase = VaryingPhase(FIRST, SECOND, share)
    nodes, weights = np.polynomial.legendre.leggauss(120)
    x = np.array([[0.0, 0.0, z] for z in (-3.0, 0.0, 0.7, 5.0)])
    found = phase_pdf_at(phase, x[:, None], nodes)
    assert found.value.shape == found.error.shape == (4, 120)
    assert np.allclose(2 * np.pi * found.value @ weights, 1, rtol=1e-12, atol=0)
    q = share_at(phase, x)[:, None]
    blend = (1 - q) * phase_pdf(FIRST, nodes).value + q * phase_pdf(SECOND, nodes).value
    assert (np.abs(found.value - blend) <= found.error).all()
    if isinstance(share, Ramp):
        assert np.array_equal(found.value[0], phase_pdf(FIRST, nodes).value)
        assert np.array_equal(found.value[3], phase_pdf(SECOND, nodes).value)


def test_a_phase_function_that_does_not_vary():
    found = phase_pdf_at(Isotropic(), np.zeros((3, 3)), 0.2)
    assert found.value.tolist() == [phase_pdf(Isotropic(), 0.2).value] * 3


@pytest.mark.parametrize("bad", [lambda x: 2 + x[..., 0], lambda x: x, lambda x: np.nan + x[..., 0]])
def test_a_bad_share_is_named(bad):
    with pytest.raises(InvalidValueError) as raised:
        phase_pdf_at(VaryingPhase(FIRST, SECOND, bad), (0, 0, 0), 0.5)
    assert raised.value.argument == "share"


def test_nothing_but_phase_functions_blends():
    with pytest.raises(InvalidValueError, match="second"):
        VaryingPhase(FIRST, "hazy", Ramp((0, 0, 0), (0, 0, 1)))
    with pytest.raises(InvalidValueError, match="first"):
        VaryingPhase(VaryingPhase(FIRST, SECOND, Ramp((0, 0, 0), (0, 0, 1))), SECOND, Ramp((0, 0, 0), (0, 0, 1)))
    with pytest.raises(InvalidValueError, match="share"):
        VaryingPhase(FIRST, SECOND, 0.5)
