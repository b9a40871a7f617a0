"""An order is told where the error falls like a power of the count: not on its way to a level, nor where it rises to one."""

import numpy as np
import pytest
from study_levels import MEAN, Law, cell, level

from fogproof.study.measures import measure
from fogproof.study.methods import table as methods

COUNTS = (100, 1000, 4000, 10_000)


class Declared(Law):
    bias = "by construction"


def order(monkeypatch, bias, noise=0.0, counts=COUNTS):
    monkeypatch.setitem(methods.METHODS, "law", Declared)
    one, rng = cell(), np.random.default_rng()
    object.__setattr__(one, "method", Declared(bias))
    levels = [level(MEAN * (1 + bias(n) + noise * rng.normal(size=(32, n)))) for n in counts]
    return measure(one, levels, 1e-9).record["order"]


@pytest.mark.parametrize("noise", [0.0, 1e-4])
@pytest.mark.parametrize("bias", [lambda n: 1 / n + 2e-3, lambda n: min(1e-5 * n, 0.05), lambda n: 100 / n**2 + 1e-3])
def test_what_nears_a_level_has_none(monkeypatch, bias, noise):
    """Its misfit is there to see: a bias scatters less than noise of its size."""
    assert order(monkeypatch, bias, noise) is None


@pytest.mark.parametrize(("power", "noise"), [(1.0, 0.0), (2.0, 0.0), (0.5, 0.0), (1.0, 1e-3), (-0.5, 0.0)])
@pytest.mark.parametrize("counts", [COUNTS, COUNTS[1:]])
def test_what_falls_like_a_power_has_that(monkeypatch, power, noise, counts):
    found = order(monkeypatch, lambda n: 0.5 * (n / 1000) ** -power, noise, counts)
    assert found["low"] <= power <= found["high"]
    assert found["high"] - found["low"] < 0.1


def test_noise_alone_has_one_half(monkeypatch):
    found = order(monkeypatch, lambda n: 0.0, 1.0)
    assert found["low"] <= 0.5 <= found["high"]
    assert 0.1 < found["high"] - found["low"] < 1
