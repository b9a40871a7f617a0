"""Colours of sun and sky: sums over the spectrum in many digits, the tables of observer and daylight as colour-science has them."""

from __future__ import annotations

from functools import cache

import mpmath as mp

from fogproof import analytic
from hard.case import Kind, number
from hard.lit_scenes import air_truth


@cache
def tables():
    """Return wavelengths in nm, the observer's three functions times daylight, (421, 3), and the brightness of daylight."""
    import colour

    shape = colour.SpectralShape(360, 780, 1)
    observer = colour.MSDS_CMFS["CIE 1931 2 Degree Standard Observer"].copy().align(shape).values
    daylight = colour.SDS_ILLUMINANTS["D65"].copy().align(shape).values
    with mp.workdps(40):
        rows = [[mp.mpf(float(x)) * mp.mpf(float(s)) for x in row] for row, s in zip(observer, daylight, strict=True)]
        return list(range(360, 781)), rows, mp.fsum(row[1] for row in rows)


@cache
def depths():
    """Return the optical depth of the air at each of the wavelengths, which are numbers in double precision."""
    with mp.workdps(40):
        return [air_truth(float(nm * 1e-9), column=True) for nm in tables()[0]]


def colour_of(spectrum, channel):
    """Return X, Y or Z of daylight times a spectrum of the optical depth."""
    _, rows, brightness = tables()
    return mp.fsum(row[channel] * spectrum(tau) for row, tau in zip(rows, depths(), strict=True)) / brightness


def one(found, channel):
    """Return a channel of a reference."""
    return type(found)(found.value[channel], found.error[channel], found.method, found.source)


def sun(rng):
    """Direct sunlight after as many atmospheres, thin air to none left of the blue."""
    mass, channel = (
        float(rng.choice([0.0, number(rng, 1e-9, 1e4), float(rng.uniform(1, 40))], p=[0.05, 0.35, 0.6])),
        int(rng.integers(3)),
    )
    with mp.workdps(40):
        truth = colour_of(lambda tau: mp.exp(-mp.mpf(mass) * tau), channel)
    return lambda: one(analytic.sun_colour(mass), channel), truth, 0, f"{mass} {channel}"


def sky(rng):
    """The clear sky by light scattered once."""
    sun, view, azimuth = number(rng, 1e-3, 1), number(rng, 1e-3, 1), float(rng.uniform(0, 6))
    channel = int(rng.integers(3))
    with mp.workdps(40):
        s, v, phi = map(mp.mpf, (sun, view, azimuth))
        cosine = s * v + mp.sqrt(1 - s * s) * mp.sqrt(1 - v * v) * mp.cos(phi)
        phase = 3 * (1 + cosine**2) / (16 * mp.pi)

        def way(t):
            return s / (s - v) * (mp.exp(-t / s) - mp.exp(-t / v)) if s != v else t / v * mp.exp(-t / v)

        truth = phase * colour_of(way, channel)
    return lambda: one(analytic.sky_colour(sun, view, azimuth), channel), truth, 0, f"{sun} {view} {azimuth} {channel}"


KINDS = {"sun_colour": Kind(sun, 2), "sky_colour": Kind(sky, 2)}
