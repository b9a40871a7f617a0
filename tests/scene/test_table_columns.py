"""Invariant: columns as programs write them give the phase function they mean, with a sentence, or are refused by name."""

import re

import numpy as np
import pytest

from fogproof.analytic import phase_cdf, phase_mean_cosine
from fogproof.errors import InvalidValueError
from fogproof.scene import Tabulated

G = 0.6
ANGLES = np.arange(0.0, 181.0)
COSINES = np.cos(np.radians(ANGLES))
CENTRES = ANGLES[:-1] + 0.5


def lobe(mu):
    return (1 - G * G) / (1 + G * G - 2 * G * mu) ** 1.5


def _of(angles, scale=1.0):
    return angles, scale * lobe(np.cos(np.radians(angles)))


UNDERSTOOD = [
    (_of(ANGLES), "181 degrees, increasing, with both poles; .* about 4 pi"),
    (_of(ANGLES[::-1], 0.5), r"181 degrees, decreasing, with both poles; .* about 2 pi \(1 over the cosine\)"),
    ((np.radians(ANGLES), lobe(COSINES) / (4 * np.pi)), "181 radians, increasing, with both poles; .* about 1;"),
    ((COSINES, 30 * lobe(COSINES)), "181 cosines, decreasing, with both poles; values in units of their own"),
    ((COSINES[::-1], lobe(COSINES[::-1])), "181 cosines, increasing"),
    ((np.round(COSINES, 6), lobe(COSINES)), "181 cosines, decreasing, with both poles"),
    ((np.cos(np.radians(ANGLES.astype(np.float32))), lobe(COSINES)), "181 cosines, decreasing"),
    (_of(CENTRES), "180 degrees, increasing, the centres of equal cells"),
    (_of(CENTRES[::-1]), "180 degrees, decreasing, the centres of equal cells"),
]


@pytest.mark.parametrize(("columns", "message"), UNDERSTOOD, ids=[m for _, m in UNDERSTOOD])
def test_what_is_understood_is_said(columns, message):
    phase, sentence = Tabulated.from_columns(*columns)
    assert re.match(message, sentence), sentence
    mean = phase_mean_cosine(phase).value
    assert abs(float(sentence.rpartition("mean cosine ")[2]) - mean) < 1e-5
    assert abs(mean - G) < 2e-3
    half = float(phase_cdf(phase, 0.0).value)
    assert abs(half - ((1 - G * G) / (2 * G) * (1 / np.sqrt(1 + G * G) - 1 / (1 + G)))) < 1e-3


REFUSED = [
    ((ANGLES[:91], lobe(COSINES[:91])), r"places must reach from pole to pole, got \[0.0, 90.0\]; .* one hemisphere"),
    ((ANGLES[5:176], lobe(COSINES[5:176])), "places must reach from 0 to 180, or be the centres of equal cells"),
    ((np.round(COSINES, 3), lobe(COSINES)), r"places must increase or decrease all the way, got \[-1.0, -1.0\]"),
    ((np.arange(361.0), np.ones(361)), "places must be cosines or scattering angles"),
    ((np.arange(-180.0, 181.0), np.ones(361)), "places must be cosines or scattering angles"),
    ((np.polynomial.legendre.leggauss(16)[0], np.ones(16)), "places must reach from -1 to 1"),
    (([0, 90, 45, 180], [1, 1, 1, 1]), r"places must increase or decrease all the way, got \[90.0, 45.0\]"),
    ((ANGLES, -lobe(COSINES)), "values must be finite and >= 0"),
    ((ANGLES, lobe(COSINES)[:-1]), "values must be one number a place.*there are 181 places"),
    ((ANGLES, 0 * ANGLES), "values must have a positive finite integral"),
    (([0.0, np.nan, 180.0], [1, 1, 1]), "places must be finite"),
    (([1.0], [1.0]), "places must be a list of at least two numbers"),
]


@pytest.mark.parametrize(("columns", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_what_is_not_understood_is_refused(columns, message):
    with pytest.raises(InvalidValueError, match=message):
        Tabulated.from_columns(*columns)


def test_angles_taken_for_cosines_are_sent_there():
    with pytest.raises(
        InvalidValueError, match=r"cosines must increase from -1 to 1.*Tabulated.from_columns understands"
    ):
        Tabulated.normalised(ANGLES, lobe(COSINES))
