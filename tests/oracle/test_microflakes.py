"""Invariant: SGGX flakes scatter as the paper's formulas say, normalised and reciprocal, for oracle and sampler alike."""

import mpmath as mp
import numpy as np
import pytest

from fogproof.analytic import microflake_pdf
from fogproof.errors import InvalidValueError
from fogproof.estimators import MicroflakeDirections
from fogproof.oracle import answer
from fogproof.scene import Medium, Microflakes

W = np.array([2, -3, 6]) / 7
SHEET = Microflakes.along((0.6, 0.0, 0.8), 0.3, "surface")
FIBRE = Microflakes.along((0.6, 0.0, 0.8), 0.4, "fibre")
ANY = Microflakes([[0.8, 0.1, -0.2], [0.1, 0.5, 0.05], [-0.2, 0.05, 0.3]])


def sphere(n, seed=0):
    x = np.random.default_rng(seed).normal(size=(n, 3))
    return x / np.linalg.norm(x, axis=1)[:, None]


def diffuse(flakes):
    return Microflakes(flakes.S, "diffuse")


@pytest.mark.parametrize("flakes", [SHEET, FIBRE, ANY, Microflakes.along((0, 0, 1), 0.01, "surface")])
def test_mirrors_have_the_density_of_the_paper(flakes):
    """D(h)/(4 sigma) with the inverse matrix and the half vector, in 40 digits."""
    x = sphere(60)
    found = microflake_pdf(flakes, W, x)
    own = MicroflakeDirections(flakes, tuple(W)).pdf(x)
    with mp.workdps(40):
        S = mp.matrix(flakes.S.tolist())
        inverse, root = S**-1, mp.sqrt(mp.det(S))
        back = -mp.matrix(W.tolist())
        sigma = mp.sqrt((back.T * S * back)[0])
        for k, o in enumerate(x):
            h = back + mp.matrix(o.tolist())
            h = h / mp.norm(h)
            right = 1 / (mp.pi * root * (h.T * inverse * h)[0] ** 2) / (4 * sigma)
            assert abs(mp.mpf(found.value[k]) - right) <= found.error[k] + 4e-16 * float(right)
            assert abs(own[k] - right) <= 1e-9 * right
    assert np.median(found.error / found.value) < 1e-9


def test_diffuse_balls_scatter_as_a_lambertian_ball():
    """S = 1: 2/(3 pi^2) (sin t + (pi - t) cos t) for the angle t between where light comes from and goes to (Schoenberg 1929)."""
    x = sphere(50)
    found = microflake_pdf(Microflakes(np.eye(3), "diffuse"), W, x)
    t = np.arccos(-(x @ W))
    right = 2 / (3 * np.pi**2) * (np.sin(t) + (np.pi - t) * np.cos(t))
    assert np.all(np.abs(found.value - right) <= found.error + 1e-15)
    assert found.error.max() < 1e-13


@pytest.mark.parametrize("flakes", [SHEET, FIBRE, ANY])
def test_diffuse_flakes_by_the_sum_over_visible_normals(flakes):
    back, (u, v) = -W, np.meshgrid((np.arange(300) + 0.5) / 300, (np.arange(300) + 0.5) / 300)
    normals = []
    for z, phi in zip(2 * u.ravel() - 1, 2 * np.pi * v.ravel(), strict=True):
        normals.append((np.sqrt(1 - z * z) * np.cos(phi), np.sqrt(1 - z * z) * np.sin(phi), z))
    m = np.array(normals)
    D = 1 / (np.pi * np.sqrt(np.linalg.det(flakes.S)) * np.einsum("ni,ij,nj->n", m, np.linalg.inv(flakes.S), m) ** 2)
    seen = np.maximum(m @ back, 0) * D / np.sqrt(back @ flakes.S @ back)
    x = sphere(8, 4)
    right = 4 * np.pi / len(m) * (np.maximum(x @ m.T, 0) @ seen) / np.pi
    found = microflake_pdf(diffuse(flakes), W, x)
    assert np.allclose(found.value, right, rtol=2e-3)
    assert np.max(found.error / found.value) < 1e-10
    own = MicroflakeDirections(diffuse(flakes), tuple(W)).pdf(x)
    assert np.all(np.abs(own - found.value) <= found.error + 1e-9 * found.value)


@pytest.mark.parametrize("flakes", [FIBRE, ANY, diffuse(FIBRE)], ids=["fibre", "any", "diffuse"])
def test_normalised_and_reciprocal(flakes):
    n = 24 if flakes.reflection == "diffuse" else 48
    z, weights = np.polynomial.legendre.leggauss(n)
    phi = (np.arange(2 * n) + 0.5) * np.pi / n
    s = np.sqrt(1 - z * z)[:, None]
    x = np.stack([s * np.cos(phi), s * np.sin(phi), np.broadcast_to(z[:, None], (n, 2 * n))], axis=-1)
    x = x / np.linalg.norm(x, axis=-1)[..., None]
    total = np.sum(weights[:, None] * np.pi / n * microflake_pdf(flakes, W, x).value)
    # Mirrors: straight ahead the density depends on the side that one looks from, so that product rules end at a promille.
    assert abs(total - 1) < (1e-5 if flakes.reflection == "diffuse" else 5e-3)
    o = sphere(20, 9)
    there, back = microflake_pdf(flakes, W, o), microflake_pdf(flakes, -o, -W)
    one, other = (np.sqrt(np.einsum("...i,ij,...j", w, flakes.S, w)) for w in (W, o))
    assert np.allclose(one * there.value, other * back.value, rtol=1e-9)


def test_straight_ahead_the_bound_is_what_any_flake_may_do():
    found = microflake_pdf(SHEET, W, W)
    assert found.value == 0
    near = W + 1e-6 * sphere(200, 3)
    assert np.all(microflake_pdf(SHEET, W, near / np.linalg.norm(near, axis=1)[:, None]).value <= found.error)
    assert microflake_pdf(diffuse(SHEET), W, W).error < 1e-10


def test_the_size_of_the_flakes_does_not_matter():
    x = sphere(20)
    for flakes in (FIBRE, diffuse(FIBRE)):
        right = microflake_pdf(flakes, W, x).value
        for scale in (1e-200, 1e200):
            scaled = Microflakes(scale * flakes.S, flakes.reflection)
            assert np.allclose(microflake_pdf(scaled, W, x).value, right, rtol=1e-12)
            assert np.allclose(MicroflakeDirections(scaled, tuple(W)).pdf(x), right, rtol=1e-8)


def test_mitsuba_has_the_same_mirrors():
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    S = FIBRE.S
    grid = np.float32([S[0, 0], S[1, 1], S[2, 2], S[0, 1], S[0, 2], S[1, 2]]).reshape(1, 1, 1, 6)
    plugin = mi.load_dict({"type": "sggx", "S": {"type": "gridvolume", "grid": mi.VolumeGrid(grid)}})
    event = mi.MediumInteraction3f()
    event.wi = mi.Vector3f(*(-W).tolist())
    event.sh_frame = mi.Frame3f(event.wi)
    event.p, event.t = mi.Point3f(0.5, 0.5, 0.5), 1.0
    x = sphere(40, 6)
    theirs = [plugin.eval_pdf(mi.PhaseFunctionContext(), event, mi.Vector3f(*w.tolist()))[1] for w in x]
    assert np.allclose(microflake_pdf(FIBRE, W, x).value, theirs, rtol=2e-4)


REFUSED = [
    (lambda: Microflakes(np.ones(3)), "S must be a 3 x 3 matrix"),
    (lambda: Microflakes([[1, 0, 0.1], [0, 1, 0], [0, 0, 1]]), "S must be symmetric"),
    (lambda: Microflakes(np.diag([1, 1, 0])), "S must be positive definite"),
    (lambda: Microflakes(np.diag([1, 1, -1])), "S must be positive definite"),
    (lambda: Microflakes(np.diag([1, 1, np.nan])), "S must be finite"),
    (lambda: Microflakes(np.eye(3), "glossy"), "reflection must be 'specular' or 'diffuse'"),
    (lambda: Microflakes.along((0, 0, 1), 0.0, "fibre"), r"roughness must lie in \[1e-4, 1\]"),
    (lambda: Microflakes.along((0, 0, 1), 0.5, "ball"), "shape must be 'fibre' or 'surface'"),
    (lambda: Medium(0.1, 0.9, SHEET), "phase must be a phase function"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_what_is_none_is_refused(make, message):
    with pytest.raises(InvalidValueError, match=message):
        make()


def test_requests():
    request = {
        "quantity": "microflake_pdf",
        "flakes": {"S": SHEET.S.tolist()},
        "w_in": [0, 0, 1],
        "w_out": [0, 0.6, 0.8],
    }
    assert answer(request)["value"] == float(microflake_pdf(SHEET, (0, 0, 1), (0, 0.6, 0.8)).value)
