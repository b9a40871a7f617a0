"""Path lengths and counts of scatterings against theorems, 50 digits and closed forms."""

import mpmath as mp
import numpy as np
import pytest

from fogproof import analytic
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.scene import HenyeyGreenstein, Medium, PointLight, Ray, Scene

mp.mp.dps = 50
RAY = Ray((0, 0, 0), (0, 0, 1), 2.0)


@pytest.mark.parametrize("tau", [0.01, 1.0, 5.0])
def test_the_mean_path_through_a_white_slab_is_its_mean_chord(tau):
    """4 V/S = 2 tau under a uniform sky, over all that leaves, whatever scatters (Blanco & Fournier 2003)."""
    shares = [q(1.0, tau) for q in (analytic.slab_diffuse_reflectance, analytic.slab_diffuse_transmittance)]
    means = [
        analytic.path_length_mean(q, albedo=1.0, tau=tau)
        for q in ("slab_diffuse_reflectance", "slab_diffuse_transmittance")
    ]
    mean = sum(share.value * m.value for share, m in zip(shares, means, strict=True))
    slack = sum(m.error + 1e-11 for m in means)
    assert abs(mean - 2 * tau) <= slack <= 1e-7 * (1 + tau)


@pytest.mark.parametrize("radius", [0.01, 1.0, 4.0])
def test_the_mean_path_through_a_white_ball_is_its_mean_chord(radius):
    mean = analytic.path_length_mean("ball_albedo", albedo=1.0, radius=radius)
    assert abs(mean.value - 4 * radius / 3) <= mean.error + 1e-14 <= 1e-7 * radius


def _h(c, mu):
    """Chandrasekhar's H function of isotropic scattering in 50 digits (his section 39)."""

    def integrand(theta):
        return mp.log(1 - c * theta * mp.cot(theta)) / (mp.cos(theta) ** 2 + mu**2 * mp.sin(theta) ** 2)

    return mp.exp(-mu / mp.pi * mp.quad(integrand, mp.linspace(0, mp.pi / 2, 5)))


def _plane_albedo(s):
    c = mp.mpf(0.75) / (1 + s)
    return 1 - mp.sqrt(1 - c) * _h(c, mp.mpf(0.5))


def test_half_space_against_50_digits():
    arguments = {"albedo": 0.75, "mu0": 0.5}
    s = [-0.125, 0.0, 0.5, 40.0]
    found = analytic.path_length_transform("half_space_reflectance", s, **arguments)
    truth = [float(_plane_albedo(mp.mpf(x))) for x in s]
    assert np.all(np.abs(found.value - truth) <= found.error)
    assert np.all(found.error <= 1e-13)
    with mp.workdps(25):
        slope, bend = (mp.diff(_plane_albedo, 0, n) for n in (1, 2))
    mean, variance = (
        f("half_space_reflectance", **arguments) for f in (analytic.path_length_mean, analytic.path_length_variance)
    )
    true_mean = -slope / truth[1]
    true_variance = bend / truth[1] - true_mean**2
    assert abs(mean.value - float(true_mean)) <= mean.error <= 1e-9
    assert abs(variance.value - float(true_variance)) <= variance.error <= 1e-6


def test_light_that_goes_straight_has_one_length():
    arguments = {"medium": Medium(0.3, 0.4), "ray": RAY}
    through = analytic.path_length_transform("transmittance", [0.0, 0.5, 1e-9], **arguments)
    np.testing.assert_allclose(through.value, np.exp(-2 * (0.7 + np.array([0.0, 0.5, 1e-9]))), rtol=1e-14)
    mean = analytic.path_length_mean("transmittance", **arguments)
    assert abs(mean.value - 2) <= mean.error <= 1e-10
    assert abs(analytic.path_length_variance("transmittance", **arguments).value) <= 1e-8


def test_emission_keeps_what_it_emits():
    """Light that starts at t with density exp(-sigma_t t): the mean of t has a closed form."""
    medium = Medium(0.3, 0.4, emission=2.0)
    scene = Scene(medium, RAY, "none")
    tau = 1.4
    truth = (1 - (1 + tau) * np.exp(-tau)) / (0.7 * (1 - np.exp(-tau)))
    for quantity, arguments in (("emitted_radiance", {"medium": medium, "ray": RAY}), ("radiance", {"scene": scene})):
        mean = analytic.path_length_mean(quantity, **arguments)
        assert abs(mean.value - truth) <= mean.error <= 1e-9


def test_single_scattering_goes_from_the_lamp_to_the_camera():
    lamp = PointLight((1.0, 1.0, 0.5), 3.0)
    mean = analytic.path_length_mean("single_scattering", medium=Medium(1e-6, 2e-6), ray=RAY, light=lamp)
    t = np.linspace(0, 2, 20001)
    r2 = 2 + (t - 0.5) ** 2
    truth = np.trapezoid((t + np.sqrt(r2)) / r2, t) / np.trapezoid(1 / r2, t)
    assert abs(mean.value - truth) <= 1e-4


def test_a_black_slab_glows_from_within():
    x = 1.0 / 0.5
    mean = analytic.path_length_mean("slab_emissivity", albedo=0.0, tau=1.0, mu0=0.5)
    assert abs(mean.value - (1 - (1 + x) * np.exp(-x)) / (1 - np.exp(-x))) <= mean.error <= 1e-9


def test_counts_of_scatterings():
    law = analytic.scattering_count_law("slab_reflectance", albedo=0.8, count=80, tau=1.0, mu0=0.5)
    assert np.sum(law.value) == pytest.approx(1, abs=1e-10)
    mean = analytic.scattering_count_mean("slab_reflectance", albedo=0.8, tau=1.0, mu0=0.5)
    assert abs(mean.value - law.value @ np.arange(81)) <= mean.error + law.error @ np.arange(81) + 1e-9
    assert law.value[0] == 0
    deep = analytic.scattering_count_mean("half_space_spherical_albedo", albedo=0.99)
    assert deep.value > 5


def test_lengths_of_anisotropic_slabs_agree_with_finite_absorption():
    arguments = {"albedo": 0.9, "tau": 2.0, "mu0": 0.5, "phase": HenyeyGreenstein(0.5)}
    mean = analytic.path_length_mean("slab_transmittance", **arguments)
    near = analytic.path_length_transform("slab_transmittance", [-1e-3, 1e-3], **arguments)
    whole = analytic.slab_transmittance(**arguments)
    rough = (near.value[0] - near.value[1]) / 2e-3 / whole.value
    assert abs(mean.value - rough) <= 1e-5 * rough
    assert mean.error <= 1e-7


def test_arguments_that_the_orders_lack_may_be_what_they_are_anyway():
    for name, extra in (("half_space_reflectance", {}), ("slab_reflectance", {"tau": 1.0})):
        arguments = {"albedo": 0.8, "count": 3, "mu0": 0.5, **extra}
        usual = {"phase": None} if name == "half_space_reflectance" else {"refractive_index": np.asarray(1.0)}
        plain = analytic.scattering_count_law(name, **arguments)
        assert analytic.scattering_count_law(name, **arguments, **usual).value.tolist() == plain.value.tolist()
    with pytest.raises(UnsupportedError, match="orders of half_space_reflectance are known without phase alone"):
        analytic.scattering_count_law("half_space_reflectance", 0.8, 3, mu0=0.5, phase=HenyeyGreenstein(0.5))


def test_no_rates_are_no_values_and_nothing_has_no_derivative():
    for mu0, shape in ((0.5, (0,)), ([0.2, 0.5], (2, 0))):
        none = analytic.path_length_transform("half_space_reflectance", [], albedo=0.9, mu0=mu0)
        assert none.value.shape == none.error.shape == shape
    for arguments in ({"mu0": []}, {"mu0": [0.5], "albedo": np.zeros((0, 1))}):
        with pytest.raises(InvalidValueError, match=r"mu0 must stand with one value at least, got \[\]"):
            analytic.gradient("half_space_reflectance", "mu0", **{"albedo": 0.9, **arguments})


def test_what_has_no_mean_is_refused():
    with pytest.raises(UnsupportedError, match="infinite, or nothing bounds it"):
        analytic.path_length_mean("half_space_reflectance", albedo=1.0, mu0=0.5)
    with pytest.raises(UnsupportedError, match="phase_pdf has neither"):
        analytic.path_length_transform("phase_pdf", 0.5, phase=HenyeyGreenstein(0.5), mu=0.5)
    with pytest.raises(UnsupportedError, match="no light"):
        analytic.path_length_mean(
            "single_scattering", medium=Medium(0.5, 0.0), ray=RAY, light=PointLight((1, 1, 0), 1.0)
        )
    with pytest.raises(InvalidValueError, match="minus the absorption"):
        analytic.path_length_transform("half_space_reflectance", -0.5, albedo=0.75, mu0=0.5)
    with pytest.raises(UnsupportedError, match="orders of slab_emissivity are not known"):
        analytic.scattering_count_law("slab_emissivity", 0.5, 3, tau=1.0, mu0=0.5)
    with pytest.raises(InvalidValueError, match="albedo must be one number"):
        analytic.scattering_count_mean("half_space_reflectance", 0.0, mu0=0.5)
