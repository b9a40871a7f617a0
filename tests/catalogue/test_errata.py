"""Invariant: each misprint of the lecture that this suite implements is told from the right formula by the oracle alone, with
no random number. Every test writes the printed form beside the right one and names what separates them; where a check
cannot tell them apart (a uniform field, one special parameter), the test says that too.
"""

import numpy as np
import pytest

from fogproof.analytic import (
    airlight_integral,
    free_path,
    phase_cdf,
    phase_mean_cosine,
    phase_pdf,
    phase_quantile,
    rayleigh_scattering_coefficient,
    single_scattering,
    transmittance,
)
from fogproof.errors import InvalidValueError
from fogproof.scene import (
    ExponentialMedium,
    Hazy,
    HenyeyGreenstein,
    LinearMedium,
    Medium,
    Murky,
    PointLight,
    Ray,
    Schlick,
)

Z = (0.0, 0.0, 1.0)
NODES, WEIGHTS = np.polynomial.legendre.leggauss(200)


def over_sphere(f):
    """2 pi int_-1^1 f(mu) dmu; good to 1e-12 for what is integrated here."""
    return 2 * np.pi * float(WEIGHTS @ f(NODES))


def ray(length, origin=(0.0, 0.0, 0.0)):
    return Ray(origin, Z, length)


# E1: Henyey-Greenstein with + 2 g cos(theta), where cos(theta) = -w.w' is the forward cosine and g its mean.


def printed_henyey_greenstein(g, cosine):
    return (1 - g**2) / (4 * np.pi * (1 + g**2 + 2 * g * cosine) ** 1.5)


@pytest.mark.parametrize("g", [-0.5, 0.3, 0.7])
def test_e1_sign_of_henyey_greenstein(g):
    mean = over_sphere(lambda c: c * printed_henyey_greenstein(g, c))
    assert mean == pytest.approx(-g, abs=1e-12)  # its own definition of g asks for + g
    right = phase_mean_cosine(HenyeyGreenstein(g))
    assert right.value == g
    assert abs(mean - right.value) > 0.5
    # The lecture's Schlick function and its sampler for the same g have their peak on the other side.
    assert (printed_henyey_greenstein(g, 1.0) > printed_henyey_greenstein(g, -1.0)) == (g < 0)
    assert (phase_pdf(Schlick.from_g(g), 1.0).value > phase_pdf(Schlick.from_g(g), -1.0).value) == (g > 0)
    # It integrates to 1 whatever the sign is: normalisation cannot tell.
    assert over_sphere(lambda c: printed_henyey_greenstein(g, c)) == pytest.approx(1, abs=1e-12)


# E2: hazy (5 + u^8)/(4 pi) and murky (17 + u^32)/(4 pi), u = (1 + mu)/2.


@pytest.mark.parametrize(
    ("phase", "constant", "power", "integral"), [(Hazy(), 5, 8, 46 / 9), (Murky(), 17, 32, 562 / 33)], ids=repr
)
def test_e2_hazy_and_murky_are_normalised(phase, constant, power, integral):
    def printed(mu):
        return (constant + ((1 + mu) / 2) ** power) / (4 * np.pi)

    assert over_sphere(printed) == pytest.approx(integral, rel=1e-12)
    assert over_sphere(lambda mu: phase_pdf(phase, mu).value) == pytest.approx(1, abs=1e-12)
    assert phase_cdf(phase, 1.0).value == pytest.approx(1, abs=1e-15)
    # What the constants are: the forward value of the right function, in units of isotropic scattering.
    assert 4 * np.pi * phase_pdf(phase, 1.0).value == pytest.approx(constant, rel=1e-14)


# E3: k = 1.55 g - 0.55 g^3 for every g.


def test_e3_schlick_has_no_k_for_strong_scattering():
    g = 0.95
    k = 1.55 * g - 0.55 * g**3
    assert k > 1
    mu = np.linspace(-1, 0.99, 101)
    assert ((1 - k**2) / (4 * np.pi * (1 - k * mu) ** 2) < 0).all()  # a "density" below 0
    for bad in (0.9382, 0.95, 0.99, -0.95):
        with pytest.raises(InvalidValueError, match=r"g must keep \|1.55 g - 0.55 g\^3\| below 1"):
            Schlick.from_g(bad)
    assert Schlick.from_g(0.9381).k < 1


def test_e3_schlick_does_not_have_the_mean_g():
    mean = phase_mean_cosine(Schlick.from_g(0.8))
    assert mean.value == pytest.approx(0.8726, abs=5e-5)
    assert abs(mean.value - 0.8) > 1e12 * mean.error


# E4: airlight without sigma_s, and exp(-sigma d^2) where d^2 belongs.


def printed_airlight(sigma_t, h, a, b, intensity):
    """(Phi/4 pi)(1/4 pi) int e^{-sigma |x, x_t|} e^{-sigma d} / e^{-sigma d^2} dt, intensity = Phi/4 pi."""
    t = (b + a) / 2 + (b - a) / 2 * NODES
    d = np.hypot(t, h)
    f = np.exp(-sigma_t * (t - a)) * np.exp(-sigma_t * d) / np.exp(-sigma_t * d**2)
    return intensity / (4 * np.pi) * (b - a) / 2 * float(WEIGHTS @ f)


def test_e4_airlight_needs_scattering_and_falls_off_with_the_square():
    h, a, b, intensity = 0.7, -1.0, 2.0, 5.0
    light = PointLight((h, 0.0, -a), intensity)

    def right(sigma_a, sigma_s):
        return single_scattering(Medium(sigma_a, sigma_s), ray(b - a), light)

    # Absorption alone scatters no light.
    assert right(0.4, 0.0).value == 0
    assert printed_airlight(0.4, h, a, b, intensity) > 0.1
    # Twice the light's distance in a thin medium: half the airlight, int dt/(t^2 + h^2) = Theta/h; printed: no change.
    thin = 1e-6
    near, far = (airlight_integral(thin, s * h, s * a, s * b).value for s in (1, 2))
    assert near / far == pytest.approx(2, rel=1e-4)
    printed = [printed_airlight(thin, s * h, s * a, s * b, intensity) for s in (1, 2)]
    assert printed[0] / printed[1] == pytest.approx(0.5, rel=1e-4)  # it grows, with the length of the ray
    # Even with the factor sigma_s put back the value is not in the oracle's interval.
    reference = right(0.1, 0.3)
    assert abs(0.3 * printed_airlight(0.4, h, a, b, intensity) - reference.value) > 1e9 * reference.error
    # The right formula, by the same rule, is.
    t = (b + a) / 2 + (b - a) / 2 * NODES
    d = np.hypot(t, h)
    literal = 0.3 * intensity / (4 * np.pi) * (b - a) / 2 * float(WEIGHTS @ (np.exp(-0.4 * (t - a + d)) / d**2))
    assert literal == pytest.approx(float(reference.value), rel=1e-12)


# E5: in-scattering int f_p(w, w') L(x, w) dw' dt with L in the wrong direction and a stray dt; L_e(x_e, -w).


def in_scattered(phase, mu, radiance, direction="w'"):
    """int f_p(w, w') L(.) dw' for radiance L(cos of the angle to z), w at cosine mu to z; 200 x 64 directions w'."""
    azimuth = np.arange(64) * (2 * np.pi / 64)
    c = NODES[:, None]
    cos_between = mu * c + np.sqrt((1 - mu**2) * (1 - c**2)) * np.cos(azimuth)
    L = radiance(c) if direction == "w'" else radiance(np.full_like(c, mu))
    return float(WEIGHTS @ (phase_pdf(phase, cos_between).value * L).mean(axis=1)) * 2 * np.pi


@pytest.mark.parametrize("mu", [-0.8, 0.1, 0.9])
def test_e5_scattering_turns_light_from_other_directions(mu):
    """In a field 1 + cos(theta) scattering leaves 1 + g cos(theta); the printed integrand leaves the field as it was."""
    phase = HenyeyGreenstein(0.6)
    right = in_scattered(phase, mu, lambda c: 1 + c)
    printed = in_scattered(phase, mu, lambda c: 1 + c, direction="w")
    g = float(phase_mean_cosine(phase).value)
    assert right == pytest.approx(1 + g * mu, abs=1e-12)
    assert printed == pytest.approx(1 + mu, abs=1e-12)
    assert abs(printed - (1 + g * mu)) > 0.03
    # A furnace, the same radiance everywhere, cannot tell them apart.
    assert in_scattered(phase, mu, np.ones_like, "w") == pytest.approx(in_scattered(phase, mu, np.ones_like), abs=1e-12)


def test_e5_a_stray_dt_ties_the_radiance_to_the_step():
    """Marched along the ray, the in-scattered radiance converges to the oracle's; with a dt of its own it tends to 0."""
    h, a, b = 0.7, -1.0, 2.0
    truth = single_scattering(Medium(0.1, 0.3), ray(b - a), PointLight((h, 0.0, -a), 1.0)).value
    right, printed = [], []
    for n in (500, 1000):
        dt = (b - a) / n
        t = a + (np.arange(n) + 0.5) * dt
        d = np.hypot(t, h)
        scattered = 1 / (4 * np.pi) * np.exp(-0.4 * d) / d**2
        right.append(np.sum(np.exp(-0.4 * (t - a)) * 0.3 * scattered * dt))
        printed.append(np.sum(np.exp(-0.4 * (t - a)) * 0.3 * (scattered * dt) * dt))
    assert right == pytest.approx([float(truth)] * 2, rel=1e-5)
    assert printed[0] / printed[1] == pytest.approx(2, rel=1e-5)
    assert max(printed) < 0.01 * truth


def test_e5_emission_is_seen_along_the_way_to_the_light():
    """A source that shines down only, beside the ray: -w' is the way the light takes, -w the camera's."""
    h, a, b = 0.5, -1.0, 2.0
    t = (b + a) / 2 + (b - a) / 2 * NODES
    d = np.hypot(t, h)

    def radiant(cosine):  # of the emitted direction to -x, where the ray is
        return np.maximum(cosine, 0.0) ** 2

    def airlight(emitted):
        return 0.3 / (4 * np.pi) * (b - a) / 2 * float(WEIGHTS @ (np.exp(-0.4 * (t - a + d)) / d**2 * emitted))

    right = airlight(radiant(h / d))  # -w' points from the light to x_t
    printed = airlight(radiant(np.zeros_like(t)))  # -w points back along the ray, at right angles to -x
    assert printed == 0
    assert 0 < right < single_scattering(Medium(0.1, 0.3), ray(b - a), PointLight((h, 0.0, -a), 1.0)).value


# E6: the free-path distribution int_0^t e^{-sigma s} ds without sigma.


def test_e6_a_distribution_ends_at_one():
    t = np.linspace(0, 40, 9)
    for sigma in (0.25, 0.5, 2.0):
        printed = -np.expm1(-sigma * t) / sigma
        right = 1 - transmittance(Medium(0.0, sigma), ray(np.maximum(t, 1e-300))).value
        assert printed[-1] == pytest.approx(1 / sigma, rel=1e-4)
        assert right[-1] == pytest.approx(1, abs=1e-4)
        assert printed == pytest.approx(right / sigma, rel=1e-12)
    # At sigma = 1 alone they are the same: a test with that value sees nothing.
    assert -np.expm1(-t) == pytest.approx(1 - transmittance(Medium(0.0, 1.0), ray(np.maximum(t, 1e-300))).value)


# E7: the transmittance of a heterogeneous medium as exp(-sigma |x - y|).


def test_e7_transmittance_is_multiplicative():
    """T(x, x'') = T(x, x') T(x', x'') holds for exp(-tau), not with the extinction that the ray starts in."""
    medium = LinearMedium(0.2, (0, 0, 0.5))

    def printed(start, length):
        return np.exp(-(0.2 + 0.5 * start) * length)

    whole, first, second = (transmittance(medium, ray(s, (0, 0, z))) for z, s in ((0.0, 3.0), (0.0, 1.0), (1.0, 2.0)))
    assert first.value * second.value == pytest.approx(float(whole.value), rel=1e-14)
    assert abs(printed(0.0, 1.0) * printed(1.0, 2.0) / printed(0.0, 3.0) - 1) > 0.5
    assert abs(printed(0.0, 3.0) - whole.value) > 1e12 * whole.error
    assert whole.value == pytest.approx(np.exp(-(0.2 * 3 + 0.5 * 9 / 2)), rel=1e-14)


# E8: the ray-marching sum from k = 0 to N with the step dt, and the transmittance of the right end of each step.


def test_e8_a_sum_over_n_steps_has_n_terms():
    """In vacuum with a source of 1 per metre the sum is the length of the ray."""
    for n in (4, 64):
        dt = 2.0 / n
        printed = sum(dt for _ in range(n + 1))
        right = sum(dt for _ in range(n))
        assert right == pytest.approx(2.0, rel=1e-14)
        assert printed / right == pytest.approx(1 + 1 / n, rel=1e-12)


def test_e8_right_ends_are_first_order_and_midpoints_second():
    medium, s = ExponentialMedium(2.0, (0, 0, -1.5)), 2.0
    truth = float(transmittance(medium, ray(s)).value)

    def marched(n, shift):
        k = np.arange(n)
        return float(np.prod(np.exp(-2.0 * np.exp(-1.5 * (k + shift) * s / n) * s / n)))

    steps = (64, 128, 256, 512)
    for shift, order in ((1.0, 1), (0.5, 2)):
        errors = np.array([abs(marched(n, shift) - truth) for n in steps])
        slope = np.log2(errors[:-1] / errors[1:])
        assert slope == pytest.approx(order, abs=0.03)
    assert abs(marched(256, 1.0) - truth) > 100 * abs(marched(256, 0.5) - truth)


# E9: the one-sample estimator with L(x_t, w) after a direction w_i has been sampled.


@pytest.mark.parametrize("mu", [-0.8, 0.9])
def test_e9_the_sampled_direction_is_the_one_to_look_along(mu):
    """Expectation over xi of f_p/p L with p = f_p, the forward cosine by the oracle's quantile at 500 midpoints."""
    phase, n = HenyeyGreenstein(0.6), 500
    xi = (np.arange(n) + 0.5) / n
    cosine = phase_quantile(phase, xi).value[:, None]
    turn = np.sqrt((1 - mu**2) * (1 - cosine**2)) * np.cos(np.arange(64) * (2 * np.pi / 64))
    estimates = 1 + (mu * cosine + turn)  # L(x_t, w_i) in the field 1 + cos(theta)
    printed = np.full(n, 1 + mu)  # L(x_t, w)
    expected = 1 + float(phase_mean_cosine(phase).value) * mu
    assert estimates.mean() == pytest.approx(expected, abs=1e-4)
    assert abs(printed.mean() - expected) > 0.3
    assert np.ptp(printed) == 0  # an estimator that does not look where it sampled has no variance either
    assert np.ptp(estimates) > 1


# E10: g in the closed interval [-1, 1].


@pytest.mark.parametrize("g", [-1.0, 1.0])
def test_e10_the_ends_are_no_densities(g):
    mu = np.linspace(-0.999, 0.999, 101)
    assert ((1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * mu) ** 1.5) == 0).all()  # integrates to 0
    with pytest.raises(InvalidValueError, match=r"g must lie in the open interval \(-1, 1\)"):
        HenyeyGreenstein(g)
    # The limit is all light within any small angle of straight on, or back.
    almost = HenyeyGreenstein(np.nextafter(g, 0))
    inside = 1 - phase_cdf(almost, 1 - 1e-6).value if g > 0 else phase_cdf(almost, -1 + 1e-6).value
    assert inside == pytest.approx(1, abs=1e-12)


# E11: the Henyey-Greenstein sampler that divides by 2 g.


def printed_sampler(g, xi):
    return (1 + g**2 - ((1 - g**2) / (1 - g + 2 * g * xi)) ** 2) / (2 * g)


def test_e11_the_printed_sampler_loses_its_digits_as_g_vanishes():
    xi = np.linspace(0, 1, 1001)
    loss = {}
    for g in (1e-12, 1e-8, 1e-4, 0.5):
        right = phase_quantile(HenyeyGreenstein(g), xi)
        assert right.error.max() < 1e-14
        loss[g] = np.abs(printed_sampler(g, xi) - right.value).max()
        assert right.value == pytest.approx(2 * xi - 1, abs=4 * g)
    assert 1e-5 < loss[1e-12] < 1e-3
    assert 1e-9 < loss[1e-8] < 1e-7
    assert loss[0.5] < 1e-14  # for moderate g it is right
    with np.errstate(all="ignore"):
        assert np.isnan(printed_sampler(np.float64(0.0), xi)).all()
    assert phase_quantile(HenyeyGreenstein(0.0), xi).value == pytest.approx(2 * xi - 1, abs=1e-15)


# E12: -log(xi) or -log(1 - xi) with xi from [0, 1).


def test_e12_edge_uniforms():
    medium, sigma = Medium(0.0, 0.5), 0.5
    with np.errstate(divide="ignore"):
        assert -np.log(0.0) / sigma == np.inf  # xi = 0 is generated, once in 2^53 draws, and gives an infinite path
    assert free_path(medium, ray(np.inf), -np.log1p(-0.0)).value == 0
    # On the grid of generated numbers k 2^-53 the subtraction 1 - xi is exact, and so is the printed form.
    xi = np.array([1, 3, 1000]) * 2.0**-53
    right = free_path(medium, ray(np.inf), -np.log1p(-xi))
    assert -np.log(1 - xi) / sigma == pytest.approx(right.value, rel=1e-15)
    # Off that grid, for transformed or denormal xi, it is not: small distances vanish.
    xi = np.array([1e-17, 1e-30, 5e-324])
    right = free_path(medium, ray(np.inf), -np.log1p(-xi)).value
    assert (-np.log(1 - xi) / sigma == 0).all()
    assert right == pytest.approx(xi / sigma, rel=1e-12)
    assert (right > 0).all()


# Printed as it should be: the Rayleigh scattering coefficient.


def test_the_rayleigh_coefficient_is_no_erratum():
    """rho 2 pi^5 d^6/(3 lambda^4) ((eta^2 - 1)/(eta^2 + 2))^2 against the Lorenz-Mie solution of a small sphere."""
    miepython = pytest.importorskip("miepython", reason="python -m pip install 'fogproof[mie]'")
    d, wavelength, eta, rho = 5e-9, 550e-9, 1.33, 1e20
    printed = rho * 2 * np.pi**5 * d**6 / (3 * wavelength**4) * ((eta**2 - 1) / (eta**2 + 2)) ** 2
    assert rayleigh_scattering_coefficient(d, eta, rho, wavelength).value == pytest.approx(printed, rel=1e-13)
    cross_section = miepython.efficiencies(eta, d, wavelength)[1] * np.pi * d**2 / 4
    assert rho * cross_section == pytest.approx(printed, rel=1e-3)
