"""Phase functions by their textbook formulas, in the precision that mpmath is set to."""

import mpmath as mp

from fogproof.scene import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Mixture,
    Murky,
    Rayleigh,
    Schlick,
    Tabulated,
)


def table(phase):
    return [mp.mpf(c) for c in phase.cosines], [mp.mpf(f) for f in phase.values]


def trapezoids(c, f):
    return 2 * mp.pi * sum((c[i + 1] - c[i]) * (f[i] + f[i + 1]) / 2 for i in range(len(c) - 1))


def blend(phase, function, *args):
    """The weighted mean of a function over the components of a mixture."""
    match phase:
        case DoubleHenyeyGreenstein(g1, g2, w):
            return w * function(HenyeyGreenstein(g1), *args) + (1 - mp.mpf(w)) * function(HenyeyGreenstein(g2), *args)
        case Mixture(components, weights):
            pairs = zip(components, weights, strict=True)
            return sum(mp.mpf(w) * function(c, *args) for c, w in pairs) / sum(map(mp.mpf, weights))


def true_pdf(phase, mu):
    u = (1 + mu) / 2
    match phase:
        case Isotropic():
            return 1 / (4 * mp.pi)
        case Rayleigh():
            return 3 / (16 * mp.pi) * (1 + mu**2)
        case Hazy():
            return (mp.mpf(1) / 2 + mp.mpf(9) / 2 * u**8) / (4 * mp.pi)
        case Murky():
            return (mp.mpf(1) / 2 + mp.mpf(33) / 2 * u**32) / (4 * mp.pi)
        case HenyeyGreenstein(g):
            g = mp.mpf(g)
            return (1 - g**2) / (4 * mp.pi * (1 + g**2 - 2 * g * mu) ** 1.5)
        case Schlick(k):
            k = mp.mpf(k)
            return (1 - k**2) / (4 * mp.pi * (1 - k * mu) ** 2)
        case CornetteShanks(g):
            return 3 * (1 + mu**2) / (2 * (2 + mp.mpf(g) ** 2)) * true_pdf(HenyeyGreenstein(g), mu)
        case Draine(g, alpha):
            mean = 1 + mp.mpf(alpha) * (1 + 2 * mp.mpf(g) ** 2) / 3
            return (1 + mp.mpf(alpha) * mu**2) / mean * true_pdf(HenyeyGreenstein(g), mu)
        case Tabulated():
            c, f = table(phase)
            i = max(i for i in range(len(c) - 1) if c[i] <= mu)
            return (f[i] + (f[i + 1] - f[i]) * (mu - c[i]) / (c[i + 1] - c[i])) / trapezoids(c, f)
    return blend(phase, true_pdf, mu)


def true_cdf(phase, mu):
    u = (1 + mu) / 2
    match phase:
        case Isotropic():
            return u
        case Rayleigh():
            return (4 + 3 * mu + mu**3) / 8
        case Hazy():
            return (u + u**9) / 2
        case Murky():
            return (u + u**33) / 2
        case HenyeyGreenstein(g) | Schlick(g) if abs(g) < 1e-30:
            return u
        case HenyeyGreenstein(g):
            g = mp.mpf(g)
            return (1 - g**2) / (2 * g) * (1 / mp.sqrt(1 + g**2 - 2 * g * mu) - 1 / (1 + g))
        case Schlick(k):
            k = mp.mpf(k)
            return (1 - k**2) / (2 * k) * (1 / (1 - k * mu) - 1 / (1 + k))
        case CornetteShanks(g):
            return true_cdf(Draine(g, 1.0), mu)
        case Draine(g, alpha) if abs(g) < 1e-30:
            return ((1 + mu) / 2 + mp.mpf(alpha) * (1 + mu**3) / 6) / (1 + mp.mpf(alpha) / 3)
        case Draine(g, alpha):
            alpha, gg = mp.mpf(alpha), mp.mpf(g)
            c, D0, D = 1 + gg**2, 1 + gg, mp.sqrt(1 + gg**2 - 2 * gg * mu)
            square = (1 - gg**2) / (8 * gg**3) * (c**2 * (1 / D - 1 / D0) - 2 * c * (D0 - D) + (D0**3 - D**3) / 3)
            return (true_cdf(HenyeyGreenstein(g), mu) + alpha * square) / (1 + alpha * (1 + 2 * gg**2) / 3)
        case Tabulated():
            c, f = table(phase)
            cut = [x for x in c if x < mu]
            values = [*f[: len(cut)], true_pdf(phase, mu) * trapezoids(c, f)]
            return trapezoids([*cut, mu], values) / trapezoids(c, f)
    return blend(phase, true_cdf, mu)


def true_mean(phase):
    match phase:
        case Isotropic() | Rayleigh():
            return mp.mpf(0)
        case Hazy():
            return mp.mpf(2) / 5
        case Murky():
            return mp.mpf(8) / 17
        case HenyeyGreenstein(g):
            return mp.mpf(g)
        case Schlick(k) if abs(k) < 1e-30:
            return mp.mpf(2) / 3 * k
        case Schlick(k):
            k = mp.mpf(k)
            return 1 / k + (1 - k**2) / (2 * k**2) * mp.log((1 - k) / (1 + k))
        case CornetteShanks(g):
            g = mp.mpf(g)
            return 3 * g * (4 + g**2) / (5 * (2 + g**2))
        case Draine(g, alpha):
            g, alpha = mp.mpf(g), mp.mpf(alpha)
            return g * (1 + alpha * (3 + 2 * g**2) / 5) / (1 + alpha * (1 + 2 * g**2) / 3)
        case Tabulated():
            c, f = table(phase)
            cells = ((b - a, a, b, p, q) for a, b, p, q in zip(c, c[1:], f, f[1:], strict=False))
            moment = sum(h * (a * p + (a + b) * (p + q) + b * q) / 6 for h, a, b, p, q in cells)
            return 2 * mp.pi * moment / trapezoids(c, f)
    return blend(phase, true_mean)
