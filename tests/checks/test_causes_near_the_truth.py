"""What is near to the samples is not told as what they are: a fit is refused by the samples that a law is refused by."""

import numpy as np
import pytest
from laws_by_hand import TURN, about

from fogproof import UnitHemisphere, check_sampler

N = 100_000


def beckmann(roughness):
    """Return the sampler of Beckmann's slopes, and their density over solid angle, which has no cosine."""
    return (
        lambda u: about(1 / np.sqrt(1 - roughness**2 * np.log1p(-u[:, 0])), TURN * u[:, 1]),
        lambda x: (
            np.exp(-(np.maximum(x[:, 2], 1e-9) ** -2 - 1) / roughness**2)
            / (np.pi * roughness**2 * np.maximum(x[:, 2], 1e-9) ** 4)
        ),
    )


def ggx(u, roughness=0.3):
    return about(1 / np.sqrt(1 + roughness**2 * u[:, 0] / (1 - u[:, 0])), TURN * u[:, 1])


def sheen(u, roughness=0.35):
    """Charlie's sheen (Estevez & Kulla 2017) with the sine in the place of the cosine."""
    return about(u[:, 0] ** (1 / (2 + 1 / roughness)), TURN * u[:, 1])


def verdict_of(sample, pdf):
    verdict = check_sampler(sample, pdf, UnitHemisphere(), dimensions=2, samples=N, seed=1)
    assert verdict.outcome == "rejected"
    return verdict


@pytest.mark.parametrize("roughness", [0.2, 0.3])
def test_no_constant_factor_makes_up_for_a_missing_cosine(roughness):
    """Of a narrow lobe, it changes the shape by less than cells of few samples tell."""
    sample, pdf = beckmann(roughness)
    assert "constant factor" not in verdict_of(sample, pdf).diagnosis
    right = verdict_of(sample, lambda x: 1.02 * x[:, 2] * pdf(x))
    assert (right.cause, right.diagnosis) == ("normalisation", "the samples fit the pdf but for a constant factor 1.02")


def test_a_lobe_that_ends_before_the_horizon_is_no_plane():
    """Its skirts are less than the least number."""
    verdict = verdict_of(*beckmann(0.6))
    assert "plane" not in verdict.diagnosis
    assert "power of the cosine" in verdict.diagnosis, verdict.diagnosis


NEAR = {
    "another law": (ggx, lambda x: 21 / TURN * x[:, 2] ** 20),
    "a stretch": (ggx, lambda x: 0.09 * x[:, 2] / (np.pi * (1 - 0.91 * x[:, 2] ** 2))),
    "a lobe": (sheen, lambda x: (2 + 1 / 0.35) / TURN * np.maximum(1 - x[:, 2] ** 2, 0) ** (0.5 / 0.35) * x[:, 2]),
}


@pytest.mark.parametrize("name", NEAR)
def test_a_fit_that_samples_refuse_is_said_to_be_near(name):
    verdict = verdict_of(*NEAR[name])
    assert verdict.cause == "shape", verdict.diagnosis
    assert verdict.diagnosis.startswith("near to, but not: "), verdict.diagnosis
    assert "100" not in verdict.diagnosis.partition("explains")[2]
