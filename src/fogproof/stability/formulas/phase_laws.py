"""Densities, distributions, inverses and means of phase functions by their textbook formulas, in ball arithmetic."""

from __future__ import annotations

from fogproof.stability.exact import flint, inverted


def pi4():
    return 4 * flint().arb.pi()


def hg_pdf(mu, g):
    return (1 - g * g) / (pi4() * (1 + g * g - 2 * g * mu) ** flint().arb(1.5))


def hg_cdf(mu, g):
    if g.is_zero():
        return (1 + mu) / 2
    return (1 - g * g) / (2 * g) * (1 / (1 + g * g - 2 * g * mu).sqrt() - 1 / (1 + g))


def hg_place(xi, g):
    return 2 * xi - 1 if g.is_zero() else (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * xi)) ** 2) / (2 * g)


def schlick_cdf(mu, k):
    return (1 + mu) / 2 if k.is_zero() else (1 - k * k) / (2 * k) * (1 / (1 - k * mu) - 1 / (1 + k))


def schlick_mean(k):
    return k if k.is_zero() else 1 / k + (1 - k * k) / (2 * k * k) * ((1 - k) / (1 + k)).log()


def power_pdf(n):
    return lambda mu: (1 + (n + 1) * ((1 + mu) / 2) ** n) / (2 * pi4())


def power_cdf(n):
    return lambda mu: ((1 + mu) / 2 + ((1 + mu) / 2) ** (n + 1)) / 2


def power_place(n):
    """Half of the uniforms are a place themselves, the other half the root of one."""

    def place(xi):
        v = 2 * xi - 1
        return -2 * v - 1 if v < 0 else 2 * v ** (flint().arb(1) / (n + 1)) - 1

    return place


def draine_pdf(mu, g, alpha):
    return (1 + alpha * mu * mu) / (1 + alpha * (1 + 2 * g * g) / 3) * hg_pdf(mu, g)


def draine_cdf(mu, g, alpha):
    norm = 1 + alpha * (1 + 2 * g * g) / 3
    if g.is_zero():
        return ((1 + mu) / 2 + alpha * (1 + mu**3) / 6) / norm
    c, D0, D = 1 + g * g, 1 + g, (1 + g * g - 2 * g * mu).sqrt()
    square = (1 - g * g) / (8 * g**3) * (c * c * (1 / D - 1 / D0) - 2 * c * (D0 - D) + (D0**3 - D**3) / 3)
    return (hg_cdf(mu, g) + alpha * square) / norm


def draine_place(xi, g, alpha):
    two_pi = 2 * flint().arb.pi()
    return inverted(lambda mu: draine_cdf(mu, g, alpha), lambda mu: two_pi * draine_pdf(mu, g, alpha), xi)


def draine_mean(g, alpha):
    return g * (1 + alpha * (3 + 2 * g * g) / 5) / (1 + alpha * (1 + 2 * g * g) / 3)


def cornette_shanks(function):
    return lambda *x, **given: function(*x, **given, alpha=flint().arb(1))


def two_lobes_place(xi, g, weight):
    """Lobes of mean cosine g and -1/4; the share of xi that chose one is drawn out again."""
    if xi < weight:
        return hg_place(xi / weight, g)
    return hg_place((xi - weight) / (1 - weight), flint().arb(-0.25))


def two_lobes(function):
    def mean(*x, g, weight, **named):
        return weight * function(*x, **named, g=g) + (1 - weight) * function(*x, **named, g=flint().arb(-0.25))

    return mean


def ff_constants(n, slope):
    nu, k = (3 - slope) / 2, 4 / (3 * (n - 1) ** 2)
    return nu, k, (1 - k**nu) / ((k - 1) * k**nu)


def ff_pdf(mu, n, slope):
    nu, k, last = ff_constants(n, slope)
    s = (1 - mu) / 2
    if s.is_zero():
        return flint().arb.pos_inf()
    d = k * s
    power = d**nu
    bracket = nu * (1 - d) - (1 - power) + (d * (1 - power) - nu * (1 - d)) / s
    return (bracket / ((1 - d) ** 2 * power) + last / 4 * (3 * mu * mu - 1)) / pi4()


def ff_beyond(mu, n, slope):
    """The share that scatters by less than the angle of mu."""
    nu, k, last = ff_constants(n, slope)
    s = (1 - mu) / 2
    if s.is_zero():
        return s
    d = k * s
    head = ((1 - d ** (nu + 1)) - (1 - d**nu) * s) / ((1 - d) * d**nu)
    return head + last / 8 * mu * (1 - mu * mu)


def ff_cdf(mu, n, slope):
    return 1 - ff_beyond(mu, n, slope)


def ff_place(xi, n, slope):
    two_pi = 2 * flint().arb.pi()
    return inverted(lambda mu: ff_cdf(mu, n, slope), lambda mu: two_pi * ff_pdf(mu, n, slope), xi)
