"""Emitters and lobes as renderers sample them: densities of solid angle that are cut off along curves."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.outsiders.subjects import Outsider, case
from fogproof.domains import UnitHemisphere, UnitSphere

Vector = tuple[float, float, float]
_TURN = 2 * np.pi


def frame(axis: Vector) -> np.ndarray:
    """Return rows (t1, t2, axis) of an orthonormal frame (Duff et al. 2017 in spirit: any frame will do)."""
    n = np.asarray(axis) / np.linalg.norm(axis)
    first = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    first /= np.linalg.norm(first)
    return np.stack([first, np.cross(n, first), n])


def turned(versine: np.ndarray, share: np.ndarray, rows: np.ndarray) -> np.ndarray:
    """Return (n, 3) directions at 1 - cos = versine from the last row of a frame."""
    s = np.sqrt(np.maximum(versine * (2 - versine), 0.0))
    return np.stack([s * np.cos(_TURN * share), s * np.sin(_TURN * share), 1 - versine], axis=-1) @ rows


def cone(axis: Vector, degrees: float) -> Outsider:
    """Return the uniform law on a cone: a spherical light, the sun (Shirley, Wang & Zimmerman 1996)."""
    rows, highest = frame(axis), 2 * np.sin(np.radians(degrees) / 2) ** 2
    value = 1 / (_TURN * highest)

    def pdf(x: np.ndarray) -> np.ndarray:
        return np.where(((x - rows[2]) ** 2).sum(axis=1) / 2 <= highest * (1 + 1e-9), value, 0.0)

    return Outsider(lambda u: turned(highest * u[:, 0], u[:, 1], rows), pdf, UnitSphere(), 2)


def polygon(corner: Vector, first: Vector, second: Vector, half: bool) -> Outsider:
    """Return a parallelogram, or its half, a triangle, sampled by area and seen from the origin: pdf = r^2 / (A cos)."""
    a, e, f = (np.asarray(v, dtype=float) for v in (corner, first, second))
    normal = np.cross(e, f)
    area = float(np.linalg.norm(normal))
    normal /= area
    inverse = np.linalg.pinv(np.stack([e, f]))
    area *= 0.5 if half else 1.0

    def sample(u: np.ndarray) -> np.ndarray:
        if half:
            root = np.sqrt(u[:, :1])
            u = np.concatenate([root * (1 - u[:, 1:]), root * u[:, 1:]], axis=1)
        y = a + u[:, :1] * e + u[:, 1:] * f
        return y / np.linalg.norm(y, axis=1)[:, None]

    def pdf(x: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            r = (a @ normal) / (x @ normal)
            s = (r[:, None] * x - a) @ inverse
            on = (r > 0) & np.all((s >= -1e-12) & (s <= 1 + 1e-12), axis=1)
            on &= (s.sum(axis=1) <= 1 + 1e-12) | (not half)
            return np.where(on, r * r / (area * np.abs(x @ normal)), 0.0)

    return Outsider(sample, pdf, UnitSphere(), 2)


def disk_light(center: Vector, normal: Vector, radius: float) -> Outsider:
    """Return a disk sampled by area and seen from the origin."""
    rows, c = frame(normal), np.asarray(center, dtype=float)

    def sample(u: np.ndarray) -> np.ndarray:
        r, phi = radius * np.sqrt(u[:, 0]), _TURN * u[:, 1]
        y = c + (r * np.cos(phi))[:, None] * rows[0] + (r * np.sin(phi))[:, None] * rows[1]
        return y / np.linalg.norm(y, axis=1)[:, None]

    def pdf(x: np.ndarray) -> np.ndarray:
        with np.errstate(all="ignore"):
            t = (c @ rows[2]) / (x @ rows[2])
            off = ((t[:, None] * x - c) ** 2).sum(axis=1)
            on = (t > 0) & (off <= radius**2 * (1 + 1e-9))
            return np.where(on, t * t / (np.pi * radius**2 * np.abs(x @ rows[2])), 0.0)

    return Outsider(sample, pdf, UnitSphere(), 2)


def cosine_lobe(axis: Vector, exponent: float) -> Outsider:
    """Return a Phong lobe, cos^n about a tilted axis, nothing below its horizon (Lafortune & Willems 1994)."""
    rows = frame(axis)

    def pdf(x: np.ndarray) -> np.ndarray:
        c = np.maximum(x @ rows[2], 0.0)
        return (exponent + 1) / _TURN * c**exponent

    sample = lambda u: turned(1 - (1 - u[:, 0]) ** (1 / (exponent + 1)), u[:, 1], rows)  # noqa: E731
    return Outsider(sample, pdf, UnitSphere(), 2)


def lobes(count: int, kappa: float) -> Outsider:
    """Return a mixture of equal von Mises-Fisher lobes about spread axes, their sampler as Jakob's (2012)."""
    share = (np.arange(count) * 0.6180339887498949) % 1.0
    rows = np.stack([frame(tuple(d)) for d in turned(2 * (np.arange(count) + 0.5) / count, share, np.eye(3))])

    def sample(u: np.ndarray) -> np.ndarray:
        which = np.minimum((u[:, 0] * count).astype(int), count - 1)
        versine = -np.log(u[:, 1] + (1 - u[:, 1]) * np.exp(-2 * kappa) + 1e-300) / kappa
        local = turned(np.clip(versine, 0, 2), u[:, 2], np.eye(3))
        return np.einsum("ni,nij->nj", local, rows[which])

    def pdf(x: np.ndarray) -> np.ndarray:
        total = np.zeros(len(x))
        for row in rows:
            away = x - row[2]
            total += np.exp(-kappa * np.einsum("ni,ni->n", away, away) / 2)
        return total * kappa / (_TURN * -np.expm1(-2 * kappa)) / count

    return Outsider(sample, pdf, UnitSphere(), 3)


def band(low: float, high: float) -> Outsider:
    """Return the uniform law on the directions with low < z < high."""
    value = 1 / (_TURN * (high - low))

    def pdf(x: np.ndarray) -> np.ndarray:
        return np.where((x[:, 2] >= low - 1e-15) & (x[:, 2] <= high + 1e-15), value, 0.0)

    sample = lambda u: turned(1 - low - (high - low) * u[:, 0], u[:, 1], np.eye(3))  # noqa: E731
    return Outsider(sample, pdf, UnitSphere(), 2)


def mirror(share: float) -> Outsider:
    """Return a rough coat over a mirror: a cosine lobe and, with the given probability, one direction alone."""
    direction = (0.6, 0.0, 0.8)

    def sample(u: np.ndarray) -> np.ndarray:
        lobe = turned(1 - np.sqrt(1 - u[:, 0]), u[:, 1], np.eye(3))
        return np.where(u[:, 2:] < share, np.array(direction), lobe)

    pdf = lambda x: (1 - share) * np.maximum(x[:, 2], 0.0) / np.pi  # noqa: E731
    return Outsider(sample, pdf, UnitHemisphere(), 3, {direction: share})


AXES: tuple[Vector, ...] = ((0.3, -0.5, 0.6), (-0.7, 0.1, -0.2), (0.0, 0.0, 1.0))


def cases() -> list[SamplerCase]:
    """Return the lights and lobes."""
    found: list[SamplerCase] = []

    def add(name: str, title: str, make: Callable[[], Outsider], source: str, default: bool = False) -> None:
        found.append(case(f"lights/{name}", title, make, source, by_name=not default))

    shirley = "Shirley, Wang & Zimmerman 1996"
    for number, axis in enumerate(AXES):
        for degrees in (0.05, 0.2665, 1.2, 8.0, 60.0):
            name, title = f"cone/{degrees:g}/{number}", f"Cone of {degrees:g} degrees about {axis}"
            add(name, title, partial(cone, axis, degrees), shirley, (degrees, number) == (0.2665, 0))
    squares: tuple[tuple[str, Vector, Vector, Vector], ...] = (
        ("large", (-1.0, -1.0, 1.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0)),
        ("oblique", (1.0, 2.0, -2.0), (0.4, 0.0, 0.3), (0.0, 0.5, 0.1)),
        ("far", (3.0, -4.0, 1.0), (0.02, 0.0, 0.0), (0.0, 0.0, 0.03)),
        ("grazing", (-0.5, 1.0, 0.02), (1.0, 0.0, 0.0), (0.0, 3.0, 0.0)),
    )
    for name, corner, first, second in squares:
        for half, kind in ((False, "parallelogram"), (True, "triangle")):
            make = partial(polygon, corner, first, second, half)
            add(f"{kind}/{name}", f"{kind.capitalize()} light, {name}", make, shirley, name == "oblique")
    add("disk", "Disk light", partial(disk_light, (0.4, -0.3, 2.0), (0.2, 0.1, -1.0), 0.3), shirley, True)
    for exponent in (1.0, 50.0, 1e4):
        lobe = partial(cosine_lobe, AXES[1], exponent)
        add(f"phong/{exponent:g}", f"Phong lobe, n = {exponent:g}, tilted", lobe, "Lafortune & Willems 1994")
    for count, kappa in ((5, 10.0), (50, 2000.0), (20, 1e5)):
        make = partial(lobes, count, kappa)
        add(f"lobes/{count}", f"{count} lobes, kappa = {kappa:g}", make, "Jakob 2012", count == 50)
    for low, high in ((-0.3, 0.1), (0.6, 0.601), (-1.0, -0.9)):
        add(f"band/{low:g}", f"Band of z from {low:g} to {high:g}", partial(band, low, high), shirley)
    add(
        "mirror",
        "Mirror under a rough coat: an atom on the hemisphere",
        partial(mirror, 0.3),
        "Walter et al. 2007",
        True,
    )
    return found
