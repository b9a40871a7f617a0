"""Direction samplers against the oracle's phase functions."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fogproof.analytic import phase_cdf, phase_mean_cosine, phase_pdf
from fogproof.catalogue.cases import Altered, Case, Drawn, EstimatorCase, SamplerCase, Twin
from fogproof.contracts import Draw, Reference
from fogproof.estimators import Directions, phase_table
from fogproof.scene import (
    CornetteShanks,
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Mie,
    Mixture,
    Murky,
    PhaseFunction,
    Rayleigh,
    Schlick,
    Tabulated,
)

Axis = tuple[float, float, float]

POLE: Axis = (0.0, 0.0, 1.0)
TILTED: Axis = (2 / 7, -3 / 7, 6 / 7)
NEARLY_DOWN: Axis = (6e-9, -8e-9, -1.0)

TABLE = Tabulated.normalised(
    (-1.0, -0.8, -0.5, -0.1, 0.0, 0.3, 0.7, 0.9, 0.97, 1.0), (2.0, 0.5, 0.2, 0.0, 0.0, 0.3, 0.4, 3.0, 11.0, 25.0)
)
"""Backscatter, a gap of density 0 and a forward peak."""

NESTED = Mixture((Murky(), Mixture((HenyeyGreenstein(0.85), Schlick(-0.6)), (0.6, 0.4)), Rayleigh()), (0.25, 0.65, 0.1))

DROPLET = Mie(1.2e-6, 550e-9, 1.333)
"""A water droplet of size parameter 6.9."""


def oracle_pdf(phase: PhaseFunction, axis: Axis, rounding: float = 2e-15) -> Callable[[np.ndarray], Reference]:
    """Return x (n, 3) -> the oracle's density of directions about `axis` [1/sr].

    A direction in floating point fixes its cosine only to a few roundings: what that changes is part of the error.
    """

    def reference(x: np.ndarray) -> Reference:
        mu = x @ np.asarray(axis)
        below, at, above = (phase_pdf(phase, np.clip(mu + shift, -1, 1)) for shift in (-rounding, 0, rounding))
        with np.errstate(invalid="ignore"):  # where it is infinite straight ahead
            spread = np.maximum(np.abs(below.value - at.value), np.abs(above.value - at.value))
        return Reference(at.value, at.error + np.nan_to_num(spread, nan=np.inf), at.method, at.source)

    return reference


def rosenblatt(phase: PhaseFunction, axis: Axis) -> Callable[[np.ndarray], np.ndarray]:
    """Return x (n, 3) -> (n, 2): the oracle's distribution of the cosine to `axis`, and the azimuth over 2 pi.

    For densities whose kinks would blur a quadrature over cells.
    """
    across = np.cross(axis, (1.0, 0.0, 0.0))
    first = across / np.linalg.norm(across)
    second = np.cross(axis, first)

    def cdf(x: np.ndarray) -> np.ndarray:
        mu = np.clip(x @ np.asarray(axis), -1, 1)
        return np.stack([phase_cdf(phase, mu).value, np.arctan2(x @ second, x @ first) / (2 * np.pi) % 1], axis=-1)

    return cdf


def direction_case(
    name: str,
    title: str,
    phase: PhaseFunction,
    mean: float,
    make: Callable[[], Any],
    twin: Twin,
    source: str,
    **more: Any,
) -> SamplerCase:
    """Return the case of a direction sampler: its pdf is the oracle's, and forward means forward."""
    axis = more.pop("axis", POLE)
    options = {"axis": axis, "mean_cosine": mean, **more.pop("options", {})}
    reference = oracle_pdf(phase, axis, 1e-6 if options.get("precision") == "float32" else 2e-15)
    return SamplerCase(
        name=name,
        title=title,
        make=make,
        reference=reference,
        oracle="phase_pdf",
        source=source,
        twin=twin,
        options=options,
        **more,
    )


def _case(
    name: str,
    title: str,
    phase: PhaseFunction,
    source: str,
    error: str,
    sample: Any = None,
    pdf: Any = None,
    *,
    axis: Axis = POLE,
    twin: Callable[[], Any] | None = None,
    **options: Any,
) -> SamplerCase:
    """Return the case of `Directions(phase, axis)`; `options` are of `check_sampler`.

    The twin is the subject with `sample` or `pdf` replaced, unless `twin` makes another.
    """

    def make() -> Directions:
        return Directions(phase, axis)

    tilt = {TILTED: ", about a tilted axis", NEARLY_DOWN: ", about an axis 1e-8 from -z"}.get(axis, "")
    broken = Twin(error, twin or (lambda: Altered(make(), sample, pdf)))
    mean = float(phase_mean_cosine(phase).value)
    return direction_case(
        f"directions/{name}", title + tilt, phase, mean, make, broken, source, axis=axis, options=options
    )


def _henyey_greenstein(
    g: float, axis: Axis, error: str, sample: Any = None, pdf: Any = None, **more: Any
) -> SamplerCase:
    title = f"Henyey-Greenstein directions, g = {g:g}"
    phase = HenyeyGreenstein(g)
    source = "Henyey & Greenstein 1941"
    return _case(f"henyey-greenstein/g={g:g}", title, phase, source, error, sample, pdf, axis=axis, **more)


def _from(phase: PhaseFunction) -> Callable[[Directions, np.ndarray], np.ndarray]:
    """Return a sampler of another phase function about the same axis."""
    return lambda sampler, u: Directions(phase, sampler.axis).sample(u).x


def _about_z(cosine: np.ndarray, u_phi: np.ndarray) -> np.ndarray:
    sine, phi = np.sqrt(np.maximum(1 - cosine * cosine, 0)), 2 * np.pi * u_phi
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), cosine], axis=-1)


def _uniform_in_angle(sampler: Directions, u: np.ndarray) -> np.ndarray:
    return _about_z(np.cos(np.pi * u[:, 0]), u[:, 1])


def _textbook(sampler: Directions, u: np.ndarray) -> np.ndarray:
    assert isinstance(sampler.phase, HenyeyGreenstein)
    g = sampler.phase.g
    s = (1 - g * g) / (1 - g + 2 * g * u[:, 0])
    return _about_z(np.clip((1 + g * g - s * s) / (2 * g), -1, 1), u[:, 1])


def _power_one(sampler: Directions, x: np.ndarray) -> np.ndarray:
    assert isinstance(sampler.phase, HenyeyGreenstein)
    g = sampler.phase.g
    return (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * x[:, 2]))


def _density_of_cosine(sampler: Directions, u: np.ndarray) -> Draw:
    draw = sampler.sample(u)
    assert draw.pdf is not None
    return Draw(draw.x, 2 * np.pi * draw.pdf)


def _unrotated(sampler: Directions, u: np.ndarray) -> np.ndarray:
    return Directions(sampler.phase).sample(u).x


def _without_peak(sampler: Directions, u: np.ndarray) -> np.ndarray:
    squeezed = u.copy()
    squeezed[:, 0] = 0.02 + 0.98 * u[:, 0]
    return sampler.sample(squeezed).x


def _sign_of_z_lost(sampler: Directions, u: np.ndarray) -> np.ndarray:
    x = sampler.sample(u).x
    x[:, 2] = np.sqrt(np.maximum(1 - x[:, 0] ** 2 - x[:, 1] ** 2, 0))
    return x


def _unguarded_basis(sampler: Directions, u: np.ndarray) -> np.ndarray:
    """The frame of an axis away from the pole, 1/sqrt(1 - z^2), used at the pole, with z in double precision."""
    x, y, z = sampler.axis
    local = Directions(sampler.phase).sample(u).x
    s = np.sqrt(1 - z * z)
    with np.errstate(all="ignore"):
        t1, t2 = np.array([x * z, y * z, -s * s]) / np.float64(s), np.array([-y, x, 0]) / np.float64(s)
        return local @ np.stack([t1, t2, np.array([x, y, z])])


def _printed(constant: float, power: int) -> Callable[[Directions, np.ndarray], np.ndarray]:
    return lambda sampler, x: (constant + ((1 + x[:, 2]) / 2) ** power) / (4 * np.pi)


def _component_pdf(sampler: Directions, u: np.ndarray) -> Draw:
    """The density of the chosen lobe only, as if there were no other."""
    phase = sampler.phase
    assert isinstance(phase, DoubleHenyeyGreenstein)
    draw = sampler.sample(u)
    lobes = [Directions(HenyeyGreenstein(g), sampler.axis).pdf(draw.x) for g in (phase.g1, phase.g2)]
    return Draw(draw.x, np.where(u[:, 0] < phase.weight, *lobes))


def _unweighted_component(sampler: Directions, x: np.ndarray) -> np.ndarray:
    assert isinstance(sampler.phase, Mixture)
    first, weight = sampler.phase.components[0], sampler.phase.weights[0]
    return sampler.pdf(x) + (1 - weight) * Directions(first, sampler.axis).pdf(x)


def _normalised_as_cornette_shanks(sampler: Directions, x: np.ndarray) -> np.ndarray:
    assert isinstance(sampler.phase, Draine)
    g, alpha = sampler.phase.g, sampler.phase.alpha
    return sampler.pdf(x) * (1 + alpha * (1 + 2 * g * g) / 3) / (1 + (1 + 2 * g * g) / 3)


def _nodes_of_table(sampler: Directions, u: np.ndarray) -> np.ndarray:
    """Cosines at the nodes of the table only, each with the density there as its weight."""
    cosines, values = np.array(TABLE.cosines), np.array(TABLE.values)
    chosen = np.searchsorted(np.cumsum(values) / values.sum(), u[:, 0], side="right")
    return _about_z(cosines[chosen], u[:, 1])


def _next_cell(sampler: Directions, u: np.ndarray) -> np.ndarray:
    """The table's cell is found one too high; its place in the cell is right."""
    cosines = np.array(TABLE.cosines)
    mu = sampler.sample(u).x @ np.asarray(sampler.axis)
    i = np.clip(np.searchsorted(cosines, mu, side="right") - 1, 0, len(cosines) - 2)
    j = np.minimum(i + 1, len(cosines) - 2)
    place = (mu - cosines[i]) / (cosines[i + 1] - cosines[i])
    return _about_z(np.clip(cosines[j] + place * (cosines[j + 1] - cosines[j]), -1, 1), u[:, 1])


def _mirrored(table: Tabulated) -> Tabulated:
    return Tabulated(tuple(-c for c in reversed(table.cosines)), tuple(reversed(table.values)))


def _unweighted(sampler: Directions, u: np.ndarray) -> Draw:
    return sampler.sample(u)._replace(weight=np.ones(len(u)))


def _moments(sphere: Mie) -> Drawn:
    """Weights of sampled directions, and weights times cosines: their means are 1 and g."""

    def draw(rng: np.random.Generator, n: int) -> np.ndarray:
        directions = Directions(sphere).sample(rng.random((n, 2)))
        assert directions.weight is not None
        return np.stack([directions.weight, directions.weight * directions.x[:, 2]], axis=-1)

    return Drawn(draw)


def _one_and_g(sphere: Mie) -> Reference:
    g = phase_mean_cosine(sphere)
    return Reference(np.array([1.0, g.value]), np.array([0.0, g.error]), g.method, g.source)


def cases() -> list[Case]:
    """Return the direction cases."""
    cornette, draine, table_source = "Cornette & Shanks 1992", "Draine 2003", "piecewise linear in the cosine"
    nishita, schlick = "Nishita, Miyawaki & Nakamae 1987", "Blasi, Le Saec & Schlick 1993"
    mie, table = "Bohren & Huffman 1983", phase_table(DROPLET)
    local = "the local direction is returned without rotation"
    return [
        _case(
            "isotropic",
            "Isotropic directions",
            Isotropic(),
            "Archimedes",
            "uniform in the angle theta, not in its cosine",
            _uniform_in_angle,
        ),
        _case(
            "rayleigh",
            "Rayleigh directions",
            Rayleigh(),
            "Rayleigh 1871",
            "isotropic sampling under the Rayleigh density",
            _from(Isotropic()),
        ),
        _case("rayleigh/tilted", "Rayleigh directions", Rayleigh(), "Rayleigh 1871", local, _unrotated, axis=TILTED),
        _henyey_greenstein(-0.7, POLE, "for g < 0 the cosine is drawn uniformly", _from(Isotropic())),
        _henyey_greenstein(1e-16, POLE, "the textbook inverse that divides by 2 g", _textbook),
        _henyey_greenstein(
            0.3,
            POLE,
            "backward means forward, in sampler and density alike",
            twin=lambda: Directions(HenyeyGreenstein(-0.3)),
        ),
        _henyey_greenstein(0.6, POLE, "exponent 1 instead of 3/2 in the density", None, _power_one),
        _henyey_greenstein(0.85, TILTED, "the sampler has g = 0.83", _from(HenyeyGreenstein(0.83))),
        _henyey_greenstein(
            0.95, POLE, "the returned pdf is the density of the cosine, 2 pi too large", _density_of_cosine
        ),
        _henyey_greenstein(0.99, TILTED, local, _unrotated),
        _henyey_greenstein(-0.999, TILTED, "the peak's last 2 % are never sampled", _without_peak),
        _henyey_greenstein(
            0.5, NEARLY_DOWN, "the frame divides by sin theta, which is lost next to the pole", _unguarded_basis
        ),
        _henyey_greenstein(-0.2, TILTED, "z is rebuilt from x and y, and its sign is lost", _sign_of_z_lost),
        _case(
            "double-henyey-greenstein",
            "Two Henyey-Greenstein lobes, g = 0.8 and -0.3",
            DoubleHenyeyGreenstein(0.8, -0.3, 0.6),
            "Henyey & Greenstein 1941",
            "the pdf returned is that of the chosen lobe alone",
            _component_pdf,
            axis=TILTED,
        ),
        _case(
            "schlick",
            "Schlick directions, k = 0.7",
            Schlick(0.7),
            schlick,
            "k is taken for g, and Henyey-Greenstein sampled",
            _from(HenyeyGreenstein(0.7)),
        ),
        _case(
            "schlick/backward",
            "Schlick directions, k = -0.95",
            Schlick(-0.95),
            schlick,
            "backward means forward, in sampler and density alike",
            twin=lambda: Directions(Schlick(0.95), TILTED),
            axis=TILTED,
        ),
        _case(
            "hazy",
            "Hazy atmosphere",
            Hazy(),
            nishita,
            "the density 5 + u^8 over 4 pi, whose integral is 46/9",
            None,
            _printed(5, 8),
        ),
        _case(
            "murky",
            "Murky atmosphere",
            Murky(),
            nishita,
            "the density 17 + u^32 over 4 pi, whose integral is 562/33",
            None,
            _printed(17, 32),
        ),
        _case(
            "murky/tilted",
            "Murky atmosphere",
            Murky(),
            nishita,
            "the power of the hazy atmosphere in the sampler",
            _from(Hazy()),
            axis=TILTED,
        ),
        _case(
            "cornette-shanks",
            "Cornette-Shanks directions, g = 0.6",
            CornetteShanks(0.6),
            cornette,
            "Henyey-Greenstein sampling, whose weight is taken for 1",
            _from(HenyeyGreenstein(0.6)),
            axis=TILTED,
        ),
        _case(
            "draine",
            "Draine directions, g = -0.4, alpha = 3",
            Draine(-0.4, 3.0),
            draine,
            "the density is normalised as if alpha were 1",
            None,
            _normalised_as_cornette_shanks,
        ),
        _case(
            "draine/sharp",
            "Draine directions, g = 0.97, alpha = 0.5",
            Draine(0.97, 0.5),
            draine,
            "alpha is forgotten in the sampler",
            _from(Draine(0.97, 0.0)),
            axis=TILTED,
        ),
        _case(
            "tabulated",
            "Tabulated phase function",
            TABLE,
            table_source,
            "cosines at the nodes of the table only",
            _nodes_of_table,
        ),
        _case(
            "tabulated/cells",
            "Tabulated phase function",
            TABLE,
            table_source,
            "the index of the cell is one too high",
            _next_cell,
        ),
        _case(
            "tabulated/tilted",
            "Tabulated phase function",
            TABLE,
            table_source,
            "the table is mirrored, in sampler and density alike",
            twin=lambda: Directions(_mirrored(TABLE), TILTED),
            axis=TILTED,
        ),
        _case(
            "mixture",
            "Mixture of a mixture, Murky and Rayleigh",
            NESTED,
            "sum of weighted densities",
            "a component's density is not multiplied by its probability",
            None,
            _unweighted_component,
            axis=TILTED,
        ),
        _case(
            "float32/henyey-greenstein",
            "Henyey-Greenstein directions in single precision, g = 1e-6",
            HenyeyGreenstein(1e-6),
            "Henyey & Greenstein 1941",
            "the textbook inverse, whose digits cancel long before g = 0",
            _textbook,
            precision="float32",
        ),
        _case(
            "float32/henyey-greenstein/sharp",
            "Henyey-Greenstein directions in single precision, g = 0.98",
            HenyeyGreenstein(0.98),
            "Henyey & Greenstein 1941",
            "uniforms of 12 bits",
            lambda sampler, u: sampler.sample(np.floor(4096 * u) / 4096).x,
            axis=TILTED,
            precision="float32",
        ),
        _case(
            "float32/rayleigh",
            "Rayleigh directions in single precision",
            Rayleigh(),
            "Rayleigh 1871",
            "the azimuth is drawn once for sixty-four directions",
            lambda sampler, u: sampler.sample(np.stack([u[:, 0], np.repeat(u[::64, 1], 64)[: len(u)]], axis=-1)).x,
            precision="float32",
        ),
        _case(
            "float32/hazy",
            "Hazy atmosphere in single precision",
            Hazy(),
            nishita,
            "the power of the murky atmosphere in the sampler",
            _from(Murky()),
            axis=TILTED,
            precision="float32",
        ),
        _case(
            "float32/schlick",
            "Schlick directions in single precision, k = -0.9",
            Schlick(-0.9),
            schlick,
            "the sampler has k = -0.88",
            _from(Schlick(-0.88)),
            axis=TILTED,
            precision="float32",
        ),
        direction_case(
            "directions/lorenz-mie",
            "Lorenz-Mie directions of a water droplet, from a table with weights",
            table,
            float(phase_mean_cosine(table).value),
            lambda: Directions(DROPLET, TILTED),
            Twin("the weights are taken for 1", lambda: Altered(Directions(DROPLET, TILTED), _unweighted)),
            mie,
            axis=TILTED,
            options={"albedo": 1.0, "cdf": rosenblatt(table, TILTED)},
            samples=300_000,
        ),
        EstimatorCase(
            name="directions/lorenz-mie/mean",
            title="Lorenz-Mie directions of a water droplet: mean weight and mean cosine",
            make=lambda: _moments(DROPLET),
            reference=lambda: _one_and_g(DROPLET),
            oracle="phase_mean_cosine",
            source=mie,
            twin=Twin("the diameter is taken for the radius", lambda: _moments(Mie(2.4e-6, 550e-9, 1.333))),
            samples=300_000,
            needs="miepython",
        ),
    ]
