"""A Rosenblatt map that does not belong to the pdf is found without a sample, on every domain; jumps of either are no fault."""

import numpy as np
import pytest

from fogproof import Ball, Box, UnitDisk, UnitHemisphere, UnitSphere, UnitSquare, check_sampler
from fogproof.checks.jacobian import jacobian_agreement
from fogproof.checks.subject import Subject

TABLE = np.random.default_rng(7).random((24, 31)) ** 2
TABLE /= TABLE.sum()


def henyey_greenstein(g):
    def cdf(x):
        mu = (1 - g * g) / (2 * g) * (1 / np.sqrt(1 + g * g - 2 * g * x[:, 2]) - 1 / (1 + g))
        return np.stack([mu, np.arctan2(x[:, 1], x[:, 0]) / (2 * np.pi) + 0.5], axis=-1)

    def sample(u):
        mu = (1 + g * g - ((1 - g * g) / (1 - g + 2 * g * u[:, 0])) ** 2) / (2 * g)
        phi, sine = 2 * np.pi * (u[:, 1] - 0.5), np.sqrt(1 - mu * mu)
        return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)

    return sample, lambda x: (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * x[:, 2]) ** 1.5), cdf


def polar(x):
    return np.stack([x[:, 0] ** 2 + x[:, 1] ** 2, np.arctan2(x[:, 1], x[:, 0]) / (2 * np.pi) + 0.5], axis=-1)


def cells(x):
    h, w = TABLE.shape
    return np.minimum((x[:, 0] * h).astype(int), h - 1), np.minimum((x[:, 1] * w).astype(int), w - 1)


def table_cdf(x):
    (i, j), (h, w) = cells(x), TABLE.shape
    row = TABLE.sum(axis=1)
    above, left = (
        np.append(0, np.cumsum(row))[i],
        np.concatenate([np.zeros((h, 1)), np.cumsum(TABLE, axis=1)], axis=1)[i, j],
    )
    return np.stack([above + (x[:, 0] * h - i) * row[i], (left + (x[:, 1] * w - j) * TABLE[i, j]) / row[i]], axis=-1)


def ball_cdf(x):
    r = np.sqrt((x * x).sum(axis=1))
    return np.stack([r**3 / 8, 0.5 + 0.5 * x[:, 2] / r, polar(x)[:, 1]], axis=-1)


RIGHT = {
    "HG 0.7": (UnitSphere(), *henyey_greenstein(0.7)[1:]),
    "HG 0.999": (UnitSphere(), *henyey_greenstein(0.999)[1:]),
    "cosine hemisphere": (UnitHemisphere(), lambda x: x[:, 2] / np.pi, polar),
    "disk": (UnitDisk(), lambda x: np.full(len(x), 1 / np.pi), polar),
    "table": (UnitSquare(), lambda x: TABLE[cells(x)] * TABLE.size, table_cdf),
    "ball of radius 2": (Ball(2.0), lambda x: np.full(len(x), 3 / (32 * np.pi)), ball_cdf),
    "box of three": (Box((0, 0, 0), (1, 2, 3)), lambda x: x[:, 0] * x[:, 1] / 3, lambda x: x ** (2, 2, 1) / (1, 4, 3)),
}  # fmt: skip

WRONG = {
    "a constant factor": lambda pdf: lambda x: 1.01 * pdf(x),
    "a ripple of 1 %": lambda pdf: lambda x: pdf(x) * (1 + 0.01 * np.sin(40 * x[:, 0])),
    "mirrored": lambda pdf: lambda x: pdf(np.concatenate([0.9 * x[:, :1], x[:, 1:]], axis=1)) * (1 + 0.2 * x[:, 0]),
}


def points(domain):
    rng = np.random.default_rng()
    law = domain.law(np.empty((0, *domain.shape)))
    return law.place(rng.random((2000, len(law.axes))))


@pytest.mark.parametrize("name", RIGHT)
def test_a_map_and_its_density_agree(name):
    domain, pdf, cdf = RIGHT[name]
    finding = jacobian_agreement(Subject(None, pdf, domain, None, cdf=cdf), points(domain))
    assert finding.outcome == "not rejected", finding


@pytest.mark.parametrize("name", RIGHT)
@pytest.mark.parametrize("error", WRONG)
def test_a_map_of_another_density_is_found(name, error):
    domain, pdf, cdf = RIGHT[name]
    finding = jacobian_agreement(Subject(None, WRONG[error](pdf), domain, None, cdf=cdf), points(domain))
    assert finding.outcome == "rejected", finding
    assert finding.cause == ("normalisation" if error == "a constant factor" else "wrong formula")


def test_a_map_without_derivatives_says_nothing():
    noise = lambda x: np.random.default_rng().random((len(x), 2))  # noqa: E731
    finding = jacobian_agreement(Subject(None, RIGHT["disk"][1], UnitDisk(), None, cdf=noise), points(UnitDisk()))
    assert finding.outcome == "inconclusive"


def test_samples_are_held_against_the_pdf_although_a_cdf_is_given():
    sample, _, cdf = henyey_greenstein(0.7)
    options = {"dimensions": 2, "samples": 50_000, "cdf": cdf}
    assert check_sampler(sample, henyey_greenstein(0.7)[1], UnitSphere(), **options).outcome == "not rejected"
    verdict = check_sampler(sample, henyey_greenstein(0.8)[1], UnitSphere(), **options)
    rejected = {f.check: f.cause for f in verdict.findings if f.outcome == "rejected"}
    assert rejected["cdf against the pdf"] == "wrong formula"
    assert verdict.cause == "another parameter", "the samples are those of g = 0.7"


def test_any_bijection_onto_the_square_will_do_and_none_hides_an_error():
    """Axes swapped, one turned round, and sheared with a wrap: no Rosenblatt map, and as good as one."""
    sample, pdf, cdf = henyey_greenstein(0.6)

    def inverse(x):
        u = cdf(x)
        return np.stack([u[:, 1], (1 - u[:, 0] + 0.3 * u[:, 1]) % 1.0], axis=-1)

    def check(sample, pdf, inverse):
        return check_sampler(sample, pdf, UnitSphere(), dimensions=2, cdf=inverse, samples=60_000).outcome

    assert check(sample, pdf, inverse) == "not rejected"
    assert check(sample, lambda x: 0.98 * pdf(x), inverse) == "rejected"
    assert check(henyey_greenstein(0.62)[0], pdf, inverse) == "rejected"
    assert check(sample, henyey_greenstein(0.62)[1], inverse) == "rejected"
    assert check(sample, lambda x: 0.5 * pdf(x), lambda x: inverse(x) * (0.5, 1.0)) == "rejected", "not onto the square"
