"""Invariant: right images pass whatever their noise, precision and format; planted errors are found, and named where they are what
they look like; what cannot be an image of the scene is one named error or finding."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from fogproof import Film, HenyeyGreenstein, ImageScene, Medium, OneRay, Perspective, PointLight, Schlick
from fogproof.analytic import image
from fogproof.checks import fresh_seed
from fogproof.cli.commands import cli
from fogproof.errors import FogproofError
from fogproof.images.compare import compare_image, compare_renders
from fogproof.images.formats import format_of, layers
from fogproof.images.pairs import compare_pictures
from fogproof.images.picture import RenderedImage, read_picture
from fogproof.images.residuals import residuals
from fogproof.images.unlike import one_unlike
from fogproof.reports import prepare_folder
from fogproof.scene.files import read_image_scene
from fogproof.scene.lights import DirectionalLight
from fogproof.scene.shapes import Slab

LAMP = PointLight((0.6, 0.8, 4.0), 5.0)
SCENE = ImageScene(
    Medium(0.02, 0.08, HenyeyGreenstein(0.6)),
    Perspective((0, 0, 0), (0, 0, 1), 0.7, Film(64, 48), wall=10.0),
    "single",
    LAMP,
)
SLAB = ImageScene(Medium(0.7, 0.0), OneRay((0, 0, 0), (0, 0, 1), Film(40, 40), wall=2.0), background=1.0)


@pytest.fixture(scope="module")
def truth():
    return image(SCENE)


@pytest.fixture
def rng():
    seed = fresh_seed()
    print(f"seed {seed}")
    return np.random.default_rng(seed)


@pytest.fixture
def compared(tmp_path, truth):
    def run(value, *, scene=SCENE, dtype=np.float32, suffix="exr", variance=None, reference=None, **options):
        paths = []
        for i, one in enumerate(value if isinstance(value, list) else [value]):
            path, channels = tmp_path / f"a{i}.{suffix}", layers(one.astype(dtype))
            if dtype == np.float16:
                write_half(path, channels)
            else:
                more = {} if variance is None else {f"variance.{k}": v for k, v in layers(variance).items()}
                format_of(path).write(path, channels | more)
            paths.append(path)
        given = reference or (truth if scene is SCENE else image(scene))
        return compare_image(paths, scene, reference=given, **options)

    return run


def write_half(path, channels):
    import OpenEXR

    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {name: np.ascontiguousarray(pixels) for name, pixels in channels.items()}).write(str(path))


def noisy(value, rng, size=0.02):
    return value * (1 + size * rng.standard_normal(value.shape))


@pytest.mark.parametrize("dtype", [np.float16, np.float32])
def test_a_right_image_without_noise_passes(compared, truth, dtype):
    done = compared(truth.value, dtype=dtype)
    assert done.verdict.outcome == "not rejected"
    assert done.verdict.resolution.value < (2e-3 if dtype == np.float16 else 1e-4)


@pytest.mark.parametrize("suffix", ["exr", "npy", "pfm"])
def test_a_right_image_with_noise_passes_in_every_format(compared, truth, rng, suffix):
    done = compared(noisy(truth.value, rng), suffix=suffix)
    assert done.verdict.outcome == "not rejected", str(done.verdict)
    assert done.verdict.resolution.value < 5e-3
    ((name, ratio, interval),) = done.ratios
    assert name == "Y"
    assert interval.low < ratio < interval.high


def test_a_bias_of_a_thousandth_is_found(compared, truth, rng):
    done = compared(noisy(1.001 * truth.value, rng, 0.002))
    assert done.verdict.outcome == "rejected"
    assert done.verdict.cause == "factor"
    assert "1.001" in done.verdict.diagnosis or "1.000" in done.verdict.diagnosis


def test_an_image_without_noise_off_by_one_in_ten_thousand_is_found(compared, truth):
    assert compared(1.0001 * truth.value, explain=False).verdict.outcome == "rejected"
    assert compared(1.0001 * truth.value, tolerance=2e-4).verdict.outcome == "not rejected"


def planted():
    scene, medium = SCENE, SCENE.medium

    def of(**changed):
        return lambda: image(replace(scene, **changed)).value

    k = 1.55 * 0.6 - 0.55 * 0.6**3
    yield "schlick-for-henyey-greenstein", of(medium=replace(medium, phase=Schlick(k))), f"{k:.4g}"
    yield "wrong-sign-of-g", of(medium=replace(medium, phase=HenyeyGreenstein(-0.6))), "-0.6 for 0.6"
    yield "wrong-g", of(medium=replace(medium, phase=HenyeyGreenstein(0.5))), "g = 0."


@pytest.mark.parametrize(("cause", "make", "words"), list(planted()), ids=lambda x: x if isinstance(x, str) else "")
def test_another_scene_is_named_with_its_fit(compared, rng, cause, make, words):
    done = compared(noisy(make(), rng, 0.01))
    assert done.verdict.outcome == "rejected"
    assert done.verdict.cause == cause, done.verdict.diagnosis
    assert words in done.verdict.diagnosis


def changed_pixels():
    yield "factor", lambda x: x / (4 * np.pi), "1/(4 pi)"
    yield "factor", lambda x: x / 0.08, "1/sigma_s"
    yield "flipped-columns", lambda x: x[:, ::-1], "mirrored"
    yield "shifted", lambda x: np.roll(x, 1, 1), "to the right"
    yield "tone-curve", lambda x: np.clip(1.055 * np.maximum(x, 0.0031308) ** (1 / 2.4) - 0.055, 0, 1), "sRGB"
    yield "clamped", lambda x: np.minimum(x, 0.04), "cut off at 0.0"


@pytest.mark.parametrize(
    ("cause", "change", "words"), list(changed_pixels()), ids=lambda x: x if isinstance(x, str) else ""
)
def test_changed_pixels_are_named(compared, truth, rng, cause, change, words):
    done = compared(noisy(change(truth.value), rng, 0.005))
    assert done.verdict.outcome == "rejected"
    assert done.verdict.cause == cause, done.verdict.diagnosis
    assert words in done.verdict.diagnosis


def test_a_black_image_is_black(compared, truth):
    verdict = compared(0 * truth.value).verdict
    assert (verdict.outcome, verdict.cause) == ("rejected", "black")


def test_black_is_no_fault_where_no_path_may_have_come_through(compared):
    scene = replace(SLAB, medium=Medium(7.0, 0.0))  # one path in 10^6
    verdict = compared(np.zeros((40, 40)), scene=scene).verdict
    assert verdict.outcome == "inconclusive"


def test_hits_and_misses_are_judged_exactly(compared, rng):
    hit = np.exp(-1.4)
    right = (rng.random((40, 40)) < hit).astype(float)
    assert compared(right, scene=SLAB).verdict.outcome == "not rejected"
    wrong = (rng.random((40, 40)) < 1.8 * hit).astype(float)
    assert compared(wrong, scene=SLAB, explain=False).verdict.outcome == "rejected"


def test_heavy_tails_are_never_a_false_alarm_and_their_excess_is_still_seen(compared, truth, rng):
    def tail():  # mean 1, no variance
        return (rng.pareto(1.3, truth.value.shape) + 1) * (0.3 / 1.3)

    assert compared(truth.value * tail()).verdict.outcome in ("not rejected", "inconclusive")
    assert compared(2 * truth.value * tail(), explain=False).verdict.outcome == "rejected"


def test_coloured_scenes_are_compared_channel_by_channel(compared, rng):
    scene = replace(SCENE, light=replace(LAMP, intensity=(5.0, 3.0, 1.0)))
    value = image(scene).value
    assert compared(noisy(value, rng), scene=scene).verdict.outcome == "not rejected"
    wrong = compared(noisy(value * [1, 1.1, 1], rng), scene=scene).verdict
    assert (wrong.outcome, wrong.cause) == ("rejected", "channel")
    assert "channel G is 1.1" in wrong.diagnosis or "channel G is 1.09" in wrong.diagnosis
    swapped = compared(noisy(value[..., ::-1], rng), scene=scene).verdict
    assert swapped.cause == "channels-exchanged"
    with pytest.raises(FogproofError, match="the scene has 3 channels"):
        compared(value[..., 0], scene=scene)


def test_a_grey_scene_in_colour_is_one_channel_if_all_are_the_same(compared, truth, rng):
    value = noisy(truth.value, rng)
    done = compared(np.repeat(value[..., None], 3, axis=2))
    assert done.picture.names == ("R",)
    assert done.verdict.outcome == "not rejected"


def test_numbers_that_are_none_are_findings_and_the_rest_is_compared(compared, truth, rng):
    value = noisy(truth.value, rng)
    value[3, 5], value[4, 4] = np.nan, np.inf
    verdict = compared(value).verdict
    assert (verdict.outcome, verdict.cause) == ("rejected", "no-number")
    assert "1 NaN, 1 infinite of 3072 values, the first at row 3, column 5" in str(verdict)
    assert all(f.outcome == "not rejected" for f in verdict.findings if f.check != "numbers")


def test_negative_pixels_are_told(compared, truth, rng):
    value = noisy(truth.value, rng, 0.3)
    value[0, 0] = -1e-3
    verdict = compared(value).verdict
    assert verdict.outcome == "not rejected"
    assert "values are negative" in str(verdict)


def test_eight_bits_are_found_and_integers_refused(compared, truth, tmp_path):
    value = np.round(255 * np.clip(truth.value / truth.value.max(), 0, 1)) / 255
    verdict = compared(value, explain=False).verdict
    assert (verdict.outcome, verdict.cause) == ("rejected", "8-bit")
    np.save(tmp_path / "b.npy", np.zeros((48, 64), np.uint8))
    with pytest.raises(FogproofError, match="8-bit and tone-mapped"):
        compare_image([tmp_path / "b.npy"], SCENE, reference=truth)


def test_a_wrong_size_is_named(compared, truth):
    with pytest.raises(
        FogproofError, match="48 x 64 pixels, the scene's film has 64 x 48; rows and columns are exchanged"
    ):
        compared(truth.value.T)


def test_the_whole_film_is_cropped(compared, truth, rng):
    crop = Perspective((0, 0, 0), (0, 0, 1), 0.7, Film(64, 48, (10, 5, 40, 30)), wall=10.0)
    assert compared(noisy(truth.value, rng), scene=replace(SCENE, camera=crop)).verdict.outcome == "not rejected"


def test_renders_that_are_all_the_same_have_no_noise(compared, truth):
    off = truth.value.copy()
    off[7, 9] *= 1.001
    verdict = compared([off, off], explain=False).verdict
    assert verdict.outcome == "rejected"
    assert "most at row 7, column 9" in str(verdict)


def test_equal_renders_with_noise_are_no_independent_renders(compared, truth, rng):
    """Two copies of one noisy right image scatter not at all: as renders of a seed each they would be certain to be wrong."""
    one, other = noisy(truth.value, rng), noisy(truth.value, rng)
    for renders in ([one, one], [one, other, one]):
        with pytest.raises(FogproofError, match=rf"a0.exr and \S*a{len(renders) - 1}.exr are the same pixel by pixel"):
            compared(renders)
    picture = RenderedImage(
        np.stack([one, one])[..., None], None, (1e-8, 1e-45), ("Y",), ()
    )  # of a program, without files
    verdict = compare_renders(picture, SCENE, reference=truth).verdict
    assert verdict.outcome != "rejected"
    assert any("they count as one" in note for note in verdict.unchecked)
    wrong = replace(picture, renders=1.5 * picture.renders)
    assert compare_renders(wrong, SCENE, reference=truth, explain=False).verdict.outcome == "rejected"


def test_what_of_a_file_is_not_looked_at_is_said(tmp_path, compared, truth, rng):
    done = compared(noisy(truth.value, rng), variance=np.where(np.arange(64) < 60, 1.0, np.nan) * np.ones((48, 1)))
    assert done.picture.variance is None
    assert "192 values of its variance layers are negative or NaN: they are not used" in str(done.verdict)
    format_of("a.npy").write(tmp_path / "a.npy", {f"C{i}": noisy(truth.value, rng) for i in range(5)})
    verdict = compare_image([tmp_path / "a.npy"], SCENE, reference=truth).verdict
    assert "channels that are not looked at: C3, C4" in verdict.unchecked
    format_of("a.exr").write(tmp_path / "a.exr", {"foo": truth.value})
    with pytest.raises(FogproofError, match=r"has channels foo; an image has Y, or R, G and B"):
        compare_image([tmp_path / "a.exr"], SCENE, reference=truth)


def test_channels_are_taken_by_their_number(tmp_path):
    bands = {f"C{i}": np.full((4, 4), float(i), np.float32) for i in range(12)}
    for suffix in ("npy", "exr"):
        format_of(f"a.{suffix}").write(tmp_path / f"a.{suffix}", bands)
        assert read_picture([tmp_path / f"a.{suffix}"], None, 12).value[0, 0].tolist() == list(range(12))


@pytest.mark.parametrize(
    ("size", "words"), [(1e36, "is the file's order of bytes right"), (1e300, "count as infinite")]
)
def test_numbers_that_no_radiance_has_are_told_without_a_warning(compared, truth, rng, size, words, recwarn):
    value = noisy(truth.value, rng)
    value[3, 5] = size
    assert words in str(compared(value, dtype=np.float64, suffix="npy", explain=False).verdict)
    assert not recwarn.list


@pytest.mark.parametrize("copies", [1, 2])
@pytest.mark.parametrize("size", [0.0, 1e-220])
def test_noise_beside_next_to_nothing_is_no_overflow(truth, rng, size, copies, recwarn):
    dark = replace(truth, value=size * truth.value, error=0 * truth.value)
    renders = np.stack([rng.random((48, 64, 1)) for _ in range(copies)])
    picture = RenderedImage(renders, None, (1e-8, 1e-45), ("Y",), ())
    compare_renders(picture, SCENE, reference=dark, explain=False)
    assert not recwarn.list


def test_pixels_that_share_random_numbers_are_recognised(compared, truth, rng):
    renders = [
        truth.value * (1 + 0.1 * rng.standard_normal()) * (1 + 0.01 * rng.standard_normal((48, 64))) for _ in range(24)
    ]
    done = compared(renders)
    assert done.dependence.kind == "shared"
    assert done.verdict.outcome != "rejected"
    assert compared([3 * x for x in renders], explain=False).verdict.outcome == "rejected"
    assert compared(renders[:1], correlated=True).verdict.outcome == "inconclusive"


def test_filtered_noise_is_recognised_and_no_false_alarm(compared, truth, rng):
    from scipy.ndimage import gaussian_filter

    noise = gaussian_filter(rng.standard_normal((48, 64)), 1.0)
    done = compared(truth.value * (1 + 0.1 * noise))
    assert done.dependence.kind == "neighbours"
    assert done.verdict.outcome != "rejected"


def test_two_images_are_compared_without_an_oracle(tmp_path, truth, rng):
    for name, value in {
        "a": noisy(truth.value, rng),
        "b": noisy(truth.value, rng, 0.05),
        "c": noisy(1.05 * truth.value, rng),
        "d": noisy(truth.value, rng),
    }.items():
        format_of("x.exr").write(tmp_path / f"{name}.exr", layers(value))
    a, b, c, d = (tmp_path / f"{name}.exr" for name in "abcd")
    assert compare_pictures([a], [b]).verdict.outcome == "not rejected"
    assert compare_pictures([a], [d]).verdict.outcome == "not rejected"
    assert compare_pictures([a], [c]).verdict.outcome == "rejected"


def test_variance_layers_scale_the_map(compared, truth, rng):
    from fogproof.images.maps import maps

    value = noisy(truth.value, rng, 0.1)
    done = compared(value, variance=(0.1 * truth.value) ** 2)
    z = maps(done.picture, done.found).z
    assert 0.9 < np.std(z) < 1.1


def test_the_command_writes_a_verdict_a_page_and_maps(tmp_path, truth, rng):
    scene = tmp_path / "scene.toml"
    lamp = Path(__file__).parents[2] / "scenes" / "images" / "lamp-inside-forward.toml"
    scene.write_text(lamp.read_text().replace("width = 48, height = 36", "width = 32, height = 24"))
    out, folder = tmp_path / "a.exr", tmp_path / "report"

    def run(*words):
        return CliRunner().invoke(cli, [str(word) for word in words], standalone_mode=False)

    assert run("oracle", scene, "-o", out).exception is None
    ran = run("compare", out, scene, "--report", folder)
    assert ran.return_value == 0, ran.output
    assert "mean of Y / reference: 1" in ran.output
    record = json.loads((folder / "results.json").read_text())
    assert record["verdict"]["outcome"] == "not rejected"
    assert {path.name for path in (folder / "figures").iterdir()} >= {
        "image.png",
        "reference.png",
        "z-map.png",
        "p-values.png",
    }
    assert set(format_of("maps.exr").read(folder / "maps.exr")) == {"z.Y", "ratio.Y", "reference.Y"}
    page = (folder / "index.html").read_text()
    assert page.count("<img") == 3
    assert page.index("<img") < page.index('<h2 id="cases">Verdict')  # the pictures are the first that is seen
    assert '<h1 class="good">' in page
    assert "A relative bias of the image above " in page
    prepare_folder(folder, ("index.html", "results.json", "maps.exr"))  # it is seen to be ours
    channels = format_of(out).read(out)
    format_of(out).write(out, {"Y": 1.1 * channels["Y"]})
    ran = run("compare", out, scene, "--json")
    assert ran.return_value == 1
    assert json.loads(ran.output)["verdict"]["cause"] == "factor"
    assert isinstance(run("compare", out).exception, Exception)


def test_right_images_are_rejected_as_rarely_as_promised(truth, rng):
    # 60 images of each law at alpha 0.05, which a right test rejects with that probability at most.
    from fogproof.images.pooled import pooled_tests
    from fogproof.images.residuals import Residuals

    small = truth.value[::2, ::2, None]
    laws = {
        "normal": lambda: 0.3 * rng.standard_normal(small.shape),
        "hits": lambda: (rng.random(small.shape) < 0.3) / 0.3 - 1,
        "exponential": lambda: rng.exponential(size=small.shape) - 1,
        "lognormal": lambda: np.exp(rng.standard_normal(small.shape) - 0.5) - 1,
    }
    for name, law in laws.items():
        rejected = 0
        for _ in range(60):
            d = small * law()
            found = Residuals(d, 1e-6 * small, small, np.ones(small.shape[:2], bool))
            rejected += any(f.outcome == "rejected" for f in pooled_tests(found, 0.05, ("Y",))[0])
        assert rejected <= 15, name  # P(more than 15 of 60 at 0.05) = 5e-8


def test_differences_within_what_is_allowed_are_no_riddle(compared, truth, rng):
    # Single precision is off by about 1e-5 in some pixels and by nothing in most: skewed, and no noise.
    value = truth.value * (1 + 3e-5 * (rng.random(truth.value.shape) < 0.02))
    assert compared(value).verdict.outcome == "not rejected"


def test_one_order_too_many_is_named_with_its_ratio():
    """Light that a path tracer has scattered twice (`sun`, 1024 paths a pixel) is no tone curve."""
    here = Path(__file__).parents[1]
    done = compare_image(
        [here / "data" / "sun-two-orders.npy"], read_image_scene(here.parent / "scenes/images/sun.toml")
    )
    assert done.verdict.cause == "one-order-too-many", done.verdict.diagnosis
    assert "one scattering order too many, ratio 1.9" in done.verdict.diagnosis


def test_orders_that_are_missing_are_named(compared, rng):
    scene = ImageScene(
        Medium(0.2, 1.8),
        Perspective((0, 0, -3), (0.8, 0.3, 0), 0.9, Film(40, 30)),
        "multiple",
        DirectionalLight((0.6, 0.0, 0.8), 3.0),
        Slab((0, 0, 0), (0, 0, -1), 1.0),
    )
    single = replace(scene, scattering="single")
    few = compared(noisy(image(single).value, rng, 0.01), scene=scene)
    assert (few.verdict.outcome, few.verdict.cause) == ("rejected", "one-order-too-few"), few.verdict.diagnosis
    many = compared(noisy(image(scene).value, rng, 0.01), scene=single)
    assert (many.verdict.outcome, many.verdict.cause) == ("rejected", "all-orders"), many.verdict.diagnosis


def test_scattering_without_its_g_is_called_isotropic(compared, rng):
    flat = image(replace(SCENE, medium=replace(SCENE.medium, phase=HenyeyGreenstein(0.0)))).value
    done = compared(noisy(flat, rng, 0.01))
    assert done.verdict.cause == "isotropic", done.verdict.diagnosis


def test_depth_for_distance_is_named(compared, rng):
    scene = ImageScene(Medium(0.4, 0.0), Perspective((0, 0, 0), (0, 0, 1), 1.5, Film(40, 30), wall=4.0), background=2.0)
    flat = np.full((30, 40), 2.0 * np.exp(-0.4 * 4.0))
    done = compared(noisy(flat, rng, 0.005), scene=scene)
    assert done.verdict.cause == "depth-for-distance", done.verdict.diagnosis


@pytest.mark.parametrize("odd", [1.3, 1.01, 0.0, 1.0])
def test_one_render_unlike_the_others_does_not_hide_in_their_scatter(compared, truth, rng, odd):
    """Its own excess makes the means of renders scatter, so that their test alone sees nothing."""
    renders = [noisy(truth.value, rng, 0.001) for _ in range(5)] + [noisy(truth.value, rng, 0.001) * odd]
    done = compared(renders)
    unlike = [f for f in done.verdict.findings if f.check == "one render unlike the others"]
    assert done.verdict.outcome == ("not rejected" if odd == 1 else "inconclusive"), str(done.verdict)
    assert [f.effect for f in unlike] == ([] if odd == 1 else [pytest.approx(odd - 1, abs=1e-3)])


def test_right_renders_are_seldom_called_unlike():
    """At 1 in 20: the deleted residual has Student's law, and Bonferroni's sum is nearly sharp."""
    rng, called = np.random.default_rng(), 0
    for _ in range(2000):
        renders = 1 + 0.1 * rng.normal(size=(6, 1, 1, 1)) + 0.01 * rng.normal(size=(6, 4, 4, 1))
        picture = RenderedImage(renders, None, (0.0, 0.0), ("Y",), ())
        called += one_unlike(picture, residuals(picture, 1 + 0 * renders[0], 0 * renders[0], 0.0), 0.05) is not None
    assert 50 < called < 150
