"""One render that is given twice, by its name, by a link or stored another way, is no second one; independent renders are two."""

import os

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter

from fogproof.checks import fresh_seed
from fogproof.errors import FogproofError
from fogproof.images.compare import compare_image
from fogproof.images.copies import nearly_copies
from fogproof.images.formats import format_of, layers
from fogproof.images.pairs import compare_pictures
from fogproof.scene.files import read_image_scene

SHAPE = (36, 48)


@pytest.fixture
def rng():
    return np.random.default_rng(fresh_seed())


def smooth():
    y, x = np.mgrid[: SHAPE[0], : SHAPE[1]] / 40
    return 1.5 + np.sin(2 * x) * np.cos(3 * y)


def gaussian(rng, size=0.02):
    return smooth() * (1 + size * rng.standard_normal(SHAPE))


def cut_off(x):
    half = x.astype(np.float16)
    return np.where(half > x, np.nextafter(half, np.float16(0)), half).astype(float)


NOISY = {
    "plain": gaussian,
    "a thousandth": lambda rng: gaussian(rng, 1e-3),
    "large": lambda rng: smooth() * rng.exponential(size=SHAPE),
    "dark": lambda rng: 1e-9 * gaussian(rng),
    "filtered": lambda rng: smooth() * (1 + 0.2 * gaussian_filter(rng.standard_normal(SHAPE), 1.0)),
    "rare": lambda rng: np.where(rng.random(SHAPE) < 0.1, rng.exponential(size=SHAPE), 0.0),
    "hits": lambda rng: (rng.random(SHAPE) < 0.3) * 1.0,
}
STORED = {
    "half": lambda x, rng: x.astype(np.float16).astype(float),
    "half, cut off": lambda x, rng: cut_off(x),
    "summed in another order": lambda x, rng: x * (1 + 1e-7 * rng.standard_normal(SHAPE)),
    "six digits": lambda x, rng: np.vectorize(lambda v: float(f"{v:.6g}"))(x),
}


@pytest.mark.parametrize("way", STORED.values(), ids=STORED)
@pytest.mark.parametrize("noise", ["plain", "large", "filtered", "rare"])
def test_one_render_stored_another_way_is_a_copy(rng, noise, way):
    one = np.float32(NOISY[noise](rng)).astype(float)
    assert nearly_copies(one[..., None], way(one, rng)[..., None])


@pytest.mark.parametrize("kind", [np.float32, np.float16])
@pytest.mark.parametrize("noise", NOISY.values(), ids=NOISY)
def test_independent_renders_are_none(rng, noise, kind):
    one, other = (kind(noise(rng)).astype(float)[..., None] for _ in range(2))
    assert not nearly_copies(one, other)
    assert not nearly_copies(one, other, smooth()[..., None])


def test_what_has_no_noise_is_none(rng):
    """Two programs without noise agree to rounding, as they ought to."""
    disc = (np.hypot(*np.mgrid[-18:18, -24:24]) < 12) * 1.0
    for value in (smooth(), disc, np.ones(SHAPE), np.repeat(np.repeat(rng.random((9, 12)), 4, 0), 4, 1)):
        for way in STORED.values():
            assert not nearly_copies(value[..., None], way(value, rng)[..., None])


@pytest.fixture
def written(tmp_path):
    def write(name, value, kind=np.float32):
        format_of(name).write(tmp_path / name, layers(np.asarray(value, kind)))
        return tmp_path / name

    return write


SCENE = """
scattering = "none"
background = 1.5
medium = { sigma_a = 0.0, sigma_s = 0.0 }
camera = { kind = "perspective", origin = [0, 0, 0], target = [0, 0, 1], fov = 0.7, film = { width = 48, height = 36 } }
"""


def test_one_file_given_twice_is_refused(tmp_path, written, rng):
    a, b = (written(f"{name}.npy", gaussian(rng)) for name in "ab")
    (tmp_path / "scene.toml").write_text(SCENE)
    scene = read_image_scene(tmp_path / "scene.toml")
    (tmp_path / "soft.npy").symlink_to(a)
    os.link(a, tmp_path / "hard.npy")
    for same in (a, tmp_path / "." / "a.npy", tmp_path / "soft.npy", tmp_path / "hard.npy"):
        for compared in (
            lambda *two: compare_image(two, scene),
            lambda *two: compare_pictures(two, [b]),
            lambda *two: compare_pictures(two[:1], two[1:]),
        ):
            with pytest.raises(FogproofError, match=r"given twice|are one file"):
                compared(a, same)


def test_one_render_on_both_sides_says_nothing(written, rng):
    one = gaussian(rng)
    a, b = written("a.npy", one), written("b.npy", gaussian(rng))
    assert compare_pictures([a], [b]).verdict.outcome == "not rejected"
    for name, kind, words in (
        ("same.npy", np.float32, "are the same pixel by pixel"),
        ("half.npy", np.float16, "differ by rounding alone"),
    ):
        verdict = compare_pictures([a, b], [written(name, one, kind)]).verdict
        assert verdict.outcome == "inconclusive"
        assert words in str(verdict)
    still = written("still.npy", smooth())
    assert compare_pictures([still], [written("again.npy", smooth())]).verdict.outcome == "not rejected"


def test_copies_count_as_one_render(tmp_path, written, rng):
    """The noise of a right render shows how its pixels depend on each other; by that of rounding they would not."""
    (tmp_path / "scene.toml").write_text(SCENE)
    scene = read_image_scene(tmp_path / "scene.toml")
    value = 1.5 * (1 + 0.5 * gaussian_filter(rng.standard_normal(SHAPE), 1.0))
    files = [written("a.npy", value), written("b.npy", value, np.float16)]
    done, alone = compare_image(files, scene), compare_image(files[:1], scene)
    assert (len(done.picture.renders), done.dependence.kind) == (1, alone.dependence.kind) == (1, "neighbours")
    assert "differ by rounding alone: they count as one render" in str(done.verdict)
    assert done.verdict.outcome == alone.verdict.outcome
