"""Invariant: what a slab of any phase function sends into any direction is right within the stated error."""

import numpy as np
import pytest

from fogproof.analytic import phase_pdf, slab_brdf, slab_btdf, slab_reflectance, slab_transmittance
from fogproof.errors import InvalidValueError
from fogproof.scene import HenyeyGreenstein, Rayleigh

ALMOST_ISOTROPIC = HenyeyGreenstein(1e-18)


def test_x_and_y_functions_agree_with_doubling():
    mu0, mu = np.array([0.05, 0.5, 1.0])[:, None], np.array([0.3, 0.5, 1.0])
    for c, tau in ((0.8, 2.0), (1.0, 0.01), (0.3, 30.0)):
        one, other = slab_brdf(c, tau, mu0, mu), slab_brdf(c, tau, mu0, mu, ALMOST_ISOTROPIC, 1.0)
        assert np.all(np.abs(one.value - other.value) <= one.error + other.error)
        assert np.all(other.error <= 1e-11 * other.value)


@pytest.mark.parametrize("g", [0.3, 0.6])
def test_another_solver_agrees_at_its_nodes(g):
    """PythonicDISORT between nodes is good for six digits only; at a node it is what its streams give."""
    disort = pytest.importorskip("PythonicDISORT.pydisort").pydisort
    streams, tau, c, mu0 = 64, 1.0, 0.9, 0.45
    nodes, *_, radiance = disort(
        tau, c, streams, (g ** np.arange(streams + 1.0))[None], mu0, 1 / mu0, 0.0, NLeg=streams
    )
    mu = float(nodes[np.argmin(np.abs(nodes - 0.7))])
    i, j = int(np.argmin(np.abs(nodes - mu))), int(np.argmin(np.abs(nodes + mu)))
    for azimuth in (0.0, 1.0, 3.0):
        for function, at, depth in ((slab_brdf, i, 0.0), (slab_btdf, j, tau)):
            reference = function(c, tau, mu0, mu, HenyeyGreenstein(g), azimuth)
            assert reference.value == pytest.approx(float(radiance(depth, azimuth)[at]), rel=2e-7)
            assert reference.error <= 1e-10 * reference.value


@pytest.mark.parametrize("phase", [Rayleigh(), HenyeyGreenstein(0.3)], ids=str)
def test_all_directions_together_are_the_share(phase):
    """The integral over the hemisphere, at Gauss-Legendre nodes in the cosine and equidistant ones in azimuth."""
    c, tau, mu0 = 0.9, 0.7, 0.6
    y, w = np.polynomial.legendre.leggauss(16)
    y, w = (1 + y) / 2, w / 2
    mu, weight = y * y, 2 * y * w
    azimuth = 2 * np.pi * np.arange(12) / 12
    for function, whole, straight in (
        (slab_brdf, slab_reflectance, 0.0),
        (slab_btdf, slab_transmittance, np.exp(-tau / mu0)),
    ):
        kernel = function(c, tau, mu0, mu[:, None], phase, azimuth).value.mean(axis=1)
        assert 2 * np.pi * np.sum(weight * mu * kernel) == pytest.approx(
            whole(c, tau, mu0, phase).value - straight, rel=1e-6
        )


def test_thin_slabs_scatter_once():
    phase = HenyeyGreenstein(0.6)
    tau, mu0, mu, azimuth = 1e-9, 0.5, 0.8, 2.0
    cosine = mu * mu0 + np.sqrt((1 - mu**2) * (1 - mu0**2)) * np.cos(azimuth)
    reference = slab_btdf(0.7, tau, mu0, mu, phase, azimuth)
    assert reference.value == pytest.approx(0.7 * tau / (mu * mu0) * phase_pdf(phase, cosine).value, rel=1e-5)


def test_reciprocity():
    for function in (slab_brdf, slab_btdf):
        one, other = (function(0.95, 1.5, a, b, HenyeyGreenstein(0.7), 0.4) for a, b in ((0.2, 0.9), (0.9, 0.2)))
        assert abs(one.value - other.value) <= one.error + other.error


def test_azimuth_must_be_given():
    with pytest.raises(InvalidValueError) as raised:
        slab_brdf(0.5, 1.0, 0.5, 0.5, HenyeyGreenstein(0.3))
    assert raised.value.argument == "azimuth"
    assert slab_btdf(0.0, 1.0, 0.5, [0.5, 1.0]).value.tolist() == [0, 0]
    assert slab_btdf(np.empty(0), 1.0, 0.5, 0.5).value.shape == (0,)
