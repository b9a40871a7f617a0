"""Mitsuba's plugins as subjects: what is right passes, what is known to be wrong is found, in either variant."""

import os

import numpy as np
import pytest

pytest.importorskip("mitsuba")

from fogproof.adapters.mitsuba import MitsubaBSDF, MitsubaPhase, runtime
from fogproof.analytic import phase_pdf
from fogproof.catalogue import all_cases
from fogproof.checks import check_sampler
from fogproof.domains import UnitSphere
from fogproof.errors import SubjectError
from fogproof.scene import HenyeyGreenstein, Mixture

CASES = {case.name.removeprefix("mitsuba/"): case for case in all_cases() if case.name.startswith("mitsuba/")}
RIGHT = (
    "phase/blendphase/nested/axis-1",
    "bsdf/diffuse/50",
    "emitter/rectangle/near",
    "medium/heterogeneous/trilinear",
)
WRONG = {
    "phase/sggx/plate/axis-1": "labels",
    "bsdf/roughdielectric/ggx/alpha=0.4/whole/50": "weight",
    "bsdf/roughplastic/ggx/50": "labels",
    "warp/beckmann/0.3": "edge uniforms",
    "warp/rough_fiber/20": "normalisation",
}


@pytest.mark.parametrize("name", RIGHT)
def test_what_is_right_passes_and_its_twin_does_not(name):
    assert CASES[name].run(1e-6, 1, 60_000).outcome == "not rejected"
    assert CASES[name].run(1e-9, 1, 20_000, twin=True).outcome == "rejected"


@pytest.mark.parametrize("name", WRONG)
def test_what_is_known_to_be_wrong_is_found(name):
    verdict = CASES[name].run(1e-9, 1, 20_000)
    if "roughplastic" in name and not runtime.vectorised():  # scalar variants have no density below the surface
        assert (CASES[name].expected, verdict.outcome) == ("not rejected", "not rejected"), verdict
        return
    assert CASES[name].expected == "rejected"
    assert WRONG[name] in {f.check for f in verdict.findings if f.outcome == "rejected"}, verdict


@pytest.mark.parametrize("vectorised", [True, False])
def test_both_variants_give_the_same_numbers(monkeypatch, vectorised):
    if vectorised and not runtime.vectorised():
        pytest.skip("no libLLVM that Dr.Jit can use: set DRJIT_LIBLLVM_PATH")
    monkeypatch.setattr(runtime, "vectorised", lambda: vectorised)
    weight = {"type": "constvolume", "value": 0.25}
    plugin = {"type": "blendphase", "weight": weight, "a": {"type": "hg", "g": 0.7}, "b": {"type": "hg", "g": -0.3}}
    axis = (2 / 7, -3 / 7, 6 / 7)
    sampler = MitsubaPhase(plugin, axis)
    draw = sampler.sample(np.random.default_rng(0).random((50, 3), dtype=np.float32))
    ours = Mixture((HenyeyGreenstein(0.7), HenyeyGreenstein(-0.3)), (0.75, 0.25))
    right = phase_pdf(ours, np.clip(draw.x @ np.array(axis), -1, 1)).value
    np.testing.assert_allclose(sampler.pdf(draw.x), right, rtol=1e-4)
    np.testing.assert_allclose(draw.pdf, right, rtol=1e-4)
    np.testing.assert_allclose(draw.weight, 1, rtol=1e-4)
    metal = MitsubaBSDF({"type": "roughconductor", "alpha": 0.4}, (0.6, 0.0, 0.8))
    drawn = metal.sample(np.random.default_rng(0).random((50, 3), dtype=np.float32))
    assert drawn.weight.shape == (50, 3)
    assert metal.pdf(np.empty((0, 3))).shape == (0,)
    monkeypatch.undo()
    runtime.load()


def test_arrays_of_drjit_are_read_or_told_what_to_do():
    """(3, n) vectors and constants are named with the fix; tensors and numbers are taken as they are."""
    if not runtime.vectorised():
        pytest.skip("no libLLVM that Dr.Jit can use: set DRJIT_LIBLLVM_PATH")
    mi = runtime.load()

    def points(u):
        columns = (mi.Float(np.ascontiguousarray(c)) for c in u.T)
        return mi.warp.square_to_uniform_sphere(mi.Point2f(*columns))

    def uniform(x):
        return mi.Float(np.full(len(x), 1 / (4 * np.pi)))

    def check(sample, pdf):
        return check_sampler(sample, pdf, UnitSphere(), dimensions=2, precision="float32", samples=20_000)

    assert check(lambda u: np.array(points(u)).T, uniform).outcome == "not rejected"
    assert check(lambda u: mi.TensorXf(np.array(points(u)).T.copy()), uniform).outcome == "not rejected"
    with pytest.raises(SubjectError, match="transpose it: one point a row"):
        check(points, uniform)
    with pytest.raises(SubjectError, match="one value a point"):
        check(lambda u: np.array(points(u)).T, lambda x: mi.Float(1 / (4 * np.pi)))


@pytest.mark.parametrize(
    ("names", "usable"), [((), False), (("libLLVM-14.so.1",), False), (("libLLVM-15.so", "libLLVM.so.19.1"), True)]
)
def test_an_llvm_that_ends_the_process_is_not_taken(tmp_path, monkeypatch, names, usable):
    for name in names:
        (tmp_path / name).touch()
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
    monkeypatch.setattr(runtime, "_PLACES", (f"{tmp_path}/",))
    assert runtime.vectorised.__wrapped__() == usable
    assert os.environ.get("DRJIT_LIBLLVM_PATH", "").endswith("19.1") == usable
    monkeypatch.delenv("DRJIT_LIBLLVM_PATH", raising=False)
