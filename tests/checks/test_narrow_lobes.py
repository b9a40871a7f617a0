"""Lobes so narrow that rounding of quadrature's own points matters: its bound counts that, and elsewhere stays what it was."""

import numpy as np
import pytest
from scipy.stats import norm

from fogproof import Interval, RealLine, UnitHemisphere, UnitSphere, check_sampler


def cone(cosine, factor=1.0):
    """Return a uniform sampler of the cone about z, and its pdf times a factor."""

    def sample(u):
        mu, phi = (1 - u[:, 0]) + u[:, 0] * cosine, 2 * np.pi * u[:, 1]
        sine = np.sqrt(np.maximum(0, (1 - mu) * (1 + mu)))
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)

    return sample, lambda x: np.where(x[:, 2] >= cosine, factor / (2 * np.pi * (1 - cosine)), 0.0)


def normalisation(sample, pdf, domain, dimensions):
    verdict = check_sampler(sample, pdf, domain, dimensions=dimensions, samples=2000, seed=1)
    return next(f for f in verdict.findings if f.check == "normalisation")


@pytest.mark.parametrize("cosine", [np.cos(1e-3), np.cos(3e-5), np.cos(1e-5), 1 - 1e-10])
def test_a_right_narrow_cone_is_normalised_within_what_rounding_explains(cosine):
    finding = normalisation(*cone(cosine), UnitSphere(), 2)
    assert finding.outcome == "not rejected", finding.message
    ulp = np.spacing(0.5) / (1 - cosine)  # of z over the height of the cone
    assert 0.25 * ulp < finding.resolution.value < 2.2e-7 + 6 * ulp


@pytest.mark.parametrize("angle", [1e-3, 1e-5])
def test_a_wrong_factor_beyond_rounding_is_seen_on_a_narrow_cone(angle):
    finding = normalisation(*cone(np.cos(angle), 1 + 3e-5), UnitSphere(), 2)
    assert (finding.outcome, finding.cause) == ("rejected", "normalisation")


def test_an_interval_far_from_zero_is_integrated_as_well_as_any():
    """No node lies beyond an end of the domain, whatever rounding does to it: there is nothing to charge."""
    low, high = 1.5e10, 1.5e10 + 1
    pdf = lambda x: np.where((x >= low) & (x <= high), 1.0, 0.0)  # noqa: E731
    finding = normalisation(lambda u: low + u[:, 0], pdf, Interval(low, high), 1)
    assert finding.outcome == "not rejected"
    assert finding.resolution.value < 2.1e-7


def test_an_integral_that_rounding_hides_is_not_claimed():
    at, width = 1e13, norm(0, 1)
    sample, pdf = lambda u: at + width.ppf(np.maximum(u[:, 0], 2.0**-60)), lambda x: width.pdf(x - at)
    finding = normalisation(sample, pdf, RealLine(), 1)
    assert finding.outcome == "not rejected"
    assert "rounding of the points that quadrature asks" in finding.message


def test_a_lobe_that_fills_a_corner_of_boxes_is_integrated():
    """Normals of Trowbridge and Reitz with widths 1e-7 and 0.5: of the boxes off its ridge it fills a corner alone."""
    width, turn = np.array([1e-7, 0.5]), np.array([[np.cos(0.6), -np.sin(0.6)], [np.sin(0.6), np.cos(0.6)]])

    def sample(u):
        slope, phi = np.sqrt(u[:, :1] / (1 - u[:, :1])), 2 * np.pi * u[:, 1]
        x = np.column_stack([width * slope * np.stack([np.cos(phi), np.sin(phi)], axis=-1) @ turn.T, np.ones(len(u))])
        return x / np.linalg.norm(x, axis=1)[:, None]

    def pdf(x):
        squared = (((x[:, :2] @ turn) / width) ** 2).sum(axis=1) + x[:, 2] ** 2
        return x[:, 2] / (np.pi * width.prod() * squared**2)

    finding = normalisation(sample, pdf, UnitHemisphere(), 2)
    assert finding.outcome == "not rejected", finding.message
    assert abs(finding.effect) < 2e-8
