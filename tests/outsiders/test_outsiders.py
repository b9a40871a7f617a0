"""Samplers as users bring them: that they are what they claim, and that the errors planted in them are errors.

The whole suite runs by name, `fogproof verify outsiders`, and with every error planted by `fogproof zoo outsiders --one-in 1`.
"""

import numpy as np
import pytest

from fogproof.catalogue.outsiders import lights, maps
from fogproof.catalogue.outsiders.subjects import ERRORS
from fogproof.checks import check_sampler
from fogproof.verify import select

ALL = select(["outsiders"])


def test_a_dozen_of_more_than_a_hundred_run_by_default():
    default = [case for case in select([]) if case.name.startswith("outsiders/")]
    assert len(ALL) > 130
    assert 8 <= len(default) <= 14
    assert {case.name.split("/")[1] for case in default} == {"laws", "lights", "maps"}
    assert sum(case.expected == "inconclusive" for case in ALL) <= 0.02 * len(ALL), "each with a reason"
    assert all(case.reason for case in ALL if case.expected != "not rejected")


@pytest.mark.parametrize("case", [c for c in ALL if "/laws/" not in c.name], ids=lambda case: case.name)
def test_their_points_have_a_density_and_its_mean_inverse_is_no_more_than_the_measure(case):
    """E[1 / p(X)] is the measure of the support: an identity that needs neither cells nor a known law."""
    subject = case.make()
    x = np.asarray(subject.sample(np.random.default_rng().random((4000, subject.dimensions))), dtype=float)
    for point in subject.atoms:
        x = x[np.any(x != point, axis=1)]
    assert subject.domain.contains(x, 2e-15).all()
    inverse = 1 / subject.pdf(x)
    assert np.all(np.isfinite(inverse))
    share = 1 - sum(subject.atoms.values())
    assert share * inverse.mean() <= subject.domain.measure * (1 + 1e-9) + 7 * inverse.std() / np.sqrt(len(x))


SOME = {
    "sun": lambda: lights.cone(lights.AXES[1], 0.2665),
    "triangle light": lambda: lights.polygon((-1.0, -1.0, 1.0), (2.0, 0.0, 0.0), (0.0, 2.0, 0.0), True),
    "thin band": lambda: lights.band(0.6, 0.601),
    "map": lambda: maps.sphere(64, 128, 1e3),
}


@pytest.mark.parametrize("name", SOME)
def test_right_ones_pass_and_each_error_is_found(name):
    for error, make in {"": lambda s: s, **ERRORS}.items():
        subject = make(SOME[name]())
        for samples in (40_000, 400_000) if error else (400_000,):  # what few leave open, all must decide
            verdict = check_sampler(
                subject.sample, subject.pdf, subject.domain, dimensions=subject.dimensions, samples=samples
            )
            if verdict.outcome == "rejected":
                break
        assert verdict.outcome == ("rejected" if error else "not rejected"), f"{error}: {verdict}"
