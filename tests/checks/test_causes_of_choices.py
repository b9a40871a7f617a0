"""A choice between two parts that is made with the wrong weights, or by a number that is used again: told by the map itself."""

import numpy as np
import pytest

from fogproof import HalfLine, Interval, UnitHemisphere, UnitSphere, check_sampler
from fogproof.checks.diagnosis.branches import chosen_wrongly
from fogproof.checks.subject import Subject

TURN = 2 * np.pi
FORWARD, BACKWARD = 0.9, -0.3  # mean cosines
HEIGHT, END, SIGMA = 0.8, 3.0, 1.3  # of a light above the ray at 1 [m], of the ray [m], of the medium [1/m]
LOW, HIGH = np.arctan(-1 / HEIGHT), np.arctan((END - 1) / HEIGHT)
ROUGHNESS = 0.3


def directions(mu, turn):
    sine = np.sqrt(np.maximum(1 - mu * mu, 0))
    return np.stack([sine * np.cos(TURN * turn), sine * np.sin(TURN * turn), mu], axis=-1)


def cosine(g, u):
    return (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * u)) ** 2) / (2 * g)


def lobe(g, x):
    return (1 - g * g) / (2 * TURN * (1 + g * g - 2 * g * x[:, 2]) ** 1.5)


def own(w, u):
    """The choice by a number of its own, and that which places the sample."""
    return u[:, 0] < w, u[:, 1]


def stretched(w, u):
    first = u[:, 0] < w
    return first, np.where(first, u[:, 0] / w, (u[:, 0] - w) / (1 - w))


def again(w, u):
    return u[:, 0] < w, u[:, 0]


def two_lobes(w, way):
    def sample(u):
        first, v = way(w, u)
        return directions(np.where(first, cosine(FORWARD, v), cosine(BACKWARD, v)), u[:, -1])

    return (
        sample,
        lambda w: lambda x: w * lobe(FORWARD, x) + (1 - w) * lobe(BACKWARD, x),
        UnitSphere(),
        2 + (way is own),
    )


def on_a_ray(w, way):
    """Equiangular, or a free path that ends on the ray."""

    def sample(u):
        first, v = way(w, u)
        return np.where(
            first, 1 + HEIGHT * np.tan(LOW + (HIGH - LOW) * v), -np.log1p(v * np.expm1(-SIGMA * END)) / SIGMA
        )

    def pdf(w):
        def density(t):
            angle = HEIGHT / ((HIGH - LOW) * (HEIGHT**2 + (t - 1) ** 2))
            return w * angle - (1 - w) * SIGMA * np.exp(-SIGMA * t) / np.expm1(-SIGMA * END)

        return density

    return sample, pdf, Interval(0, END), 1 + (way is own)


def coated(w, way):
    """Normals of a rough surface, or diffuse."""

    def sample(u):
        first, v = way(w, u)
        mu = np.where(first, np.sqrt(v / (v + ROUGHNESS**2 * (1 - v))), np.sqrt(v))
        return directions(mu, u[:, -1])

    def pdf(w):
        def density(x):
            normals = ROUGHNESS**2 / ((ROUGHNESS**2 - 1) * x[:, 2] ** 2 + 1) ** 2
            return np.maximum(x[:, 2], 0) / np.pi * (w * normals + 1 - w)

        return density

    return sample, pdf, UnitHemisphere(), 2 + (way is own)


MIXTURES = {"two lobes": two_lobes, "on a ray": on_a_ray, "coated": coated}


def told(subject):
    points = subject.draw(np.random.default_rng(1), 4096).x
    with np.errstate(all="ignore"):
        return chosen_wrongly(subject, points, 1)


@pytest.mark.parametrize("mixture", MIXTURES)
@pytest.mark.parametrize(
    ("way", "w", "claimed", "cause", "words"),
    [
        (own, 0.3, 0.7, "swapped weights", "with probability 0.3, and in the pdf that part has the weight 0.7"),
        (stretched, 0.3, 0.7, "swapped weights", "are exchanged"),
        (own, 0.3, 0.4, "wrong share", "in the pdf that part has the weight 0.4"),
        (again, 0.3, 0.3, "reused number", "u / 0.3 below that and (u - 0.3) / 0.7 beyond"),
    ],
    ids=["swapped", "swapped and stretched", "another", "reused"],
)
def test_a_choice_that_is_wrong_is_told(mixture, way, w, claimed, cause, words):
    sample, pdf, domain, dimensions = MIXTURES[mixture](w, way)
    verdict = check_sampler(sample, pdf(claimed), domain, dimensions=dimensions, samples=40_000)
    assert verdict.outcome == "rejected", str(verdict)
    assert verdict.cause == cause, str(verdict)
    assert words in verdict.diagnosis, verdict.diagnosis


@pytest.mark.parametrize("mixture", MIXTURES)
@pytest.mark.parametrize("way", [own, stretched])
def test_a_right_choice_is_none(mixture, way):
    sample, pdf, domain, dimensions = MIXTURES[mixture](0.3, way)
    assert told(Subject(sample, pdf(0.3), domain, dimensions)) == ("", "")


@pytest.mark.parametrize("mixture", MIXTURES)
def test_single_precision_tells_it_too(mixture):
    sample, pdf, domain, dimensions = MIXTURES[mixture](0.3, own)
    single = Subject(lambda u: sample(u.astype(np.float32)), pdf(0.7), domain, dimensions, precision="float32")
    assert told(single)[0] == "swapped weights"


def stretch(factor):
    return lambda u: -factor * np.log1p(-u[:, 0])


def other_parts(u):
    return np.where(u[:, 0] < 0.3, np.sqrt(u[:, 1]), u[:, 1] ** 2)


LOBES, LOBES_PDF, _, _ = two_lobes(0.3, own)


def rippled(x):
    """With the weights exchanged, and that is not all."""
    return LOBES_PDF(0.7)(x) * (1 + 0.006 * np.cos(40 * x[:, 2]))


OTHERS = {
    "a pdf with another error besides": (LOBES, rippled, UnitSphere(), 3),
    "no choice": (stretch(1.2), lambda t: np.exp(-t), HalfLine(0), 1),
    "a sampler with other parts": (other_parts, lambda x: 0.3 * 3 * x**2 + 0.7, Interval(0, 1), 2),
}


@pytest.mark.parametrize("name", OTHERS)
def test_another_error_is_no_wrong_choice(name):
    assert told(Subject(*OTHERS[name])) == ("", "")
