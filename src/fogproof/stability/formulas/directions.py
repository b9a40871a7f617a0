"""Directions about an axis, beside the pole where frames divide by nothing."""

from __future__ import annotations

import numpy as np

from fogproof.estimators.airlight.around import around as towards
from fogproof.estimators.phase.frames import turn
from fogproof.stability.axes import decades, including
from fogproof.stability.exact import flint
from fogproof.stability.formula import Formula, HardRegion, Naive


def axes_near_the_pole(off, versine):
    """Axes beside -z, as far off it as rounding lets a unit vector be."""
    return {"ax": off, "az": -np.sqrt(1 - off * off), "versine": versine}


def length_by(frame):
    def measured(ax, az, versine):
        w = frame(ax, az, versine).astype(np.longdouble)
        return np.sqrt(np.sum(w * w, axis=0)).astype(float)

    return measured


def by_reflection(ax, az, versine):
    found = np.empty((len(ax), 3))
    for i in range(len(ax)):
        axis = (float(ax[i]), 0.0, float(az[i]))
        one = slice(i, i + 1)
        turn(axis, versine[one].copy(), 2 - versine[one], np.array([0.3]), out=found[one])
    return found.T


def by_duff(ax, az, versine):
    axis = np.stack([ax, np.zeros_like(ax), az])
    return towards(axis, versine, np.full_like(ax, 0.6 * np.pi))


def by_frisvad(ax, az, versine):
    a = 1 / (1 + az)
    first = np.stack([1 - ax * ax * a, np.zeros_like(ax), -ax])
    second = np.stack([np.zeros_like(ax), np.ones_like(ax), np.zeros_like(ax)])
    sine, phi = np.sqrt(versine * (2 - versine)), 0.6 * np.pi
    axis = np.stack([ax, np.zeros_like(ax), az])
    return sine * np.cos(phi) * first + sine * np.sin(phi) * second + (1 - versine) * axis


def true_length(ax, az, versine):
    """Turned by a rotation, a unit vector keeps the length of the axis, but for the part across."""
    return flint().arb(1)


POLES = (
    HardRegion(
        "axes beside -z",
        {"off": including(decades(1e-16, 0.9), 0.0), "versine": including(decades(1e-12, 1.0), 0.0)},
        derived=axes_near_the_pole,
    ),
)
FRISVAD = Naive("a frame divided by 1 + z", "Frisvad 2012, before Duff et al. 2017", length_by(by_frisvad))
FORMULAS = [
    Formula(
        "geometry/direction_length",
        "Length of a direction turned about an axis by a reflection",
        "estimators.Directions",
        length_by(by_reflection),
        true_length,
        POLES,
        bound=5.0,
        naive=(FRISVAD,),
    ),
    Formula(
        "geometry/towards_length",
        "Length of a direction to a light about an axis",
        "estimators.LitMedium",
        length_by(by_duff),
        true_length,
        POLES,
        bound=2.0,
        naive=(FRISVAD,),
    ),
]
