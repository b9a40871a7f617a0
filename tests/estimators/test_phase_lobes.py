"""Invariant: what compiled kernels draw from is the phase function, for every kind, to the stated part of a million."""

import numpy as np
import pytest
from phase_functions import EXAMPLES

from fogproof.analytic import (
    mean_displacement,
    mean_square_displacement,
    phase_cdf,
    phase_mean_cosine,
    phase_pdf,
    single_scattering,
    slab_emissivity,
)
from fogproof.checks import check_estimator, fresh_seed
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.estimators import PathTracer, SpectralPathTracer
from fogproof.estimators.kernels.path_data import Lobe, TableLobe
from fogproof.estimators.paths.random_walks import RandomFlights
from fogproof.estimators.phase.functions import kernel_lobe
from fogproof.estimators.phase.tabulated_lobe import ENOUGH, tabulated_lobe
from fogproof.scene import HenyeyGreenstein, Isotropic, LinearMedium, Medium, Ramp, Ray, VaryingPhase
from fogproof.scene.lights import Environment, PointLight
from fogproof.scene.shapes import Slab

ALPHA = 1e-9
UP = (0.0, 0.0, 1.0)
TABLED = {kind: phase for kind, phase in EXAMPLES.items() if not isinstance(kernel_lobe(phase), Lobe)}
SMOOTH = [
    HenyeyGreenstein(0.9999),
    HenyeyGreenstein(-0.99),
    *(p for kind, p in EXAMPLES.items() if kind != "tabulated"),
]


@pytest.mark.parametrize("phase", SMOOTH, ids=lambda phase: type(phase).__name__)
def test_a_table_has_the_distribution_of_the_phase_function(phase):
    lobe, error = tabulated_lobe(phase)
    assert error <= ENOUGH
    assert len(lobe.left) < 12000
    mu = np.where(lobe.versine < lobe.coversine, 1 - lobe.versine, lobe.coversine - 1)
    right = phase_cdf(phase, np.clip(mu, -1, 1))
    # At an edge the probability is right to rounding, save that mu itself is rounded; and the line keeps every moment to 1e-6.
    rounding = 1e-12 + 2 * np.pi * 2e-16 * phase_pdf(phase, np.clip(mu, -1, 1)).value
    assert np.all(np.abs(lobe.cdf - (1 - right.value)) <= right.error + rounding)
    assert np.all(lobe.left >= 0)
    assert np.all(lobe.right >= 0)
    width = np.where(lobe.versine[1:] < 1, np.diff(lobe.versine), -np.diff(lobe.coversine))
    mass = np.pi * width * (lobe.left + lobe.right)
    assert np.allclose(mass[:-1], np.diff(lobe.cdf)[:-1], rtol=1e-8, atol=1e-15)
    middle = (lobe.versine[1:] + lobe.versine[:-1]) / 2
    wide = middle > 1e-6
    true = phase_pdf(phase, 1 - middle[wide]).value
    off = np.abs((lobe.left + lobe.right)[wide] / 2 - true)
    assert (
        2 * np.pi * np.sum(np.diff(lobe.versine)[wide] * off) <= 2 * error
    )  # in the middle of a cell the line is off most


def test_only_closed_forms_are_not_tabled():
    assert {type(EXAMPLES[kind]) for kind in EXAMPLES if kind not in TABLED} == {
        Isotropic, HenyeyGreenstein, type(EXAMPLES["rayleigh"]),
    }  # fmt: skip
    assert all(isinstance(kernel_lobe(phase), TableLobe) for phase in TABLED.values())


@pytest.mark.parametrize("kind", EXAMPLES)
def test_random_flights_have_the_mean_cosine(kind):
    g = phase_mean_cosine(EXAMPLES[kind])
    moments = [f(3, float(g.value)) for f in (mean_displacement, mean_square_displacement)]
    reference = Reference([m.value for m in moments], [m.error + 20 * g.error + 6 * ENOUGH for m in moments])
    verdict = check_estimator(
        RandomFlights(3, EXAMPLES[kind]).draw, reference, samples=100_000, alpha=ALPHA, seed=fresh_seed()
    )
    verdict.raise_if_rejected()


@pytest.mark.parametrize("kind", EXAMPLES)
def test_paths_through_a_slab(kind):
    """By two ways of light sampling: what a slab does not absorb of a uniform sky arrives."""
    ray = Ray((0, 0, 1.0), (0.8, 0, -0.6), np.inf)
    medium = Medium(0.1, 0.9, EXAMPLES[kind])
    e = slab_emissivity(0.9, 2.0, 0.6, EXAMPLES[kind])
    reference = Reference(1 - e.value, e.error + 10 * ENOUGH)
    for light_sampling in ("bsdf", "nee"):
        tracer = PathTracer(medium, Slab((0, 0, 0), UP, 2.0), ray, Environment(1.0), light_sampling=light_sampling)
        check_estimator(tracer.draw, reference, samples=60_000, alpha=ALPHA, seed=fresh_seed()).raise_if_rejected()


def test_colours_are_scattered_by_the_same_table():
    phase = EXAMPLES["draine"]
    ray, slab = Ray((0, 0, 1.0), (0.8, 0, -0.6), np.inf), Slab((0, 0, 0), UP, 1.0)
    tracer = SpectralPathTracer(Medium((0.1, 0.5), (0.9, 1.5), phase), slab, ray, Environment(1.0))
    e = [slab_emissivity(c, tau, 0.6, phase) for c, tau in ((0.9, 1.0), (0.75, 2.0))]
    reference = Reference([1 - x.value for x in e], [x.error + 10 * ENOUGH for x in e])
    check_estimator(tracer.draw, reference, samples=60_000, alpha=ALPHA, seed=fresh_seed()).raise_if_rejected()


def test_a_phase_function_that_varies_in_space():
    """One bounce: the oracle integrates it along the ray."""
    phase = VaryingPhase(EXAMPLES["murky"], HenyeyGreenstein(-0.6), Ramp((0, 0, 0), (0, 0, -2)))
    medium, ray, light = (
        LinearMedium(0.7, (0, 0, 0.1), 0.8, phase),
        Ray((0.3, 0, 0), (0, 0, -1), 2.0),
        PointLight((1, 0, -1), 1.0),
    )
    right = single_scattering(medium, ray, light)
    slab = Slab((0, 0, 0), UP, 2.0)
    inside = PathTracer(medium, slab, Ray((0.3, 0, 0), (0, 0, -1), np.inf), light, deepest=1)
    reference = Reference(right.value, right.error + 10 * ENOUGH)
    check_estimator(inside.draw, reference, samples=200_000, alpha=ALPHA, seed=fresh_seed()).raise_if_rejected()


def test_what_cannot_be_tabled_is_refused():
    with pytest.raises(UnsupportedError, match="size parameter"):
        kernel_lobe(type(EXAMPLES["mie"])(4e-4, 550e-9, 1.333))
