"""Slabs of any phase function by adding layers in 100 digits, from one of 2^-k of the thickness that scatters once.

No eigenvalues, no power series, no weights under roots and no delta: what rounding and the first layer cost is far below 1e-20,
and what the nodes and moments cost is told by more of them.
"""

from __future__ import annotations

import flint

BITS = 340


def gauss(n):
    """Nodes y^2 and weights of n points y on (0, 1): radiance is like mu ln(mu) at grazing angles."""
    pairs = [flint.arb.legendre_p_root(n, k, weight=True) for k in range(n)]
    return [((1 + x) / 2) ** 2 for x, _ in pairs], [(1 + x) / 2 * w for x, w in pairs]


def polynomials(highest, x):
    """P_0 … P_highest at x."""
    P = [flint.arb(1), x]
    for k in range(1, highest):
        P.append(((2 * k + 1) * x * P[k] - k * P[k - 1]) / (k + 1))
    return P[: highest + 1]


def doubled_truth(c, tau, mu0, chi, n=40, moments=None, halvings=100):
    """(reflectance, transmittance) of a beam at mu0, at n nodes and with the moments up to that number, as floats."""
    with flint.ctx.workprec(BITS):
        c, tau, last = flint.arb(c), flint.arb(tau), 2 * n - 1 if moments is None else moments
        mu, w = gauss(n)
        mu, w = [*mu, flint.arb(mu0)], [*w, flint.arb(0)]
        P = [polynomials(last, x) for x in mu]
        chi = [flint.arb(chi(degree)) if callable(chi) else flint.arb(chi[degree]) for degree in range(last + 1)]
        even = flint.arb_mat(
            [[(2 * degree + 1) * chi[degree] * p[degree] for degree in range(0, last + 1, 2)] for p in P]
        )
        odd = flint.arb_mat(
            [[(2 * degree + 1) * chi[degree] * p[degree] for degree in range(1, last + 1, 2)] for p in P]
        )
        even = even * flint.arb_mat([[p[degree] for p in P] for degree in range(0, last + 1, 2)])
        odd = odd * flint.arb_mat([[p[degree] for p in P] for degree in range(1, last + 1, 2)])
        size, thin = n + 1, tau / flint.arb(2) ** halvings
        one = flint.arb_mat([[int(i == j) for j in range(size)] for i in range(size)])
        scale = [[c / 2 * w[j] * thin / mu[i] for j in range(size)] for i in range(size)]
        R = flint.arb_mat([[(even[i, j] - odd[i, j]) * scale[i][j] for j in range(size)] for i in range(size)])
        T = flint.arb_mat([[(even[i, j] + odd[i, j]) * scale[i][j] for j in range(size)] for i in range(size)])
        T += flint.arb_mat([[(-thin / mu[i]).exp() if i == j else 0 for j in range(size)] for i in range(size)])
        for _ in range(halvings):
            between = (one - R * R).solve(T, algorithm="approx")
            R, T = (R + T * R * between).mid(), (T * between).mid()
        sky = flint.arb_mat([[1]] * size)
        return float((R * sky)[n, 0]), float((T * sky)[n, 0])
