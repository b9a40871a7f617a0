"""Invariant: the clear sky and the low sun have the colours that Rayleigh scattering gives them: spectra within their stated
error, cross sections as colour-science has them by other measurements, sky bluer than the sun, sun redder with air mass."""

import subprocess
import sys

import colour
import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from media_truth import within

from fogproof.analytic import (
    air_cross_section,
    air_optical_depth,
    phase_pdf,
    plane_parallel_sky,
    rayleigh_scattering_coefficient,
    sky_colour,
    sun_colour,
)
from fogproof.analytic.sky.colour import WAVELENGTHS
from fogproof.errors import InvalidValueError
from fogproof.scene import Rayleigh


@settings(max_examples=100, deadline=None)
@given(st.floats(230e-9, 1690e-9))
def test_cross_section_is_within_its_error(wavelength):
    with mp.workdps(60):
        lam = mp.mpf(wavelength)
        s = (mp.mpf(10) ** -6 / lam) ** 2
        n = 1 + (5792105 / (mp.mpf("238.0185") - s) + 167917 / (mp.mpf("57.362") - s)) / 10**8
        shares = [mp.mpf(x) for x in ("78.084", "20.946", "0.934", "0.036")]
        kings = [
            mp.mpf("1.034") + mp.mpf("3.17e-4") * s,
            mp.mpf("1.096") + mp.mpf("1.385e-3") * s + mp.mpf("1.448e-4") * s**2,
            mp.mpf(1),
            mp.mpf("1.15"),
        ]
        F = sum(c * k for c, k in zip(shares, kings, strict=True)) / sum(shares)
        N = 101325 / (mp.mpf("1.380649e-23") * mp.mpf("288.15"))
        truth = 24 * mp.pi**3 * (n**2 - 1) ** 2 / (lam**4 * N**2 * (n**2 + 2) ** 2) * F
        within(air_cross_section(wavelength), truth)
        column = 101325 * mp.mpf("6.02214076e23") / (mp.mpf("28.9647e-3") * mp.mpf("9.80665"))
        within(air_optical_depth(wavelength), truth * column)


def test_cross_sections_agree_with_colour_science():
    """There: Peck & Reeder's refractive index and 300 ppm of CO2, gravity at the height of the mean molecule; in cm."""
    lam = np.linspace(360e-9, 780e-9, 50)
    there = colour.scattering_cross_section(lam * 100) * 1e-4
    assert air_cross_section(lam).value == pytest.approx(there, rel=3e-4)
    thickness = colour.phenomena.rayleigh.rayleigh_optical_depth(lam * 100)
    assert air_optical_depth(lam).value == pytest.approx(thickness, rel=4e-3)


def test_air_scatters_more_steeply_than_lambda_to_the_fourth():
    """Dispersion and the King factor add to the exponent; a sphere of fixed index has exactly -4."""
    lam = np.array([549e-9, 551e-9])
    slope = np.diff(np.log(air_optical_depth(lam).value)) / np.diff(np.log(lam))
    assert slope == pytest.approx(-4.087, abs=0.01)
    sphere = np.diff(np.log(rayleigh_scattering_coefficient(1e-9, 1.3, 1e25, lam).value)) / np.diff(np.log(lam))
    assert sphere == pytest.approx(-4, abs=1e-9)


cosines = st.one_of(st.floats(1e-3, 1), st.just(1.0))


@settings(max_examples=150, deadline=None)
@given(tau=st.floats(-12, 1).map(lambda e: 10.0**e), mu_sun=cosines, mu_view=cosines, azimuth=st.floats(-10, 10))
def test_sky_is_within_its_error(tau, mu_sun, mu_view, azimuth):
    with mp.workdps(60):
        t, m0, m = mp.mpf(tau), mp.mpf(mu_sun), mp.mpf(mu_view)
        mu = m0 * m + mp.sqrt((1 - m0**2) * (1 - m**2)) * mp.cos(mp.mpf(azimuth))
        f = 3 / (16 * mp.pi) * (1 + mu**2)
        integral = t / m * mp.exp(-t / m) if m == m0 else (mp.exp(-t / m0) - mp.exp(-t / m)) * m0 / (m0 - m)
        within(plane_parallel_sky(tau, mu_sun, mu_view, azimuth), f * integral)


def test_sky_is_the_integral_over_the_view():
    tau, mu_sun, mu_view = 0.4, 0.3, 0.7
    t = np.linspace(0, tau, 20_001)
    path = np.trapezoid(np.exp(-t / mu_sun - (tau - t) / mu_view) / mu_view, t)
    mu = mu_sun * mu_view + np.sqrt((1 - mu_sun**2) * (1 - mu_view**2)) * np.cos(2.0)
    expected = phase_pdf(Rayleigh(), mu).value * path
    assert plane_parallel_sky(tau, mu_sun, mu_view, 2.0).value == pytest.approx(expected, rel=1e-8)


def tristimulus(values):
    cmfs = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(colour.SpectralShape(360, 780, 1))
    sd = colour.SpectralDistribution(values, np.arange(360, 781))
    return colour.sd_to_XYZ(sd, cmfs, method="Integration", k=1)


def test_conversion_is_that_of_colour_science():
    sun = colour.SDS_ILLUMINANTS["D65"].copy().align(colour.SpectralShape(360, 780, 1)).values
    tau = air_optical_depth(WAVELENGTHS).value
    above = tristimulus(sun)
    assert sun_colour(0.0).value == pytest.approx(above / above[1], rel=1e-12)
    assert sun_colour(5.0).value == pytest.approx(tristimulus(sun * np.exp(-5 * tau)) / above[1], rel=1e-12)
    sky = plane_parallel_sky(tau, 0.5, 1.0, 0.0).value
    assert sky_colour(0.5, 1.0, 0.0).value == pytest.approx(tristimulus(sun * sky) / above[1], rel=1e-12)


def test_the_sun_reddens_with_air_mass():
    masses = np.linspace(0, 38, 77)
    XYZ = sun_colour(masses)
    assert (XYZ.error <= 1e-12 * XYZ.value).all()
    xy = colour.XYZ_to_xy(XYZ.value)
    assert (np.diff(xy[:, 0]) > 0).all()
    assert (np.diff(XYZ.value[:, 1]) < 0).all()
    assert (np.diff(XYZ.value[:, 2] / XYZ.value[:, 1]) < 0).all()
    assert xy[0] == pytest.approx([0.3127, 0.3290], abs=1e-4)
    assert xy[20] == pytest.approx([0.4275, 0.4237], abs=5e-4)  # 10 atmospheres
    assert xy[-1] == pytest.approx([0.583, 0.407], abs=5e-4)
    temperature = colour.xy_to_CCT(xy[[0, 20]], method="Hernandez 1999")
    assert temperature == pytest.approx([6504, 3272], rel=0.01)
    assert colour.XYZ_to_sRGB(XYZ.value[-1] / XYZ.value[-1, 1])[2] < 0  # redder than a display can show


def test_the_sky_is_bluer_than_the_sun_that_lights_it():
    mu_view, azimuth = np.meshgrid(np.linspace(0.1, 1, 10), np.linspace(0, np.pi, 7))
    for mu_sun in (1.0, 0.5, 0.2):
        sky = sky_colour(mu_sun, mu_view, azimuth)
        assert sky.value.shape == (7, 10, 3)
        assert (sky.error <= 1e-12 * sky.value).all()
        sun = colour.XYZ_to_xy(sun_colour(1 / mu_sun).value)
        assert (colour.XYZ_to_xy(sky.value) < sun).all()  # towards blue in x and in y
        assert (sky.value[..., 2] / sky.value[..., 1] > sun_colour(0.0).value[2]).all() or mu_sun < 0.5
    zenith = colour.XYZ_to_xy(sky_colour(0.5, 1.0, 0.0).value)
    assert zenith == pytest.approx([0.2390, 0.2521], abs=2e-4)
    assert colour.xy_to_CCT(zenith, method="Hernandez 1999") == pytest.approx(38600, rel=0.02)


def test_a_grey_scatterer_leaves_the_colour_alone():
    """The broken twin: without the wavelength in the optical depth there is nothing blue about the sky."""
    sun = colour.SDS_ILLUMINANTS["D65"].copy().align(colour.SpectralShape(360, 780, 1)).values
    grey = plane_parallel_sky(np.full(WAVELENGTHS.shape, 0.1), 0.5, 1.0, 0.0).value
    assert colour.XYZ_to_xy(tristimulus(sun * grey)) == pytest.approx([0.3127, 0.3290], abs=1e-4)


def test_what_is_out_of_range_is_refused():
    bad = [
        (lambda: air_cross_section(550), "wavelength must lie in .* not in nm"),
        (lambda: plane_parallel_sky(0.1, 0.0, 0.5, 0.0), r"mu_sun must lie in \(0, 1\]"),
        (lambda: plane_parallel_sky(0.1, 0.5, 1.5, 0.0), r"mu_view must lie in \(0, 1\]"),
        (lambda: plane_parallel_sky(-0.1, 0.5, 0.5, 0.0), "tau must be finite and >= 0"),
        (lambda: plane_parallel_sky(0.1, 0.5, 0.5, np.nan), "azimuth must be finite"),
        (lambda: sun_colour(-1.0), "air_mass must be finite and >= 0"),
        (lambda: sky_colour("x", 0.5, 0.0), "mu_sun must be a number"),
    ]
    for call, message in bad:
        with pytest.raises(InvalidValueError, match=message):
            call()


def test_colour_science_is_imported_where_it_is_used():
    code = "import sys, fogproof.analytic as a; a.air_optical_depth(5e-7); print('colour' in sys.modules)"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout == "False\n"
