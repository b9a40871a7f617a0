"""The field's tests, written anew: they pass what is right and reject what they are made for; expected counts are integrals."""

import numpy as np
import pytest
from scipy.stats import chi2

from fogproof.domains import Interval, UnitSphere
from fogproof.reports import prepare_folder
from fogproof.zoo.bug import Planted
from fogproof.zoo.comparison import page
from fogproof.zoo.laws import directions, even, hg
from fogproof.zoo.others import other_tests, p_values
from fogproof.zoo.others.cells import expected, pooled
from fogproof.zoo.running import ZooRow

SPHERE = Planted(lambda u: directions(2 * u[:, 0] - 1, u[:, 1]), even, UnitSphere(), 2)
BENT = Planted(lambda u: directions(2 * u[:, 0] ** 3 - 1, u[:, 1]), even, UnitSphere(), 2)
LINE = Planted(lambda u: np.sqrt(u[:, 0]), lambda x: 2 * x, Interval(0, 1), 1)
BENT_LINE = Planted(lambda u: u[:, 0] ** 1.5, lambda x: 2 * x, Interval(0, 1), 1)


@pytest.mark.parametrize("test", other_tests(), ids=lambda test: test.name)
def test_each_passes_what_is_right_and_rejects_what_is_wrong(test):
    pairs = [(right, wrong) for right, wrong in ((SPHERE, BENT), (LINE, BENT_LINE)) if test.applies(right)]
    if not pairs:
        pytest.skip("it needs another program")
    for right, wrong in pairs:
        rng = np.random.default_rng()
        assert test.p_value(right, rng) > (1e-6 if test.name != "goodness-of-fit" else 0.0005)
        assert test.p_value(wrong, rng) < 2e-3


def test_expected_counts_are_the_integrals():
    found = expected(lambda s, t: 3 * s * s + 0 * t, 10, 4).reshape(10, 4)
    edges = np.linspace(0, 1, 11) ** 3
    assert found == pytest.approx(np.repeat(np.diff(edges)[:, None] / 4, 4, axis=1), rel=1e-12)
    peak, _ = hg(0.9)
    assert peak(np.array([[0.5, 0.5]])).shape == (1, 3)


def test_small_cells_are_put_together_and_empty_ones_reject():
    observed, expectation = np.array([3.0, 2.0, 4.0, 50.0, 41.0]), np.array([2.0, 2.0, 2.0, 47.0, 47.0])
    statistic = (9 - 6) ** 2 / 6 + 3**2 / 47 + 6**2 / 47
    assert pooled(observed, expectation) == pytest.approx(float(chi2.sf(statistic, 2)))
    assert pooled(np.array([1.0, 99.0]), np.array([0.0, 100.0])) == 0.0


def test_what_is_no_sampler_is_not_asked():
    assert set(p_values(object(), 1).values()) == {None}


def test_the_page_counts_kills_and_false_alarms_of_each_test(tmp_path):
    def row(name, status, p, causes=("shape",)):
        return ZooRow(
            name,
            name,
            "thread#1",
            causes,
            status,
            cause="shape",
            named=True,
            samples=7,
            others={"nori": p, "kstest": None},
        )

    rows = [row("field/a", "killed", 1e-4), row("field/b", "survived", 0.5), row("right/c", "passed", 1e-9, ())]
    text = page(rows, 1_000_000, 1e-6, {"field": 3, "right": 4})
    (tmp_path / "zoo.md").write_text(text)
    prepare_folder(tmp_path, ("zoo.md",))  # it is seen to be ours
    nori = next(line for line in text.splitlines() if line.startswith("| Nori"))
    assert [cell.strip() for cell in nori.split("|")[4:-1]] == ["1 of 2", "0", "1", "1 of 1", "1", "0"]
    assert "`field/b` (field/b): survived" in text
    assert "| field/a | thread#1 | shape | 7 |" in text
    assert "Right subjects, 1 of 4 run: 0 rejected" in text
    assert "| field | 2 of 3 | 1 of 2 |" in text
