"""Invariant: a phase function in a scene is valid or refused with the rule it breaks, from Python and from files alike."""

import numpy as np
import pytest

from fogproof.errors import FogproofError, InvalidValueError
from fogproof.scene import (
    DoubleHenyeyGreenstein,
    Draine,
    Hazy,
    HenyeyGreenstein,
    Isotropic,
    Medium,
    Mie,
    Mixture,
    Schlick,
    Tabulated,
)
from fogproof.scene.files import read_fields
from fogproof.scene.phase import PhaseFunctionField

REFUSED = [
    (lambda: HenyeyGreenstein(1.0), r"g must lie in the open interval \(-1, 1\), got 1.0; at the ends"),
    (lambda: DoubleHenyeyGreenstein(0.5, -1, 0.5), "g2 must lie in the open interval"),
    (lambda: DoubleHenyeyGreenstein(0.5, -0.5, 1.5), r"weight must lie in \[0, 1\], got 1.5"),
    (lambda: Schlick(-1.0), r"k must lie in the open interval \(-1, 1\), got -1.0"),
    (lambda: Schlick.from_g(0.95), r"g must keep .* got 0.95; here k = 1.00094"),
    (lambda: Schlick.from_g(-0.99), "g must keep"),
    (lambda: Draine(0.5, -0.1), "alpha must be finite and >= 0, got -0.1"),
    (lambda: Draine(0.5, np.inf), "alpha must be finite"),
    (lambda: Mie(0, 5e-7, 1.3), "diameter must be finite and > 0"),
    (lambda: Mie(1e-6, -5e-7, 1.3), "wavelength must be finite and > 0"),
    (lambda: Mie(1e-6, 5e-7, 1.3 - 0.1j), "refractive_index must be n .* take the conjugate"),
    (lambda: Mie(1e-6, 5e-7, "water"), "refractive_index must be a number"),
    (lambda: Mie(1e-6, 5e-7, complex(1.3, np.nan)), "refractive_index must be a finite number"),
    (lambda: Mie(1e-6, 5e-7, (1, 2, 3)), "refractive_index must be a finite number or a pair"),
    (lambda: Mie(1e-6, 5e-7, 1.3, 1.3), "refractive_index must differ from medium_index"),
    (lambda: Tabulated((-1, 0, 1), (1, 1)), "values must be one number a cosine"),
    (lambda: Tabulated((-1, 0.5), (1, 1)), "cosines must increase from -1 to 1"),
    (lambda: Tabulated((-1, 0.5, 0.5, 1), (1, 1, 1, 1)), "cosines must increase"),
    (lambda: Tabulated((-1, 1), (1, -1)), "values must be finite and >= 0"),
    (lambda: Tabulated((-1, 1), (1, 1)), r"values must integrate to 1 over the sphere, got 12\.56"),
    (lambda: Tabulated.normalised((-1, 1), (0, 0)), "values must have a positive finite integral"),
    (lambda: Mixture((), ()), "components must be a list of phase functions"),
    (lambda: Mixture((0.5,), (1,)), "components must be a list of phase functions"),
    (lambda: Mixture((Hazy(),), (0.5, 0.5)), "weights must be one number a component"),
    (lambda: Mixture((Hazy(), Hazy()), (1.5, -0.5)), "weights must be finite and >= 0"),
    (lambda: Mixture((Hazy(), Hazy()), (0.5, 0.4)), "weights must sum to 1, got 0.9"),
]


@pytest.mark.parametrize(("make", "message"), REFUSED, ids=[m for _, m in REFUSED])
def test_what_is_no_phase_function_is_refused(make, message):
    with pytest.raises(InvalidValueError, match=message):
        make()


def test_schlick_from_g():
    assert Schlick.from_g(0.8).k == pytest.approx(0.9584)
    assert Schlick.from_g(-0.5).k == pytest.approx(-0.70625)
    assert abs(Schlick.from_g(0.9381).k) < 1


def test_a_table_can_be_normalised():
    table = Tabulated.normalised([-1, 0, 1], np.array([1.0, 2.0, 5.0]))
    assert table == Tabulated(table.cosines, table.values)
    assert np.trapezoid(table.values, table.cosines) * 2 * np.pi == pytest.approx(1)
    assert hash(table) == hash(Tabulated(table.cosines, table.values))


FILES = [
    ({"kind": "isotropic"}, Isotropic()),
    ({"kind": "schlick", "k": 0.5}, Schlick(0.5)),
    ({"kind": "mie", "diameter": 1e-6, "wavelength": 5e-7, "refractive_index": 2}, Mie(1e-6, 5e-7, 2)),
    (
        {"kind": "mie", "diameter": 1e-6, "wavelength": 5e-7, "refractive_index": [1.3, 0.1], "medium_index": 1.1},
        Mie(1e-6, 5e-7, 1.3 + 0.1j, 1.1),
    ),
    (
        {"kind": "tabulated", "cosines": [-1, 1], "values": [0, 0.15915494309189535]},
        Tabulated((-1, 1), (0, 0.15915494309189535)),
    ),
    (
        {
            "kind": "mixture",
            "components": [
                {"kind": "hazy"},
                {"kind": "mixture", "components": [{"kind": "isotropic"}], "weights": [1]},
            ],
            "weights": [0.5, 0.5],
        },
        Mixture((Hazy(), Mixture((Isotropic(),), (1,))), (0.5, 0.5)),
    ),
]


@pytest.mark.parametrize(("table", "phase"), FILES, ids=repr)
def test_files_give_the_same(table, phase):
    assert read_fields({"phase": PhaseFunctionField}, {"phase": table}, "request")["phase"] == phase
    assert Medium(0, 1, phase).phase == phase


WRONG = [
    ({"kind": "schlick", "k": 1.5}, "request: k must lie in the open interval .* in phase"),
    ({"kind": "hazi"}, "request: phase has kind 'hazi'; known are"),
    ({"kind": "draine", "g": 0.5}, "request: phase.alpha is missing"),
    ({"kind": "mie", "diameter": 1e-6, "wavelength": 5e-7, "refractive_index": [1.3, -0.1]}, "take the conjugate"),
    (
        {"kind": "mixture", "components": [{"kind": "hazy"}, {"kind": "schlick", "k": 3}], "weights": [0.5, 0.5]},
        "k must lie in .* in phase.components.1",
    ),
]


@pytest.mark.parametrize(("table", "message"), WRONG, ids=repr)
def test_files_are_refused_with_the_place(table, message):
    with pytest.raises(FogproofError, match=message):
        read_fields({"phase": PhaseFunctionField}, {"phase": table}, "request")


@pytest.mark.parametrize("off", [1e-8, -1e-8, 1e-4])
def test_a_table_that_is_not_normalised_is_refused(off):
    with pytest.raises(InvalidValueError, match=r"integrate to 1.*normalised"):
        Tabulated((-1, 1), tuple([(1 + off) / (4 * np.pi)] * 2))
