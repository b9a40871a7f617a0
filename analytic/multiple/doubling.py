"""Adding and doubling: what a layer reflects and transmits, from one so thin that a power series gives it.

Layers are matrices between directions of a quadrature on (0, 1), for one Fourier mode in azimuth. With weights W_i = 2 mu_i w_i
all are held as W^(1/2) kernel W^(1/2), which reciprocity makes symmetric. What passes straight through is held
apart from what is scattered. All is made of sums and products of positive numbers but the inverse of 1 - R^2, and of that
R 1 + T 1 + absorbed = 1 tells the image of one vector exactly. So deep, thin and nearly conservative layers keep their digits.
A direction of interest that is no node is one of weight 2^-80.
Source: van de Hulst 1980, Multiple Light Scattering, section 4.4; de Haan, Bosma & Hovenier 1987, Astronomy and
Astrophysics 183; Xue & Li 2017, Highly accurate doubling algorithms for M-matrix algebraic Riccati equations.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

TERMS = 26
"""Of the power series of the first layer, whose thickness is at most the smallest cosine."""

SIDE = 2.0**-80
"""Weight of a direction that is no node."""


class Layer(NamedTuple):
    """A layer (b,) between n directions: reflection and diffuse transmission (b, n, n), straight transmission (b, n).

    glow  (b, n) what leaves it if it emits 1 per optical depth in all directions, times W^(1/2)
    """

    R: np.ndarray
    T: np.ndarray
    ray: np.ndarray
    glow: np.ndarray


class ScatteringLayer(NamedTuple):
    """Scattering at directions mu (n,) of weights w: shares backward, forward (b, n, n) so that

    c p(mu_i, mu_j)/2 = backward or forward, p averaged over azimuth (or its Fourier mode); absorbed (b,) is 1 - c.
    balanced (b,) says that all that is not absorbed is scattered: the mean over azimuth, not a higher mode.
    """

    mu: np.ndarray
    w: np.ndarray
    forward: np.ndarray
    backward: np.ndarray
    absorbed: np.ndarray
    balanced: np.ndarray


def layer(medium: ScatteringLayer, tau: np.ndarray) -> Layer:
    """Return layers of optical thickness tau > 0 (b,)."""
    times = max(0, int(np.ceil(np.log2(np.max(tau) / np.min(medium.mu)))))
    thin = thin_layer(medium, tau * 2.0**-times)
    for i in range(times):
        if not (np.any(thin.ray) or np.any(thin.T)):
            break  # nothing passes any more, not even a denormal number: more of it changes nothing
        thin = doubled(thin, medium)
        thin = thin._replace(ray=np.exp(-(tau * 2.0 ** (i + 1 - times))[:, None] / medium.mu))
    return thin


def thin_layer(medium: ScatteringLayer, tau: np.ndarray) -> Layer:
    """Return layers of a thickness tau (b,) of at most the smallest cosine.

    Upwards from the lower side, where 1 leaves and nothing enters, light obeys a linear differential equation, whose power
    series is summed.
    """
    mu, root = medium.mu, np.sqrt(2 * medium.mu * medium.w)
    step = tau[:, None] / mu
    share = np.sqrt(medium.w / mu)
    around = share[:, None] * share * tau[:, None, None]
    on, back = medium.forward * around, medium.backward * around
    straight = np.ones_like(step)
    down, up = np.zeros_like(on), np.zeros_like(on)
    down_glow, up_glow = np.zeros_like(step)[..., None], np.zeros_like(step)[..., None]
    sum_down, sum_up, sum_glow = down, up, down_glow
    source = (step * root)[..., None]
    column = step[..., None]
    for m in range(1, TERMS):
        down, up = (
            (column * down - on @ down - back @ up - on * straight[:, None, :]) / m,
            (on @ up - column * up + back @ down + back * straight[:, None, :]) / m,
        )
        down_glow, up_glow = (
            (column * down_glow - on @ down_glow - back @ up_glow - source) / m,
            (on @ up_glow - column * up_glow + back @ down_glow + source) / m,
        )
        source = np.zeros_like(source)
        straight = straight * step / m
        sum_down, sum_up, sum_glow = sum_down + down, sum_up + up, sum_glow + down_glow
    ray = np.exp(-step)
    faded = ray[..., None] * sum_down
    T = -np.linalg.solve(np.eye(len(mu)) + faded, faded * ray[:, None, :])
    R = sum_up * ray[:, None, :] + sum_up @ T
    glow = -(ray[..., None] * sum_glow + T @ sum_glow)[..., 0]
    return Layer(_symmetric(R), _symmetric(T), ray, glow)


def doubled(one: Layer, medium: ScatteringLayer) -> Layer:
    """Return two such layers on one another."""
    R, T, ray, glow = one
    row, column = ray[..., None], ray[:, None, :]
    identity = np.eye(R.shape[-1])
    root = np.sqrt(2 * medium.mu * medium.w)
    square = R @ R
    between = np.linalg.inv(identity - square)  # 1 + (light that comes back)
    if np.any(medium.balanced):
        kept = ray * root + _apply(T, root) + medium.absorbed[:, None] * glow  # (1 - R) root
        between = _corrected(between, root, kept + _apply(R, kept), medium.balanced)
    returned = between @ (R * column + R @ T)
    passed = (between @ square) * column + between @ T
    within = _apply(between, glow + _apply(R, glow))
    return Layer(
        _symmetric(R + row * returned + T @ returned),
        _symmetric(row * passed + T * column + T @ passed),
        ray * ray,
        glow + ray * within + _apply(T, within),
    )


def _apply(matrix: np.ndarray, vector: np.ndarray) -> np.ndarray:
    return (matrix @ vector[..., None])[..., 0]


def _corrected(inverse: np.ndarray, image: np.ndarray, vector: np.ndarray, where: np.ndarray) -> np.ndarray:
    """Return a symmetric inverse, made to take `vector` to `image`: its error has one direction, which that tells."""
    rest = image - _apply(inverse, vector)
    along = np.sum(rest * vector, axis=-1)
    clear = where & (np.abs(along) > 0.1 * np.linalg.norm(rest, axis=-1) * np.linalg.norm(vector, axis=-1))
    scaled = rest / np.where(clear, along, np.inf)[:, None]
    return inverse + rest[..., None] * scaled[:, None, :]


def _symmetric(matrix: np.ndarray) -> np.ndarray:
    return (matrix + np.swapaxes(matrix, -1, -2)) / 2
