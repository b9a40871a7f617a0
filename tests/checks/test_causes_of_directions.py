"""What people do wrong with directions is named: lobes, lit planes, frames, clamped cosines; what is not pinned is not told."""

import numpy as np
import pytest
from laws_by_hand import TURN, about, hold

from fogproof import UnitHemisphere, UnitSphere, check_sampler
from fogproof.checks.diagnosis import directions, lobes
from fogproof.checks.diagnosis.explaining import setting_of
from fogproof.checks.subject import Subject
from fogproof.zoo.laws import hg_cosine

N = 30_000
UPRIGHT, TILTED = np.eye(3), np.array([[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]])


def fisher(kappa):
    return (
        lambda u: about(1 + np.log1p(u[:, 0] * np.expm1(-2 * kappa)) / kappa, TURN * u[:, 1]),
        lambda x: kappa / (TURN * -np.expm1(-2 * kappa)) * np.exp(kappa * (x[:, 2] - 1)),
    )


def hg(g, axes=UPRIGHT, most=1.0):
    """Return sampler and pdf of Henyey & Greenstein's law about the last of three axes, with cosines of at most so much."""
    return (
        lambda u: about(np.minimum(hg_cosine(g, u[:, 0]), most), TURN * u[:, 1]) @ axes,
        lambda x: (1 - g * g) / (2 * TURN) / (1 + g * g - 2 * g * (x @ axes[2])) ** 1.5,
    )


def window(u):
    """Directions, (n, 3), to points even on a square of side 2 at the height 1/2."""
    x = np.column_stack([2 * u - 1, np.full(len(u), 0.5)])
    return x / np.linalg.norm(x, axis=1, keepdims=True)


def sky(rng, n):
    """Directions, (n, 3), even in the solid angle of that square: of its points, taken as often as the cosine cubed."""
    x = window(rng.random((16 * n + 99, 2)))
    return x[rng.random(len(x)) < x[:, 2] ** 3][:n]


def lit(power):
    """Return a pdf that goes with so many powers of the cosine on that square, whose normalisation is integrated."""
    nodes, weights = np.polynomial.legendre.leggauss(40)
    x, y = np.meshgrid(nodes, nodes)
    cosine = 0.5 / np.sqrt(x * x + y * y + 0.25)
    total = np.sum(np.outer(weights, weights) * cosine ** (3 + power)) / 0.25

    def pdf(w):
        inside = (w[:, 2] > 0) & (np.abs(w[:, :2]).max(axis=1) <= 2 * w[:, 2] * (1 + 1e-12))
        return np.where(inside, np.maximum(w[:, 2], 1e-9) ** power / total, 0.0)

    return pdf


def built(normal, slip):
    """Return a frame of Duff et al. (2017) about a normal of z < 0 with its sign forgotten in one place, and the right one."""
    x, y, z = normal
    s = np.copysign(1.0, z)
    frames = []
    for inverse, first, second in ((s, s, s), {"inverse": (1, s, s), "first": (s, 1, s), "second": (s, s, 1)}[slip]):
        a = -1 / (inverse + z)
        frames.append(
            [[1 + first * x * x * a, first * x * y * a, -first * x], [x * y * a, second + y * y * a, -y], normal]
        )
    return np.array(frames[1]), np.array(frames[0])


def skewed(slip, law):
    """Return a sampler that normalises what such a frame makes of a law about z, and the pdf of the right frame."""
    wrong, right = built((0.48, 0.64, -0.6), slip)

    def sample(u):
        x = law[0](u) @ wrong
        return x / np.linalg.norm(x, axis=1, keepdims=True)

    return sample, lambda x: law[1](x @ right.T)


def ggx(rough, azimuth=lambda u, rough: TURN * u, frame=UPRIGHT):
    """Return sampler and pdf of half vectors, cosine times D of Trowbridge & Reitz (1975), of two roughnesses in a frame's rows.

    azimuth  of points (n,) and the roughnesses: the angle of the slopes in units of these
    """
    a, b = rough

    def sample(u):
        t, r = azimuth(u[:, 0], rough), np.sqrt(u[:, 1] / (1 - u[:, 1]))
        x = np.column_stack([a * r * np.cos(t), b * r * np.sin(t), np.ones(len(u))])
        return x / np.linalg.norm(x, axis=1, keepdims=True) @ frame

    def pdf(x):
        h = x @ frame.T
        d = 1 / (np.pi * a * b * ((h[:, 0] / a) ** 2 + (h[:, 1] / b) ** 2 + h[:, 2] ** 2) ** 2)
        return np.maximum(h[:, 2], 0) * d

    return sample, pdf


def ratio(u, rough):
    """Return the angle of slopes whose azimuth is the arctangent of a ratio, which has no quadrant."""
    return np.arctan(np.tan(TURN * u))


def signless(law, axes):
    """Return such a law whose samples have lost the signs of some coordinates."""

    def sample(u):
        x = law[0](u)
        x[:, axes] = np.abs(x[:, axes])
        return x

    return sample, law[1]


def turned(share):
    """Return the frame that is turned about z by a share of the turn."""
    c, s = np.cos(TURN * share), np.sin(TURN * share)
    return np.array([[c, s, 0.0], [-s, c, 0.0], [0.0, 0.0, 1.0]])


SPHERE = UnitSphere(), 2
FLAT = (0.15, 0.5)
OBLIQUE, _ = built((0.48, 0.64, 0.6), "inverse")
COSINE = lambda u: about(np.sqrt(u[:, 0]), TURN * u[:, 1]), lambda x: np.maximum(x[:, 2], 0) / np.pi
CASES = {  # sampler, pdf, domain, dimensions; the cause and words of what explains it
    "half a turn of a hemisphere": (
        (lambda u: about(np.sqrt(u[:, 0]), np.pi * u[:, 1]), lambda x: x[:, 2] / np.pi, UnitHemisphere(), 2),
        "skipped band",
        "azimuth over pi",
    ),
    "an arctangent for two arguments": (
        (*ggx(FLAT, ratio), UnitHemisphere(), 2),
        "skipped band",
        "arctangent that keeps no quadrant",
    ),
    "half a turn of a flat lobe": (
        (*ggx(FLAT, lambda u, _: np.pi * u), UnitHemisphere(), 2),
        "skipped band",
        "azimuth over pi",
    ),
    "a quadrant missing": (
        (*ggx(FLAT, lambda u, _: 1.5 * np.pi * u), *SPHERE),
        "skipped band",
        "-90 to 0 degrees, a quarter of the turn",
    ),
    "one quadrant": ((*ggx(FLAT, lambda u, _: np.pi / 2 * u), *SPHERE), "skipped band", "stays in its first quadrant"),
    "half a turn about a normal": (
        (*ggx(FLAT, lambda u, _: np.pi * u, OBLIQUE), *SPHERE),
        "skipped band",
        "about (0.480, 0.640, 0.600)",
    ),
    "roughnesses swapped": ((ggx(FLAT[::-1])[0], ggx(FLAT)[1], *SPHERE), "swapped axes", "taken for (y, x, z)"),
    "roughnesses swapped about a normal": (
        (ggx(FLAT[::-1], frame=OBLIQUE)[0], ggx(FLAT, frame=OBLIQUE)[1], *SPHERE),
        "swapped axes",
        "the two axes across swapped, about (0.480, 0.640, 0.600)",
    ),
    "a turned flat lobe": (
        (ggx(FLAT, frame=turned(0.1) @ OBLIQUE)[0], ggx(FLAT, frame=OBLIQUE)[1], *SPHERE),
        "rotated frame",
        "of a turn, about (0.480, 0.640, 0.600)",
    ),
    "all signs": ((*signless(hg(0.6, OBLIQUE), [0, 1, 2]), *SPHERE), "lost sign", "the signs of x, y and z are lost"),
    "all signs of an even law": (
        (
            *signless(
                (lambda u: about(2 * u[:, 0] - 1, TURN * u[:, 1]), lambda x: np.full(len(x), 0.5 / TURN)), [0, 1, 2]
            ),
            *SPHERE,
        ),
        "lost sign",
        "the signs of x, y and z are lost",
    ),
    "one sign": ((*signless(hg(0.6, OBLIQUE), [0]), *SPHERE), "lost sign", "the sign of x is lost"),
    "a lobe's own parameter": ((fisher(9)[0], fisher(7)[1], *SPHERE), "another parameter", "the pdf's is 7"),
    "the sign of g": ((hg(-0.8)[0], hg(0.8)[1], *SPHERE), "sign convention", "the opposite direction"),
    "area for solid angle": (
        (window, lit(0), *SPHERE),
        "missing Jacobian",
        "cosine over the squared distance is missing",
    ),
    "a plane's cosine": ((window, lit(-2), *SPHERE), "missing Jacobian", "the cosine is missing"),
    "a plane's distance": ((window, lit(-1), *SPHERE), "missing Jacobian", "the squared distance is missing"),
    "a plane's cosine twice": ((window, lit(-4), *SPHERE), "missing Jacobian", "the cosine is once too often"),
    "solid angle for area": ((sky, lit(-3), UnitSphere(), None), "missing Jacobian", "one of the area of a plane"),
    "a frame's sign in 1/(s + z)": ((*skewed("inverse", hg(0.6)), *SPHERE), "skewed frame", "missing in 1/(s + z)"),
    "a frame's sign in its first axis": ((*skewed("first", COSINE), *SPHERE), "skewed frame", "in the first axis"),
    "a frame's sign in its second axis": ((*skewed("second", hg(0.6)), *SPHERE), "skewed frame", "in the second axis"),
    "a clamped cosine": ((hg(0.9, most=0.999)[0], hg(0.9)[1], *SPHERE), "clamped", "x[2] = 0.999"),
    "a clamped cosine about any axis": (
        (hg(0.9, TILTED, 0.99)[0], hg(0.9, TILTED)[1], *SPHERE),
        "clamped",
        "a cosine to (-0.8000, 0.0000, 0.6000) = 0.99",
    ),
}


@pytest.mark.parametrize("name", CASES)
def test_the_cause_is(name):
    hold(CASES[name], N)


def test_a_lit_plane_is_no_lobe():
    """Its density is a power of the cosine, of which a power of the density is another one."""
    verdict = check_sampler(window, lit(-2), UnitSphere(), dimensions=2, samples=N)
    assert "lobe" not in verdict.diagnosis


def test_few_samples_of_another_g_are_no_other_error():
    hold(((hg(0.8)[0], hg(0.9)[1], *SPHERE), "another parameter", "Henyey-Greenstein with g"), 2000)


@pytest.mark.parametrize("seed", range(6))
def test_few_points_tell_which_law_a_claim_is(seed):
    """They hardly tell its mean direction, which is z."""
    setting = setting_of(Subject(*hg(0.5), *SPHERE), 1200, seed)
    own = [each.null for each in lobes.hypotheses(setting) if "Henyey-Greenstein" in each.words]
    assert own == pytest.approx([0.5], abs=0.01)


def test_a_cone_hardly_too_wide_has_no_parameter_that_is_not_pinned():
    def sample(u):
        return about(1 - u[:, 0] * (1 - np.cos(0.404)), TURN * u[:, 1])

    def pdf(x):
        return (x[:, 2] >= np.cos(0.4) - 1e-12) / (TURN * (1 - np.cos(0.4)))

    verdict = check_sampler(sample, pdf, UnitSphere(), dimensions=2, samples=60_000)
    assert verdict.outcome == "rejected"
    words, fitted, _ = verdict.diagnosis.partition(" +-")
    told = [float(words.split()[-1])] if fitted else []
    assert all(1 < value < 1.06 for value in told), verdict.diagnosis


def test_a_square_root_too_many_is_no_missing_one():
    """Beside a uniform pdf it makes cosine-weighted samples, beside another one it does not."""
    for pdf, weighted in ((lambda x: np.full(len(x), 1 / TURN), True), (COSINE[1], False)):
        setting = setting_of(Subject(COSINE[0], pdf, UnitHemisphere(), 2), 1 << 12, 1)
        root = next(each for each in directions.hypotheses(setting) if "cosine raised to the power" in each.words)
        assert (root.caused(0.5, 1e-3), root.caused(2.0, 1e-3)) == ("wrong power", "missing square root")
        assert ("cosine-weighted where the pdf is uniform" in root.said(0.5, 1e-3)) == weighted
