"""The airlight integral in ball arithmetic (python-flint), by other formulas than the package's.

With v = (t + r)/h the integral is (2/h) e^(sigma a) int e^(-H v) / (1 + v^2) 4 pi f_p dv, H = sigma h, and the forward
cosine (1 - v^2)/(1 + v^2). Isotropic: closed form by the complex exponential integral (Pegoraro & Parker 2009), with as
many digits as its cancellations need. Other phase functions: `acb.integral`. Every answer is enclosed to 90 bits.
"""

from __future__ import annotations

import math

import mpmath as mp
from flint import acb, arb, ctx

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
)

BITS = 90


def airlight(sigma, h, a, b, phase=None):
    """Return the integral as an mpf, right to 90 bits, for inputs (float or mpf) taken exactly."""
    phase = phase or Isotropic()
    prec = 160
    while prec < 40000:
        ctx.prec = prec
        inputs = [_arb(x) for x in (sigma, h, a)] + [b if b == math.inf else _arb(b)]
        if h == 0:
            enclosure = _on_the_line(inputs[0], *inputs[2:], phase)
        elif isinstance(phase, Isotropic):
            enclosure = _closed_form(*inputs)
        else:
            enclosure = _integral(*inputs, phase)
        if a == b or enclosure.rel_accuracy_bits() >= BITS:
            with mp.workprec(BITS + 20):
                return mp.mpf(enclosure.mid().str(40, radius=False))
        prec *= 2
    raise ArithmeticError(f"no enclosure for {sigma, h, a, b, phase}: {enclosure}")


def _arb(x):
    if not isinstance(x, mp.mpf):
        return arb(x)
    sign, mantissa, exponent, _ = x._mpf_
    return arb(int(-mantissa if sign else mantissa)) * arb(2) ** exponent


def phase_factor(phase, mu, analytic=False):
    """4 pi f_p at the forward cosine mu, textbook form; mu itself for the phase "mu"."""
    match phase:
        case "mu":
            return mu
        case Isotropic():
            return acb(1)
        case HenyeyGreenstein(g) | CornetteShanks(g) | Draine(g, _):
            g = arb(g)
            distance = 1 + g * g - 2 * g * mu
            lobe = (1 - g * g) / (distance * acb(distance).sqrt(analytic=analytic))
            if isinstance(phase, HenyeyGreenstein):
                return lobe
            alpha = arb(getattr(phase, "alpha", 1.0))
            return lobe * (1 + alpha * mu * mu) / (1 + alpha * (1 + 2 * g * g) / 3)
        case DoubleHenyeyGreenstein(g1, g2, weight):
            parts = (HenyeyGreenstein(g1), arb(weight)), (HenyeyGreenstein(g2), 1 - arb(weight))
            return sum((w * phase_factor(part, mu, analytic) for part, w in parts), acb(0))
        case Mixture(components, weights):
            total = sum((arb(w) for w in weights), arb(0))
            parts = zip(components, weights, strict=True)
            return sum((arb(w) / total * phase_factor(part, mu, analytic) for part, w in parts), acb(0))
        case Schlick(k):
            k = arb(k)
            return (1 - k * k) / (1 - k * mu) ** 2
        case Hazy():
            return arb(0.5) + arb(4.5) * ((1 + mu) / 2) ** 8
        case Murky():
            return arb(0.5) + arb(16.5) * ((1 + mu) / 2) ** 32
        case Rayleigh():
            return (1 + mu * mu) * arb(3) / 4
    raise NotImplementedError(phase)


def _closed_form(sigma, h, a, b):
    H = sigma * h

    def tail(t):
        if sigma == 0:
            return arb.pi() / 2 - (((t * t + h * h).sqrt() + t) / h).atan()
        v = ((t * t + h * h).sqrt() + t) / h
        return (acb(0, -H).exp() * acb(H * v, -H).expint(1)).imag

    rest = tail(b) if b < math.inf else 0
    return 2 / h * (sigma * a).exp() * (tail(a) - rest)


def _integral(sigma, h, a, b, phase):
    spread = 200
    H = sigma * h

    def v(t):
        r = (t * t + h * h).sqrt()
        return (r + t) / h if t > 0 else h / (r - t)

    va = v(a)
    far = arb.max(va, arb(1)) * arb(2) ** (BITS + 80)
    if sigma > 0:
        far = arb.min(far, va + spread / H)
    vb = arb.min(v(b), far) if b < math.inf else far

    def near_part(x, analytic):
        square = x * x
        mu = (1 - square) / (1 + square)
        return (H * (va - x)).exp() / (1 + square) * phase_factor(phase, mu, analytic)

    def far_part(y, analytic):  # y = 1/v
        square = y * y
        mu = (square - 1) / (square + 1)
        return (H * (va - 1 / y)).exp() / (1 + square) * phase_factor(phase, mu, analytic)

    total = acb(0)
    if va < 1:
        total += acb.integral(near_part, va, arb.min(vb, arb(1)), eval_limit=10**6)
    if vb > 1:
        total += acb.integral(far_part, 1 / vb, 1 / arb.max(va, arb(1)), eval_limit=10**6)
    return 2 / h * (sigma * a - H * va).exp() * total.real


def _on_the_line(sigma, a, b, phase):
    if b < 0:
        return (-1 / b + 1 / a) * (sigma * a).exp() * phase_factor(phase, arb(1)).real

    def tail(t):
        return (2 * sigma * t).expint(arb(2)) / t if sigma > 0 else 1 / t

    rest = tail(b) if b < math.inf else 0
    return (sigma * a).exp() * (tail(a) - rest) * phase_factor(phase, arb(-1)).real
