"""Bugs of phase functions, lobes and frames."""

from __future__ import annotations

import numpy as np

from field_bugs.bug import Bug, directions, even, frame, hg, hg_cosine
from fogproof import Draw, UnitHemisphere

TILTED = frame((0.6, -0.3, 0.7))
COS = lambda x: x[:, 2] / np.pi  # noqa: E731
HALF = {"domain": UnitHemisphere()}


def _negative_g(u):
    return directions(2 * u[:, 0] - 1, u[:, 1])


def _tabulated(u):
    x = hg(0.6)[0](u)
    return Draw(x, pdf=hg(0.6)[1](x))


def _one_lobe(u):
    forward = u[:, 2] < 0.5
    x = np.where(forward[:, None], hg(0.8)[0](u), hg(-0.3)[0](u))
    return Draw(x, pdf=np.where(forward, hg(0.8)[1](x), hg(-0.3)[1](x)))


def _blend(x):
    return 0.5 * hg(0.8)[1](x) + 0.5 * hg(-0.3)[1](x)


def _unweighted(u):
    return Draw(directions(2 * u[:, 0] - 1, u[:, 1]), weight=np.ones(len(u)))


def _nodes(u):
    return directions(-1 + 0.1 * np.minimum(np.floor(21 * u[:, 0]), 20), u[:, 1])


def _float32_small_g(u):
    g, one = u.dtype.type(1e-6), u.dtype.type(1)
    s = (one - g * g) / (one - g + 2 * g * u[:, 0])
    return directions(np.clip((one + g * g - s * s) / (2 * g), -1, 1), u[:, 1]).astype(u.dtype)


def _no_sign(u):
    x = hg(-0.5)[0](u)
    return np.stack([x[:, 0], x[:, 1], np.sqrt(np.maximum(1 - x[:, 0] ** 2 - x[:, 1] ** 2, 0))], axis=-1)


def _acos_twice(u):
    with np.errstate(invalid="ignore"):
        theta = np.arccos(-0.2 + 1.6 * u[:, 0])
    return directions(np.cos(theta), u[:, 1])


def _bad_basis(u):
    local = hg(0.8)[0](u)
    w = np.array([0.1, 0.2, np.sqrt(1 - 0.05)])
    polar = np.array([[1.0, 0, 0], [0, 1.0, 0], [0, 0, np.sign(w[2])]])
    polar[2] = w  # two rows of one frame, the third of another
    return local @ polar


def _lambert_ball(u):
    inside = directions(2 * u[:, 0] - 1, u[:, 1]) * np.cbrt(u[:, 2:])
    x = inside + np.array([0, 0, 1])
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def _doubled(u):
    x = directions(np.sqrt(1 - u[:, 0]), u[:, 1]) * (2, 2, 1)
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def _cube(u):
    x = 2 * u - 1
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def _cone(u):
    return directions(1 - (1 - np.cos(np.pi / 6)) * u[:, 0], u[:, 1])


ALPHA = 0.5


def _ggx(x):
    return x[:, 2] * ALPHA**2 / (np.pi * (x[:, 2] ** 2 * (ALPHA**2 - 1) + 1) ** 2)


def _ggx_no_root(u):
    return directions((1 - u[:, 0]) / (1 + (ALPHA**2 - 1) * u[:, 0]), u[:, 1])


def _acos_near_one(u):
    mu = np.float64(1.0) + np.log1p(-u[:, 0]) * 1e-13  # kappa = 1e13 by the cosine
    return directions(np.cos(np.arccos(mu)), u[:, 1])


def _fisher(x):
    versine = (x[:, 0] ** 2 + x[:, 1] ** 2) / (1 + np.abs(x[:, 2]))
    return np.where(x[:, 2] > 0, np.exp(-versine * 1e13) * 1e13 / (2 * np.pi), 0.0)


BUGS = [
    Bug("guard g < eps makes negative g isotropic", "mitsuba3#455", _negative_g, hg(-0.5)[1], ("uniform law",)),
    Bug("g of the other sign in the sampler", "pbr-book-website#11", hg(-0.7)[0], hg(0.7)[1], ("sign convention",)),
    Bug(
        "flipped in sampler and pdf",
        "pbr-book-website#11",
        hg(-0.7)[0],
        hg(-0.7)[1],
        ("sign convention",),
        options={"dimensions": 2, "axis": (0, 0, 1), "mean_cosine": 0.7},
    ),
    Bug(
        "table sampled at mu, looked up at -mu",
        "mitsuba3#134",
        _tabulated,
        lambda x: hg(0.6)[1](-x),
        ("sign convention",),
    ),
    Bug(
        "uniform directions, phase over pdf forgotten",
        "UnrealEngineSkyAtmosphere#11",
        _unweighted,
        even,
        ("wrong weight",),
        options={"dimensions": 2, "eval": hg(0.8)[1], "albedo": 1.0},
    ),
    Bug(
        "mixture returns the pdf of one lobe",
        "mitsuba3#1681",
        _one_lobe,
        _blend,
        ("wrong pdf returned",),
        options={"dimensions": 3},
    ),
    Bug("frame not rotated", "SKIRT9#71", hg(0.6)[0], lambda x: hg(0.6)[1](x @ TILTED.T), ("rotated frame",)),
    Bug("cosines at the nodes of a table", "openmc_fusion_benchmarks#2", _nodes, even, ("coarse numbers", "atom")),
    Bug(
        "1 + g^2 - s^2 cancels in single precision",
        "mitsuba3#455",
        _float32_small_g,
        even,
        ("cancellation",),
        options={"dimensions": 2, "precision": "float32"},
    ),
    Bug("another medium's g", "simpa#139", hg(0.7)[0], hg(0.9)[1], ("another parameter",)),
    Bug("z rebuilt from x and y as a root", "mcx#38", _no_sign, hg(-0.5)[1], ("lost sign",)),
    Bug("acos of an angle", "openmc#3427", _acos_twice, even, ("outside the domain", "not a number")),
    Bug("branches of the transverse basis exchanged", "mcdc#470", _bad_basis, hg(0.8)[1], ("outside the domain",)),
    Bug(
        "Lambert by points in a ball",
        "field: normal + random_in_unit_sphere",
        _lambert_ball,
        COS,
        ("wrong power",),
        options={"dimensions": 3},
        **HALF,
    ),
    Bug("cosine lobe with x and y twice as long", "field: 2 cos(phi) sqrt(u)", _doubled, COS, ("stretched",), **HALF),
    Bug(
        "uniform where the pdf is cosine-weighted",
        "field",
        lambda u: directions(u[:, 0], u[:, 1]),
        COS,
        ("wrong power", "uniform law"),
        **HALF,
    ),
    Bug("points of a cube, normalised", "ArborX#698", _cube, even, ("normalised cube",), options={"dimensions": 3}),
    Bug(
        "cone's pdf not 0 outside",
        "pbrt-v3#319",
        _cone,
        lambda x: np.full(len(x), 0.5 / np.pi / (1 - np.cos(np.pi / 6))),
        ("pdf outside the support",),
    ),
    Bug(
        "square root of the half vector's cosine missing",
        "ChameleonRT#22",
        _ggx_no_root,
        _ggx,
        ("missing square root",),
        **HALF,
    ),
    Bug("acos near 1 in a very narrow lobe", "numpy#17378", _acos_near_one, _fisher, ("coarse numbers",)),
    Bug(
        "theta uniform: the sine is missing",
        "field",
        lambda u: directions(np.cos(np.pi * u[:, 0]), u[:, 1]),
        even,
        ("missing Jacobian",),
    ),
    Bug(
        "y and z exchanged",
        "field",
        lambda u: hg(0.5)[0](u)[:, [0, 2, 1]],
        hg(0.5)[1],
        ("swapped axes", "rotated frame"),
    ),
    Bug(
        "1/(4 pi) forgotten",
        "field",
        lambda u: directions(2 * u[:, 0] - 1, u[:, 1]),
        lambda x: np.ones(len(x)),
        ("wrong measure",),
    ),
    Bug(
        "Schlick's approximation sampled for Henyey-Greenstein",
        "field",
        lambda u: directions((2 * u[:, 0] + 0.744 - 1) / (1 + 0.744 * (2 * u[:, 0] - 1)), u[:, 1]),
        hg(0.5)[1],
        ("another law",),
    ),
]

assert hg_cosine(0.5, np.array([1.0]))[0] == 1.0
