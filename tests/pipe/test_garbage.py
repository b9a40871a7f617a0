"""Numbers that are no samples and no densities: the frame is right, what stands in it is noise."""

import numpy as np
import pytest

from fogproof import HalfLine, Interval, UnitSphere, check_sampler


def bits(n):
    """Return n random float64 of any sign and size, NaN and infinity among them."""
    return np.frombuffer(np.random.default_rng().bytes(8 * n), np.float64)


def place(domain, u):
    return domain.law(np.empty((0, *domain.shape))).place(u)


@pytest.mark.parametrize("points", ["noise", "right"])
def test_noise_is_rejected(points):
    """Quadrature fails, sums overflow, no histogram can be made: the end is a verdict all the same."""
    domain = UnitSphere()

    def sample(u):
        return bits(3 * len(u)).reshape(-1, 3) if points == "noise" else place(domain, u)

    verdict = check_sampler(sample, lambda x: bits(len(x)), domain, dimensions=2, samples=2000)
    assert verdict.outcome == "rejected", verdict


@pytest.mark.parametrize("height", [1e20, 1e200])
@pytest.mark.parametrize("domain", [Interval(0, 0.5), UnitSphere()], ids=["interval", "sphere"])
def test_a_density_that_is_much_too_high_is_not_normalised(domain, height):
    dimensions = 2 if domain.shape else 1
    verdict = check_sampler(
        lambda u: place(domain, u), lambda x: np.full(len(x), height), domain, dimensions=dimensions, samples=2000
    )
    assert (verdict.outcome, verdict.cause) == ("rejected", "normalisation"), verdict


@pytest.mark.parametrize("domain", [Interval(0, 0.5), UnitSphere()], ids=["interval", "sphere"])
def test_a_density_near_the_largest_number_is_no_accident(domain):
    """Its integral is no number; nothing of it passes."""
    dimensions = 2 if domain.shape else 1
    verdict = check_sampler(
        lambda u: place(domain, u), lambda x: np.full(len(x), 1e308), domain, dimensions=dimensions, samples=2000
    )
    assert verdict.outcome != "not rejected", verdict


def test_a_density_that_leaves_no_cells_is_no_accident():
    """Between the smallest and a large number at random: no cell of the half line has a mass."""

    def pdf(x):
        return np.where(np.random.default_rng().random(len(x)) < 0.5, 5e-324, 1e300)

    verdict = check_sampler(lambda u: u[:, 0], pdf, HalfLine(0), dimensions=2, samples=2000)
    assert verdict.outcome == "rejected", verdict
