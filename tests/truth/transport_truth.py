"""What the tests of multiple scattering compare with: slow, literal and independent of the package.

Discrete ordinates with tanh-sinh nodes in 60-digit arithmetic (python-flint), and PythonicDISORT.
"""

from __future__ import annotations

import itertools

import flint
import numpy as np

DIGITS = 60


def tanh_sinh(step):
    """Nodes and weights on (0, 1): mu = 1/(1 + exp(-pi sinh t))."""
    count = int(3.6 / float(step))
    nodes = []
    for i in range(-count, count + 1):
        t = flint.arb(i) * step
        mu = 1 / (1 + (-flint.arb.pi() * t.sinh()).exp())
        nodes.append((mu, step * flint.arb.pi() * t.cosh() * mu * (1 - mu)))
    return nodes


def bisect(f, low, high, steps):
    """A root of an increasing f between positive low and high, in equal steps of the logarithm."""
    for _ in range(steps):
        middle = (low * high).sqrt().mid()
        if f(middle) < 0:
            low = middle
        else:
            high = middle
    return (low * high).sqrt().mid()


def slab_truth(c, tau, mu0, step=1 / 12):
    """(reflectance, transmittance) of an isotropically scattering slab for a beam at mu0, as floats."""
    with flint.ctx.workdps(DIGITS):
        return tuple(float(x) for x in _slab(flint.arb(c), flint.arb(tau), flint.arb(mu0), flint.arb(step)))


def _slab(c, tau, mu0, step):
    nodes = tanh_sinh(step)
    squares = [mu * mu for mu, _ in nodes]
    weights = [c * w * m2 for (_, w), m2 in zip(nodes, squares, strict=True)]

    def relation(x):
        return (1 - c) - sum((w / (x - m2) for w, m2 in zip(weights, squares, strict=True)), flint.arb(0))

    roots = []
    for low, high in itertools.pairwise(squares):
        gap = high - low
        # The odds of the position in the gap, so that both ends are resolved.
        odds = bisect(
            lambda o, low=low, gap=gap: relation(low + gap * o / (1 + o)), flint.arb("1e-50"), flint.arb("1e50"), 180
        )
        roots.append(low + gap * odds / (1 + odds))
    above = bisect(lambda d: relation(squares[-1] + d), flint.arb("1e-50"), flint.arb("1e40"), 180)
    k = [1 / x.sqrt() for x in [*roots, squares[-1] + above]]
    half = tau / 2
    tanh = [(kj * half).tanh() for kj in k]
    n = len(nodes)
    even = flint.arb_mat(
        [[(1 + kj * t * mu) / (1 - kj * kj * mu * mu) for kj, t in zip(k, tanh, strict=True)] for mu, _ in nodes]
    )
    odd = flint.arb_mat(
        [[(t / kj + mu) / (1 - kj * kj * mu * mu) for kj, t in zip(k, tanh, strict=True)] for mu, _ in nodes]
    )
    ones = flint.arb_mat([[1]] * n)
    a, b = even.solve(ones, algorithm="approx"), odd.solve(ones, algorithm="approx")
    e = (-tau / mu0).exp()
    total, difference = e, -e
    for j, (kj, t) in enumerate(zip(k, tanh, strict=True)):
        width = 1 - kj * kj * mu0 * mu0
        total += a[j, 0] * ((1 - kj * mu0 * t) - (1 + kj * mu0 * t) * e) / width
        difference += b[j, 0] * ((t - kj * mu0) + (t + kj * mu0) * e) / (kj * width)
    return (total + difference) / 2, (total - difference) / 2


def disort(c, tau, mu0, chi, streams=64):
    """(reflectance, total transmittance) of a slab with Legendre moments chi, from PythonicDISORT."""
    from PythonicDISORT.pydisort import pydisort

    _, up, down = pydisort(
        tau, c, streams, np.asarray(chi)[None, :], mu0, 1 / mu0, 0.0, NLeg=min(streams, len(chi)), only_flux=True
    )[:3]
    diffuse, direct = down(tau)
    return float(up(0)), float(diffuse + direct)
