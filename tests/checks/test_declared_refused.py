"""What cannot be true is refused by name before anything is drawn; what nothing checks is told."""

import numpy as np
import pytest

from fogproof import Ball, Box, Draw, Interval, Rectangle, SpherePart, check_sampler
from fogproof.errors import InvalidValueError, SubjectError


def ones(x):
    return np.ones(len(x))


def checked(**options):
    return check_sampler(lambda u: u[:, 0], ones, Interval(0, 1), dimensions=1, samples=1000, **options)


@pytest.mark.parametrize(
    "atoms", [{0.2: 0.7, 0.4: 0.6}, {2.0: 0.1}, {np.nan: 0.1}], ids=["more than all", "outside", "no number"]
)
def test_atoms_that_cannot_be(atoms):
    with pytest.raises(InvalidValueError, match=r"^atoms"):
        checked(atoms=atoms)


def test_an_atom_at_infinity_or_at_an_end_can_be():
    checked(atoms={np.inf: 0.1})
    checked(atoms={1.0: 0.1})


def test_an_albedo_of_other_channels_than_the_weights():
    with pytest.raises(InvalidValueError, match=r"^albedo .* 2, got"):
        check_sampler(
            lambda u: Draw(u[:, 0], weight=u[:, :1] * [1, 1]), ones, Interval(0, 1), dimensions=1, albedo=(1, 1, 1)
        )


@pytest.mark.parametrize("albedo", [np.nan, np.inf, -np.inf, (0.5, np.nan), (), [[0.5]], "x"])
def test_an_albedo_that_cannot_be(albedo):
    with pytest.raises(InvalidValueError, match=r"^albedo must be"):
        checked(albedo=albedo)


def test_a_mean_weight_may_be_negative():
    verdict = check_sampler(
        lambda u: Draw(u[:, 0], weight=-np.ones(len(u))), ones, Interval(0, 1), dimensions=1, albedo=-1, samples=1000
    )
    assert verdict.outcome != "rejected"


def test_what_is_declared_and_not_looked_at_is_told():
    told = " ".join(checked(albedo=0.5, axis=(0, 0, 1)).unchecked)
    assert "albedo" in told
    assert "axis" in told
    assert not checked().unchecked


@pytest.mark.parametrize(
    "make",
    [
        lambda: Box(0, 1),
        lambda: Rectangle(0, 1),
        lambda: Ball(1, (0, 0)),
        lambda: SpherePart(None),
        lambda: SpherePart(ones, -1),
        lambda: SpherePart(ones, 13),
    ],
)
def test_domains_that_cannot_be(make):
    with pytest.raises(InvalidValueError):
        make()


def directions(u):
    z, phi = u[:, 0], 2 * np.pi * u[:, 1]
    return np.stack([np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z], axis=-1)


def part(inside, angle=np.nan):
    return check_sampler(
        directions, lambda w: np.full(len(w), 0.5 / np.pi), SpherePart(inside, angle), dimensions=2, samples=1000
    )


def test_a_part_of_the_sphere_that_is_not_recognised_properly():
    with pytest.raises(InvalidValueError, match=r"about 6\.28"):
        part(lambda w: w[:, 2] >= 0, 3.0)
    with pytest.raises(InvalidValueError, match="one bool a direction"):
        part(lambda w: w[:, 2:] >= 0)
    with pytest.raises(SubjectError, match=r"contains.* raised KeyError"):
        part(lambda w: {}["hole"])
    assert part(lambda w: w[:, 2] >= 0, 2 * np.pi).outcome == "not rejected"
