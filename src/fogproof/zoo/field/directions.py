"""Bugs of phase functions, lobes and frames."""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.contracts import Draw
from fogproof.domains import UnitHemisphere
from fogproof.zoo.bug import Bug, sampler_bug
from fogproof.zoo.laws import Array, directions, even, frame, hg

TILTED = frame((0.6, -0.3, 0.7))
COS = lambda x: x[:, 2] / np.pi  # noqa: E731
HALF: dict[str, Any] = {"domain": UnitHemisphere()}


def _negative_g(u: Array) -> Array:
    return directions(2 * u[:, 0] - 1, u[:, 1])


def _tabulated(u: Array) -> Draw:
    x = hg(0.6)[0](u)
    return Draw(x, pdf=hg(0.6)[1](x))


def _one_lobe(u: Array) -> Draw:
    forward = u[:, 2] < 0.5
    x = np.where(forward[:, None], hg(0.8)[0](u), hg(-0.3)[0](u))
    return Draw(x, pdf=np.where(forward, hg(0.8)[1](x), hg(-0.3)[1](x)))


def _blend(x: Array) -> Array:
    return 0.5 * hg(0.8)[1](x) + 0.5 * hg(-0.3)[1](x)


def _unweighted(u: Array) -> Draw:
    return Draw(directions(2 * u[:, 0] - 1, u[:, 1]), weight=np.ones(len(u)))


def _nodes(u: Array) -> Array:
    return directions(-1 + 0.1 * np.minimum(np.floor(21 * u[:, 0]), 20), u[:, 1])


def _float32_small_g(u: Array) -> Array:
    g, one = u.dtype.type(1e-6), u.dtype.type(1)
    s = (one - g * g) / (one - g + 2 * g * u[:, 0])
    return directions(np.clip((one + g * g - s * s) / (2 * g), -1, 1), u[:, 1]).astype(u.dtype)


def _no_sign(u: Array) -> Array:
    x = hg(-0.5)[0](u)
    return np.stack([x[:, 0], x[:, 1], np.sqrt(np.maximum(1 - x[:, 0] ** 2 - x[:, 1] ** 2, 0))], axis=-1)


def _acos_twice(u: Array) -> Array:
    with np.errstate(invalid="ignore"):
        theta = np.arccos(-0.2 + 1.6 * u[:, 0])
    return directions(np.cos(theta), u[:, 1])


def _bad_basis(u: Array) -> Array:
    local = hg(0.8)[0](u)
    w = np.array([0.1, 0.2, np.sqrt(1 - 0.05)])
    polar = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, np.sign(w[2])]])
    polar[2] = w  # two rows of one frame, the third of another
    return local @ polar


def _lambert_ball(u: Array) -> Array:
    inside = directions(2 * u[:, 0] - 1, u[:, 1]) * np.cbrt(u[:, 2:])
    x = inside + np.array([0, 0, 1])
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def _doubled(u: Array) -> Array:
    x = directions(np.sqrt(1 - u[:, 0]), u[:, 1]) * (2, 2, 1)
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def _cube(u: Array) -> Array:
    x = 2 * u - 1
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def _cone(u: Array) -> Array:
    return directions(1 - (1 - np.cos(np.pi / 6)) * u[:, 0], u[:, 1])


ALPHA = 0.5


def _ggx(x: Array) -> Array:
    return x[:, 2] * ALPHA**2 / (np.pi * (x[:, 2] ** 2 * (ALPHA**2 - 1) + 1) ** 2)


def _ggx_no_root(u: Array) -> Array:
    return directions((1 - u[:, 0]) / (1 + (ALPHA**2 - 1) * u[:, 0]), u[:, 1])


def _acos_near_one(u: Array) -> Array:
    mu = np.float64(1.0) + np.log1p(-u[:, 0]) * 1e-13  # kappa = 1e13 by the cosine
    return directions(np.cos(np.arccos(mu)), u[:, 1])


def _fisher(x: Array) -> Array:
    versine = (x[:, 0] ** 2 + x[:, 1] ** 2) / (1 + np.abs(x[:, 2]))
    return np.where(x[:, 2] > 0, np.exp(-versine * 1e13) * 1e13 / (2 * np.pi), 0.0)


def bugs() -> list[Bug]:
    """Return them."""
    return [
        sampler_bug(
            "guard g < eps makes negative g isotropic", "mitsuba3#455", _negative_g, hg(-0.5)[1], ("uniform law",)
        ),
        sampler_bug(
            "g of the other sign in the sampler", "pbr-book-website#11", hg(-0.7)[0], hg(0.7)[1], ("sign convention",)
        ),
        sampler_bug(
            "flipped in sampler and pdf",
            "pbr-book-website#11",
            hg(-0.7)[0],
            hg(-0.7)[1],
            ("sign convention",),
            options={"dimensions": 2, "axis": (0, 0, 1), "mean_cosine": 0.7},
        ),
        sampler_bug(
            "table sampled at mu, looked up at -mu",
            "mitsuba3#134",
            _tabulated,
            lambda x: hg(0.6)[1](-x),
            ("sign convention",),
        ),
        sampler_bug(
            "uniform directions, phase over pdf forgotten",
            "UnrealEngineSkyAtmosphere#11",
            _unweighted,
            even,
            ("wrong weight",),
            options={"dimensions": 2, "eval": hg(0.8)[1], "albedo": 1.0},
        ),
        sampler_bug(
            "mixture returns the pdf of one lobe",
            "mitsuba3#1681",
            _one_lobe,
            _blend,
            ("wrong pdf returned",),
            options={"dimensions": 3},
        ),
        sampler_bug(
            "frame not rotated", "SKIRT9#71", hg(0.6)[0], lambda x: hg(0.6)[1](x @ TILTED.T), ("rotated frame",)
        ),
        sampler_bug(
            "cosines at the nodes of a table", "openmc_fusion_benchmarks#2", _nodes, even, ("coarse numbers", "atom")
        ),
        sampler_bug(
            "1 + g^2 - s^2 cancels in single precision",
            "mitsuba3#455",
            _float32_small_g,
            even,
            ("cancellation",),
            options={"dimensions": 2, "precision": "float32"},
        ),
        sampler_bug("another medium's g", "simpa#139", hg(0.7)[0], hg(0.9)[1], ("another parameter",)),
        sampler_bug("z rebuilt from x and y as a root", "mcx#38", _no_sign, hg(-0.5)[1], ("lost sign",)),
        sampler_bug("acos of an angle", "openmc#3427", _acos_twice, even, ("outside the domain", "not a number")),
        sampler_bug(
            "branches of the transverse basis exchanged", "mcdc#470", _bad_basis, hg(0.8)[1], ("outside the domain",)
        ),
        sampler_bug(
            "Lambert by points in a ball",
            "raytracing.github.io#145",
            _lambert_ball,
            COS,
            ("wrong power",),
            options={"dimensions": 3},
            **HALF,
        ),
        sampler_bug(
            "cosine lobe with x and y twice as long", "TheRestOfYourLife#8", _doubled, COS, ("stretched",), **HALF
        ),
        sampler_bug(
            "uniform where the pdf is cosine-weighted",
            "field",
            lambda u: directions(u[:, 0], u[:, 1]),
            COS,
            ("wrong power", "uniform law"),
            **HALF,
        ),
        sampler_bug(
            "points of a cube, normalised", "ArborX#698", _cube, even, ("normalised cube",), options={"dimensions": 3}
        ),
        sampler_bug(
            "cone's pdf not 0 outside",
            "pbrt-v3#319",
            _cone,
            lambda x: np.full(len(x), 0.5 / np.pi / (1 - np.cos(np.pi / 6))),
            ("pdf outside the support",),
        ),
        sampler_bug(
            "square root of the half vector's cosine missing",
            "ChameleonRT#22",
            _ggx_no_root,
            _ggx,
            ("missing square root",),
            **HALF,
        ),
        sampler_bug("acos near 1 in a very narrow lobe", "numpy#17378", _acos_near_one, _fisher, ("coarse numbers",)),
        sampler_bug(
            "theta uniform: the sine is missing",
            "field",
            lambda u: directions(np.cos(np.pi * u[:, 0]), u[:, 1]),
            even,
            ("missing Jacobian",),
        ),
        sampler_bug(
            "y and z exchanged",
            "field",
            lambda u: hg(0.5)[0](u)[:, [0, 2, 1]],
            hg(0.5)[1],
            ("swapped axes", "rotated frame"),
        ),
        sampler_bug(
            "1/(4 pi) forgotten",
            "field",
            lambda u: directions(2 * u[:, 0] - 1, u[:, 1]),
            lambda x: np.ones(len(x)),
            ("wrong measure",),
        ),
        sampler_bug(
            "Schlick's approximation sampled for Henyey-Greenstein",
            "field",
            lambda u: directions((2 * u[:, 0] + 0.744 - 1) / (1 + 0.744 * (2 * u[:, 0] - 1)), u[:, 1]),
            hg(0.5)[1],
            ("another law",),
        ),
    ]
