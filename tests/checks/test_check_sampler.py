"""`check_sampler` rejects what is wrong, says why, and leaves alone what is right, on every domain and for any seed."""

import numpy as np
import pytest

import fogproof
from fogproof import (
    Discrete,
    Draw,
    HalfLine,
    Interval,
    InvalidValueError,
    RealLine,
    UnitDisk,
    UnitHemisphere,
    UnitSphere,
    UnitSquare,
    check_sampler,
)
from fogproof.errors import SubjectError

N = 100_000


def sphere(u):
    z, phi = 1 - 2 * u[:, 0], 2 * np.pi * u[:, 1]
    s = 2 * np.sqrt(u[:, 0] * (1 - u[:, 0]))
    return np.stack([s * np.cos(phi), s * np.sin(phi), z], axis=-1)


def cosine(u):
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - u[:, 0])], axis=-1)


def disk(u):
    r, phi = np.sqrt(u[:, 0]), 2 * np.pi * u[:, 1]
    return np.stack([r * np.cos(phi), r * np.sin(phi)], axis=-1)


def normal(u):
    from scipy.special import ndtri

    return ndtri(np.clip(u[:, 0], 1e-300, None))


def two_peaks(u):
    from scipy.special import ndtri

    side = u[:, 0] < 0.5
    x = 2 * np.where(side, u[:, 0], u[:, 0] - 0.5)
    return np.where(side, 0.2, 0.7) + 1e-4 * ndtri(np.clip(x, 1e-16, 1 - 1e-16))


def two_peaks_pdf(x):
    def bell(centre):
        return np.exp(-0.5 * ((x - centre) / 1e-4) ** 2) / (1e-4 * np.sqrt(2 * np.pi))

    return 0.5 * bell(0.2) + 0.5 * bell(0.7)


RIGHT = {
    "sphere": (sphere, lambda x: np.full(len(x), 0.25 / np.pi), UnitSphere(), {"dimensions": 2}),
    "cosine hemisphere": (cosine, lambda x: np.maximum(x[:, 2], 1e-30) / np.pi, UnitHemisphere(), {"dimensions": 2}),
    "disk": (disk, lambda x: np.full(len(x), 1 / np.pi), UnitDisk(), {"dimensions": 2}),
    "square": (lambda u: u, lambda x: np.ones(len(x)), UnitSquare(), {"dimensions": 2}),
    "square, skewed": (
        lambda u: np.sqrt(u), lambda x: 4 * x[:, 0] * x[:, 1] + 1e-300, UnitSquare(),
        {"dimensions": 2, "cdf": lambda x: x * x},
    ),
    "interval": (lambda u: 2 + 3 * u[:, 0], lambda x: np.full(len(x), 1 / 3), Interval(2, 5), {"dimensions": 1}),
    "exponential": (
        lambda u: 1 - np.log1p(-u[:, 0]) / 3, lambda x: 3 * np.exp(-3 * (x - 1)), HalfLine(1), {"dimensions": 1},
    ),
    "normal": (normal, lambda x: np.exp(-x * x / 2) / np.sqrt(2 * np.pi), RealLine(), {"dimensions": 1}),
    "two narrow peaks": (two_peaks, two_peaks_pdf, Interval(0, 1), {"dimensions": 1}),
    "inverse root": (
        lambda u: u[:, 0] ** 2, lambda x: 0.5 / np.sqrt(np.maximum(x, 1e-320)), Interval(0, 1), {"dimensions": 1},
    ),
    "die": (lambda u: np.floor(6 * u[:, 0]), lambda x: np.full(len(x), 1 / 6), Discrete(6), {"dimensions": 1}),
    "atom at infinity": (
        lambda u: np.where(u[:, 0] < 0.25, np.inf, -np.log1p(-u[:, 1])), lambda x: 0.75 * np.exp(-x), HalfLine(0),
        {"dimensions": 2, "atoms": {np.inf: 0.25}},
    ),
    "own generator": (
        lambda rng, n: rng.exponential(size=n), lambda x: np.exp(-x), HalfLine(0), {"dimensions": None},
    ),
    "single precision": (
        lambda u: (2 * u[:, 0].astype(np.float32) - 1).astype(np.float32), lambda x: np.full(len(x), 0.5), Interval(-1, 1),
        {"dimensions": 1, "precision": "float32"},
    ),
    "weights": (
        lambda u: Draw(u[:, 0], weight=0.6 * u[:, 0]), lambda x: np.ones(len(x)), Interval(0, 1),
        {"dimensions": 1, "eval": lambda x: 0.6 * x, "albedo": 0.3},
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", RIGHT)
def test_right_samplers_are_not_rejected(name):
    sample, pdf, domain, options = RIGHT[name]
    verdict = check_sampler(sample, pdf, domain, samples=N, alpha=1e-9, **options)
    assert verdict.outcome == "not rejected", str(verdict)
    verdict.raise_if_rejected()


def _draw(x, **more):
    return Draw(x, **more)


WRONG = {
    "pdf off by 1e-6": ("interval", {"pdf": lambda x: np.full(len(x), (1 + 1e-6) / 3)}, "normalisation"),
    "pdf of the wrong measure": ("sphere", {"pdf": lambda x: np.full(len(x), 0.5)}, "normalisation"),
    "uniform in radius": ("disk", {"sample": lambda u: disk(u) * np.sqrt(u[:, :1])}, "distribution of r"),
    "part of the circle": ("sphere", {"sample": lambda u: sphere(u * [1, 0.95])}, "distribution of phi"),
    "sampled where the pdf is 0": (
        "interval", {"pdf": lambda x: np.where(x > 4.9, 0, 1 / 2.9)}, "positive pdf"),
    "outside the domain": ("interval", {"sample": lambda u: 2 + 3.1 * u[:, 0]}, "domain"),
    "NaN": ("interval", {"sample": lambda u: np.where(u[:, 0] < 1e-3, np.nan, 2 + 3 * u[:, 0])}, "domain"),
    "stuck": ("interval", {"sample": lambda u: np.full(len(u), 3.0)}, "distribution"),
    "a loaded die": ("die", {"sample": lambda u: np.floor(6 * u[:, 0] ** 1.1)}, "distribution"),
    "infinite at u = 0": ("exponential", {"sample": lambda u: 1 - np.log(u[:, 0]) / 3}, "edge uniforms"),
    "atom too heavy": ("atom at infinity", {"atoms": {np.inf: 0.3}}, "atom"),
    "undeclared atom": ("atom at infinity", {"atoms": {}}, "domain"),
    "returned pdf": ("interval", {"sample": lambda u: _draw(2 + 3 * u[:, 0], pdf=np.full(len(u), 0.3334))}, "returned pdf"),
    "weight": ("weights", {"sample": lambda u: _draw(u[:, 0], weight=0.601 * u[:, 0])}, "weight"),
    "albedo": ("weights", {"albedo": 0.31}, "albedo"),
    "cdf": ("square, skewed", {"cdf": lambda x: x}, "chi-square, joint"),
    "given up": (
        "interval", {"sample": lambda u: _draw(2 + 3 * u[:, 0], valid=u[:, 0] > 0.05)}, "scan"),
}  # fmt: skip


def float32_cosine(u):
    """The inverse of a Henyey-Greenstein cdf with g = 1e-6, which cancels in single precision."""
    g = u.dtype.type(1e-6)
    s = (1 - g * g) / (1 - g + 2 * g * u[:, 0])
    return np.clip((1 + g * g - s * s) / (2 * g), -1, 1)


def one_azimuth(u):
    x = sphere(u)
    phi = 2 * np.pi * u[0, 1]
    s = np.hypot(x[:, 0], x[:, 1])
    return np.stack([s * np.cos(phi), s * np.sin(phi), x[:, 2]], axis=-1)


def threaded(u):
    """The azimuth turns 2400 times with the cosine: both marginals are right, and the samples fill a curve."""
    return sphere(np.stack([u[:, 0], 2400 * u[:, 0] % 1], axis=-1))


def surface(u):
    t = -np.log1p(-u[:, 0])
    return np.minimum(t, 1.0), t >= 1


SEEN = {
    "a skipped band": (
        "interval", {"sample": lambda u: 2 + 3 * np.where(np.abs(u[:, 0] - 0.4) < 1e-3, u[:, 1], u[:, 0]), "dimensions": 2},
        "scan", "skipped band"),
    "a lost tail": ("interval", {"sample": lambda u: 2 + 3 * 0.998 * u[:, 0]}, "ends", "missing tail"),
    "an undeclared atom": (
        "interval", {"sample": lambda u: np.where(u[:, 1] < 1e-3, 2.7, 2 + 3 * u[:, 0]), "dimensions": 2},
        "repeated points", "atom"),
    "a claimed hole": (
        "interval", {"pdf": lambda x: np.where(np.abs(x - 3) < 1e-3, 0, 1 / (3 - 2e-3))}, "positive pdf", "claimed hole"),
    "sorted samples": ("interval", {"sample": lambda u: 2 + 3 * np.sort(u[:, 0])}, "serial correlation", "order of the rows"),
    "one azimuth a batch": ("sphere", {"sample": one_azimuth}, "serial correlation", "order of the rows"),
    "a curve that fills the sphere": ("sphere", {"sample": threaded, "samples": 10 * N}, "chi-square, fine joint", "correlation"),
    "few different numbers": (
        "interval", {"sample": lambda u: 2 + 3 * np.floor(2**15 * u[:, 0]) / 2**15}, "repeated points", "coarse numbers"),
    "the wrong measure": ("sphere", {"pdf": lambda x: np.full(len(x), 0.5)}, "normalisation", "wrong measure"),
    "cancellation": (
        "single precision", {"sample": float32_cosine}, "single against double precision", "cancellation"),
    "weights too small": (
        "weights", {"sample": lambda u: Draw(u[:, 0], weight=0.5 * u[:, 0]), "eval": None}, "mean weight", "wrong weight"),
}  # fmt: skip


@pytest.mark.parametrize("name", SEEN)
def test_each_check_sees_its_error_and_names_its_kind(name):
    base, changes, finding, cause = SEEN[name]
    sample, pdf, domain, options = RIGHT[base]
    arguments = {"sample": sample, "pdf": pdf, **options, **changes}
    verdict = check_sampler(
        arguments.pop("sample"), arguments.pop("pdf"), domain, **{"samples": 3 * N, "alpha": 1e-9, **arguments}
    )
    assert finding in [f.check for f in verdict.findings if f.outcome == "rejected"], str(verdict)
    assert verdict.cause == cause, str(verdict)
    assert f"seed={verdict.seed}" in verdict.reproduce


def test_event_labels_belong_to_places():
    def draw(u, wrong):
        x, hit = surface(u)
        return Draw(x, event=np.where(u[:, 1] < wrong, ~hit, hit).astype(int))

    options = {"dimensions": 2, "atoms": {1.0: np.exp(-1)}, "samples": N}
    right, wrong = (
        check_sampler(lambda u, w=w: draw(u, w), lambda x: np.exp(-x), Interval(0, 1), **options) for w in (0, 1e-3)
    )
    assert right.outcome == "not rejected", str(right)
    assert wrong.cause == "wrong event label"
    alike = check_sampler(
        lambda u: Draw(surface(u)[0], event=u[:, 1] < 2), lambda x: np.exp(-x), Interval(0, 1), **options
    )
    assert alike.cause == "wrong event label", "the same label at the surface and before it says nothing"


def test_weights_of_several_channels():
    colours = np.array([0.2, 0.5, 0.9])

    def sample(u):
        return Draw(u[:, 0], weight=2 * u[:, :1] * colours)

    options = {"dimensions": 1, "eval": lambda x: 2 * x[:, None] * colours, "samples": N}
    ones = lambda x: np.ones(len(x))  # noqa: E731
    assert check_sampler(sample, ones, Interval(0, 1), albedo=tuple(colours), **options).outcome == "not rejected"
    verdict = check_sampler(sample, ones, Interval(0, 1), albedo=(0.2, 0.51, 0.9), **options)
    assert "albedo of channel 1" in [f.check for f in verdict.findings if f.outcome == "rejected"]
    assert verdict.cause == "wrong weight"


def test_every_rejection_has_a_place_a_size_and_a_figure():
    _, pdf, domain, options = RIGHT["cosine hemisphere"]
    verdict = check_sampler(sphere_up, pdf, domain, samples=N, **options)
    worst = next(f for f in verdict.findings if f.check == "distribution of mu")
    assert worst.outcome == "rejected"
    assert "mu >" in worst.region[0]
    assert worst.interval.low <= 0.25 <= worst.interval.high, "the largest distance is 1/4, at mu = 1/2"
    assert worst.figure["kind"] == "z-map"
    assert np.array(worst.figure["z"]).shape == tuple(len(e) - 1 for e in worst.figure["edges"])
    assert "Effect in" in str(verdict)


def sphere_up(u):
    x = sphere(u)
    return np.stack([x[:, 0], x[:, 1], np.abs(x[:, 2])], axis=-1)


@pytest.mark.parametrize("name", WRONG)
def test_wrong_samplers_are_rejected_by_the_check_that_sees_them(name):
    base, changes, finding = WRONG[name]
    sample, pdf, domain, options = RIGHT[base]
    arguments = {"sample": sample, "pdf": pdf, **options, **changes}
    with np.errstate(divide="ignore"):
        verdict = check_sampler(
            arguments.pop("sample"), arguments.pop("pdf"), domain, samples=N, alpha=1e-9, **arguments
        )
    assert verdict.outcome == "rejected", str(verdict)
    assert finding in [f.check for f in verdict.findings if f.outcome == "rejected"], str(verdict)
    with pytest.raises(AssertionError, match="rejected"):
        verdict.raise_if_rejected()


def test_flipped_in_both_is_seen_by_the_declared_mean_cosine_and_by_the_reference():
    def pdf(x):
        return (1 + 0.5 * x[:, 2]) / (4 * np.pi)

    def sample(u):
        mu = 2 * (np.sqrt(0.25 + 2 * u[:, 0]) - 1)
        phi, s = 2 * np.pi * u[:, 1], np.sqrt(np.maximum(1 - mu * mu, 0))
        return np.stack([s * np.cos(phi), s * np.sin(phi), mu], axis=-1)

    def flipped(u):
        return sample(u) * [1, 1, -1]

    def flipped_pdf(x):
        return pdf(x * [1, 1, -1])

    def reference(x):
        return fogproof.Reference(pdf(x), 1e-12 * pdf(x), "closed form", "test")

    options = {"dimensions": 2, "axis": (0.0, 0.0, 1.0), "samples": N}
    right = check_sampler(sample, pdf, UnitSphere(), mean_cosine=1 / 6, reference=reference, **options)
    assert right.outcome == "not rejected", str(right)
    unseen = check_sampler(flipped, flipped_pdf, UnitSphere(), **options)
    assert unseen.outcome == "not rejected", "without a declaration nothing is wrong with it"
    for declared in ({"mean_cosine": 1 / 6}, {"reference": reference}):
        assert check_sampler(flipped, flipped_pdf, UnitSphere(), **options, **declared).outcome == "rejected"
    both = check_sampler(flipped, flipped_pdf, UnitSphere(), mean_cosine=1 / 6, **options)
    one = check_sampler(flipped, pdf, UnitSphere(), **options)
    assert both.cause == one.cause == "sign convention", f"{both}\n{one}"


def test_the_same_seed_gives_the_same_verdict_and_another_seed_another():
    sample, pdf, domain, options = RIGHT["exponential"]
    first, again, other = (check_sampler(sample, pdf, domain, samples=N, seed=s, **options) for s in (1, 1, 2))
    assert [f.p_value for f in first.findings] == [f.p_value for f in again.findings]
    assert [f.p_value for f in first.findings] != [f.p_value for f in other.findings]


def test_resolution_sets_the_number_of_samples():
    sample, pdf, domain, options = RIGHT["die"]
    verdict = check_sampler(sample, pdf, domain, resolution=0.02, **options)
    assert verdict.samples < 200_000
    assert verdict.resolution.value <= 0.0201


BAD_SUBJECTS = [
    (lambda u: 1 / 0, r"sample\(u\) raised ZeroDivisionError"),
    (lambda u: u[:-1, 0], r"sample: x must return an array of shape"),
    (lambda u: u, r"sample: x must return an array of shape \(\d+,\), got"),
    (lambda u: ["x"] * len(u), "must return numbers"),
]


@pytest.mark.parametrize(("sample", "message"), BAD_SUBJECTS)
def test_a_sampler_that_breaks_its_contract_is_told_how(sample, message):
    with pytest.raises(SubjectError, match=message):
        check_sampler(sample, lambda x: np.ones(len(x)), Interval(0, 1), dimensions=1)


BAD_ARGUMENTS = [
    ({"alpha": 0}, "alpha must lie in"),
    ({"samples": 10}, "samples must be a whole number >= 100"),
    ({"dimensions": 0}, "dimensions must be a whole number >= 1"),
    ({"precision": "float16"}, "precision must be"),
    ({"atoms": {0.5: 1.5}}, "must be a probability"),
    ({"resolution": 2}, "resolution must lie in"),
    ({"mean_cosine": 0.5}, "axis must be given"),
]


@pytest.mark.parametrize(("arguments", "message"), BAD_ARGUMENTS)
def test_bad_arguments_are_explained(arguments, message):
    options = {"dimensions": 1, **arguments}
    with pytest.raises(InvalidValueError, match=message):
        check_sampler(lambda u: u[:, 0], lambda x: np.ones(len(x)), Interval(0, 1), **options)


def test_a_verdict_is_json_ready_and_speaks():
    import json

    sample, pdf, domain, options = RIGHT["atom at infinity"]
    verdict = check_sampler(sample, pdf, domain, samples=N, **options)
    assert json.loads(json.dumps(verdict.to_dict(), allow_nan=False))["outcome"] == verdict.outcome
    assert "would have been caught with probability 0.99" in str(verdict)
    assert f"seed {verdict.seed}" in str(verdict)
