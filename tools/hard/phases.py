"""Phase functions in many digits: densities, distributions, their inverses, means and Legendre moments."""

from __future__ import annotations

import mpmath as mp

from fogproof import analytic
from fogproof.scene import HenyeyGreenstein, Isotropic, Rayleigh, Schlick
from hard.case import Kind, number, signed


def function(rng):
    """Return a phase function, and its density as a formula."""
    g = signed(rng, float(rng.choice([rng.random(), number(rng, 1e-9, 1), 1 - number(rng, 1e-4, 1)])))
    gg = mp.mpf(g)
    return (
        (Isotropic(), lambda m: 1 / (4 * mp.pi)),
        (HenyeyGreenstein(g), lambda m: (1 - gg * gg) / (4 * mp.pi) / mp.sqrt(1 + gg * gg - 2 * gg * m) ** 3),
        (Schlick(g), lambda m: (1 - gg * gg) / (4 * mp.pi) / (1 - gg * m) ** 2),
        (Rayleigh(), lambda m: 3 * (1 + m * m) / (16 * mp.pi)),
    )[rng.integers(4)]


def cosine(rng):
    """Return a cosine that crowds towards +-1."""
    return signed(rng, float(rng.choice([rng.random(), 1 - number(rng, 1e-15, 1), 1.0])))


def density(at):
    def draw(rng):
        with mp.workdps(50):
            phase, formula = function(rng)
            mu = cosine(rng)
            truth = formula(mp.mpf(mu))
        if at:
            return lambda: analytic.phase_pdf_at(phase, (1.0, 2.0, 3.0), mu), truth, 0, f"{phase} {mu}"
        return lambda: analytic.phase_pdf(phase, mu), truth, 0, f"{phase} {mu}"

    return draw


def below(phase, formula, mu):
    """The integral of the density up to mu, from its primitive."""
    mu = mp.mpf(mu)
    if isinstance(phase, HenyeyGreenstein) and phase.g:
        g = mp.mpf(phase.g)
        return (1 - g * g) / (2 * g) * (1 / mp.sqrt(1 + g * g - 2 * g * mu) - 1 / (1 + g))
    if isinstance(phase, Schlick) and phase.k:
        k = mp.mpf(phase.k)
        return (1 - k * k) / (2 * k) * (1 / (1 - k * mu) - 1 / (1 + k))
    if isinstance(phase, Rayleigh):
        return (3 * mu + mu**3 + 4) / 8
    return (1 + mu) / 2


def distribution(rng):
    with mp.workdps(60):
        phase, formula = function(rng)
        mu = cosine(rng)
        truth = below(phase, formula, mu)
    return lambda: analytic.phase_cdf(phase, mu), truth, 0, f"{phase} {mu}"


def quantile(rng):
    """The cosine below which a chosen share lies: the share of a chosen cosine is exact to 2^-53 only, which is the doubt."""
    with mp.workdps(60):
        phase, formula = function(rng)
        mu = float(rng.uniform(-0.999, 0.999))
        share = below(phase, formula, mu)
        xi = float(share)
        doubt = abs(mp.mpf(xi) - share) / (2 * mp.pi * formula(mp.mpf(mu))) * 2
    return lambda: analytic.phase_quantile(phase, xi), mp.mpf(mu), doubt, f"{phase} {xi}"


def mean(rng):
    with mp.workdps(60):
        phase, _ = function(rng)
        truth = mp.mpf(0)
        if isinstance(phase, HenyeyGreenstein):
            truth = mp.mpf(phase.g)
        elif isinstance(phase, Schlick):
            k = mp.mpf(phase.k)
            truth = 1 / k + (1 - k * k) / (2 * k * k) * mp.log((1 - k) / (1 + k))
    return lambda: analytic.phase_mean_cosine(phase), truth, 0, f"{phase}"


def moment(rng):
    g, order = float(rng.uniform(-0.999, 0.999)), int(rng.integers(1, 200))
    with mp.workdps(60):
        truth = mp.mpf(g) ** order

    def call():
        found = analytic.phase_legendre_moments(HenyeyGreenstein(g), order)
        return type(found)(found.value[order], found.error[order], found.method, found.source)

    return call, truth, 0, f"{g} {order}"


KINDS = {
    "phase_pdf": Kind(density(False), 20),
    "phase_pdf_at": Kind(density(True), 10),
    "phase_cdf": Kind(distribution, 20),
    "phase_quantile": Kind(quantile, 10),
    "phase_mean_cosine": Kind(mean, 10),
    "phase_legendre_moments": Kind(moment, 10),
}
