"""Invariant: layers of any kind over a ground send what is stated, within the stated error."""

import numpy as np
import pytest

from fogproof.analytic import (
    layered_brdf,
    layered_btdf,
    layered_emission,
    layered_reflectance,
    layered_transmittance,
    slab_brdf,
    slab_btdf,
    slab_reflectance,
    slab_transmittance,
)
from fogproof.analytic.multiple import layer_stacks
from fogproof.errors import InvalidValueError
from fogproof.oracle import answer
from fogproof.scene import (
    HenyeyGreenstein,
    Isotropic,
    LambertGround,
    LommelSeeligerGround,
    MinnaertGround,
    Rayleigh,
    SlabLayer,
)

MU = np.array([0.05, 0.5, 1.0])
HAZE, AIR = SlabLayer(0.5, 0.95, HenyeyGreenstein(0.6)), SlabLayer(1.0, 0.7, HenyeyGreenstein(0.3))
GROUNDS = [LambertGround(0.4), MinnaertGround(0.8, 2.5), LommelSeeligerGround(0.9, HenyeyGreenstein(0.3))]


def agree(one, other, relative):
    """Two references within both errors, which are small."""
    assert np.all(np.abs(one.value - other.value) <= one.error + other.error)
    assert np.all(one.error <= relative * np.abs(one.value) + 1e-300)


@pytest.mark.parametrize("tau", [0.1, 1e6])
@pytest.mark.parametrize("albedo", [0.3, 1.0])
def test_a_slab_may_be_cut(albedo, tau):
    phase = HenyeyGreenstein(0.6)
    layers = [SlabLayer(share * tau, albedo, phase) for share in (0.3, 0.5, 0.2)]
    agree(layered_reflectance(layers, MU), slab_reflectance(albedo, tau, MU, phase), 1e-8)
    agree(layered_transmittance(layers, MU), slab_transmittance(albedo, tau, MU, phase), 2e-8)


def test_a_slab_may_be_cut_at_any_angle():
    phase = Rayleigh()
    layers = [SlabLayer(0.2, 0.9, phase), SlabLayer(0.0, 0.5), SlabLayer(0.5, 0.9, phase)]
    agree(layered_brdf(layers, 0.5, MU, 1.0), slab_brdf(0.9, 0.7, 0.5, MU, phase, 1.0), 1e-11)
    agree(layered_btdf(layers, 0.5, MU, 1.0), slab_btdf(0.9, 0.7, 0.5, MU, phase, 1.0), 1e-11)


def test_peaked_layers_are_as_wrong_as_they_say():
    phase = HenyeyGreenstein(0.85)
    layers = [SlabLayer(1.2, 0.9, phase), SlabLayer(0.8, 0.9, phase)]
    agree(layered_reflectance(layers, 0.7), slab_reflectance(0.9, 2.0, 0.7, phase), 1e-11)


@pytest.mark.parametrize("ground", [None, *GROUNDS], ids=lambda ground: type(ground).__name__)
def test_another_solver_agrees(ground):
    """PythonicDISORT at 48 streams is good for 1e-8; its modes of the ground are pi times the BRDF's."""
    disort = pytest.importorskip("PythonicDISORT.pydisort").pydisort
    streams, mu0 = 48, 0.45
    chi = np.array([0.6, 0.3])[:, None] ** np.arange(streams + 1.0)
    azimuths = np.pi * (np.arange(64) + 0.5) / 64

    def mode(m):
        def between(mu, incoming):
            out, into = np.abs(np.atleast_1d(mu))[:, None], np.abs(np.atleast_1d(incoming))[None]
            if isinstance(ground, LambertGround):
                return np.full(np.broadcast_shapes(out.shape, into.shape), 0.4) * (m == 0)
            if isinstance(ground, MinnaertGround):
                return 0.8 * 3.5 / 2 * (out * into) ** 1.5 * (m == 0)
            total = 0.0
            for phi in azimuths:
                cosine = np.sqrt((1 - out**2) * (1 - into**2)) * np.cos(phi) - out * into
                density = 0.91 / (4 * np.pi * (1.09 - 0.6 * cosine) ** 1.5)
                total = total + np.pi * 0.9 * density / (out + into) * np.cos(m * phi)
            return total / len(azimuths) * (1 if m == 0 else 2)

        return between

    modes = [] if ground is None else [mode(m) for m in range(24)]
    nodes, up, down, _, radiance = disort(
        np.array([0.5, 1.5]),
        np.array([0.95, 0.7]),
        streams,
        chi,
        mu0,
        1 / mu0,
        0.0,
        NLeg=streams,
        BDRF_Fourier_modes=modes,
    )
    layers = (HAZE, AIR)
    assert layered_reflectance(layers, mu0, ground).value == pytest.approx(float(up(0.0)), rel=2e-8)
    assert layered_transmittance(layers, mu0, ground).value == pytest.approx(float(sum(down(1.5))), rel=2e-8)
    mu = float(nodes[np.argmin(np.abs(nodes - 0.7))])
    i, j = int(np.argmin(np.abs(nodes - mu))), int(np.argmin(np.abs(nodes + mu)))
    azimuth = np.array([0.0, 1.0, 3.0])
    for function, at, depth in ((layered_brdf, i, 0.0), (layered_btdf, j, 1.5)):
        found = function(layers, mu0, mu, azimuth, ground)
        assert np.all(found.error <= 1e-11 * found.value)
        for value, phi in zip(found.value, azimuth, strict=True):
            assert value == pytest.approx(float(radiance(depth, phi)[at]), rel=1e-7)


@pytest.mark.parametrize("ground", [*GROUNDS, LambertGround(1.0)], ids=str)
@pytest.mark.parametrize("layers", [(HAZE, AIR), (SlabLayer(1e6, 1.0, Rayleigh()), AIR)], ids=["thin", "deep"])
def test_what_is_not_reflected_is_what_glows(layers, ground):
    """Kirchhoff: reflectance + emission = 1 where all L_e are 1, and emission is linear in each L_e."""
    glowing = [SlabLayer(one.tau, one.albedo, one.phase, 1.0) for one in layers]
    emitted = layered_emission(glowing, MU, ground, 1.0)
    reflected = layered_reflectance(layers, MU, ground)
    assert np.all(np.abs(reflected.value + emitted.value - 1) <= reflected.error + emitted.error)
    assert np.all(np.abs(reflected.value + emitted.value - 1) <= 1e-13)
    upper, lower, below = (
        layered_emission([glowing[0], layers[1]], MU, ground),
        layered_emission([layers[0], glowing[1]], MU, ground),
        layered_emission(layers, MU, ground, 1.0),
    )
    assert np.allclose(upper.value + lower.value + below.value, emitted.value, rtol=1e-13)


def test_a_bright_ground_lights_itself():
    """Layers that absorb alone over a Lambert ground: all of it in closed form."""
    fog, snow = [SlabLayer(0.3, 0.0), SlabLayer(0.4, 0.0)], LambertGround(0.6)
    mu0, mu = 0.4, np.array([0.2, 1.0])
    found = layered_brdf(fog, mu0, mu, 0.3, snow)
    truth = 0.6 / np.pi * np.exp(-0.7 / mu0 - 0.7 / mu)
    assert np.all(np.abs(found.value - truth) <= found.error)
    assert np.all(found.error <= 1e-11 * truth)
    assert layered_transmittance(fog, mu0, snow).value == pytest.approx(np.exp(-0.7 / mu0), rel=1e-14)
    bright, once = (layered_transmittance([SlabLayer(5.0, 1.0)], mu0, g).value for g in (LambertGround(1.0), None))
    assert once < bright < 1.5


def test_reciprocity():
    layers = (SlabLayer(0.5, 0.95, Rayleigh()), SlabLayer(1.0, 0.7, HenyeyGreenstein(0.1)))
    for ground in (None, *GROUNDS):
        one, other = (layered_brdf(layers, a, b, 0.4, ground) for a, b in ((0.2, 0.9), (0.9, 0.2)))
        assert abs(one.value - other.value) <= one.error + other.error


@pytest.mark.parametrize(
    ("layers", "argument"),
    [([], "layers"), ([1.0], "layers"), (None, "layers"), ([SlabLayer(1.0, 0.5)] * 101, "layers")],
)
def test_what_are_no_layers_is_refused(layers, argument):
    with pytest.raises(InvalidValueError) as raised:
        layered_reflectance(layers, 0.5)
    assert raised.value.argument == argument


@pytest.mark.parametrize(
    ("make", "argument"),
    [
        (lambda: SlabLayer(-1.0, 0.5), "tau"),
        (lambda: SlabLayer(np.inf, 0.5), "tau"),
        (lambda: SlabLayer(1.0, 1.5), "albedo"),
        (lambda: SlabLayer(1.0, 0.5, "fog"), "phase"),
        (lambda: SlabLayer(1.0, 0.5, Isotropic(), -1.0), "emission"),
        (lambda: LambertGround(1.1), "albedo"),
        (lambda: MinnaertGround(0.5, 0.5), "exponent"),
        (lambda: LommelSeeligerGround(0.5, 3), "phase"),
        (lambda: layered_reflectance([HAZE], 0.5, 0.3), "ground"),
        (lambda: layered_emission([HAZE], 0.5, None, -1.0), "ground_emission"),
        (lambda: layered_brdf([HAZE], 0.5, 0.5, np.inf), "azimuth"),
        (lambda: layered_brdf([HAZE], 0.0, 0.5, 0.0), "mu0"),
    ],
)
def test_bad_values_are_named(make, argument):
    with pytest.raises(InvalidValueError) as raised:
        make()
    assert raised.value.argument == argument


def test_many_directions_are_solved_some_at_a_time(monkeypatch):
    layers = [{"tau": 0.5, "albedo": 0.9, "phase": {"kind": "henyey-greenstein", "g": 0.5}}, {"tau": 1, "albedo": 0.7}]
    asked = {
        "layers": layers,
        "mu0": [[0.2], [0.9], [0.4]],
        "mu": [0.1, 0.9, 0.3, 0.1, 1.0],
        "azimuth": [0, 1, 2, 3, 0],
    }
    flux = {"layers": layers, "mu0": [0.3, 0.1, 0.9, 0.3, 1.0]}
    requests = [{"quantity": "layered_brdf", **asked}, {"quantity": "layered_reflectance", **flux}]
    whole = [answer(request) for request in requests]
    monkeypatch.setattr(layer_stacks, "_TOGETHER", 3)
    for request, together in zip(requests, whole, strict=True):
        apart = answer(request)
        assert apart["value"].shape == together["value"].shape
        assert np.all(np.abs(apart["value"] - together["value"]) <= apart["error"] + together["error"])
        assert np.all(apart["value"] != 0)
