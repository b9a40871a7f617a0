"""A verdict cannot be misread: it has no truth value, and what it could not decide is no pass."""

import subprocess
import sys

import numpy as np
import pytest

from fogproof import Draws, Interval, Reference, UnitSquare, check_estimator, check_sampler
from fogproof.checks import Finding, InconclusiveError, RejectedError, Verdict
from fogproof.errors import FogproofError, InvalidValueError


def verdict(*outcomes):
    findings = tuple(Finding(f"check {i}", outcome, "a sentence") for i, outcome in enumerate(outcomes))
    return Verdict(findings, 1e-6, 1000, 1)


@pytest.mark.parametrize("outcome", ["rejected", "inconclusive", "not rejected"])
def test_a_verdict_is_neither_true_nor_false(outcome):
    for misuse in (lambda v: bool(v), lambda v: not v, lambda v: v and 1):
        with pytest.raises(FogproofError, match=r"raise_unless_passed\(\)"):
            misuse(verdict("not rejected", outcome))


@pytest.mark.parametrize(
    ("outcomes", "error"),
    [
        (("not rejected",), None),
        (("not rejected", "rejected", "inconclusive"), RejectedError),
        (("not rejected", "inconclusive"), InconclusiveError),
    ],
)
def test_only_a_pass_passes(outcomes, error):
    if error is None:
        verdict(*outcomes).raise_unless_passed()
        return
    with pytest.raises(error, match="a sentence") as caught:
        verdict(*outcomes).raise_unless_passed()
    assert isinstance(caught.value, AssertionError)


def uniform(rng, n):
    return rng.random(n)


def test_plain_numbers_are_references():
    for reference in (0.5, np.float32(0.5), Reference(0.5), Reference(0.5, error=1e-9)):
        assert check_estimator(uniform, reference, samples=20_000).outcome == "not rejected"
    assert check_estimator(uniform, 0.6, samples=20_000).outcome == "rejected"
    three = check_estimator(lambda rng, n: rng.random((n, 3)) * [1, 2, 4], [0.5, 1, 2], samples=20_000)
    assert three.outcome == "not rejected"
    assert float(Reference(0.5)) == 0.5
    with pytest.raises(InvalidValueError, match="single number"):
        float(Reference([0.5, 1.0]))


NAN = float("nan")


@pytest.mark.parametrize(
    "call",
    [
        lambda: check_estimator(uniform, Reference(NAN), samples=1000),
        lambda: check_estimator(uniform, Reference(0.5, NAN), samples=1000),
        lambda: Reference(0.5, -1e-9),
        lambda: Reference("0.5"),
        lambda: check_estimator(uniform, NAN, samples=1000),
        lambda: check_estimator(uniform, [0.5, NAN], samples=1000),
        lambda: check_estimator(uniform, Reference(np.inf), samples=1000),
        lambda: check_estimator(uniform, Reference(0.5, np.inf), samples=1000),
        lambda: check_estimator(uniform, 0.5, variance=NAN, samples=1000),
        lambda: check_estimator(uniform, 0.5, variance=-1.0, samples=1000),
        lambda: check_estimator(lambda rng, n: Draws(rng.random(n), np.ones(n)), 0.5, cost=NAN, samples=1000),
    ],
)
def test_references_that_mean_nothing_are_refused(call):
    with pytest.raises(InvalidValueError):
        call()


@pytest.mark.parametrize("part", ["cost", "stderr"])
@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_one_bad_number_in_any_part_rejects(part, bad):
    def draw(rng, n):
        column = np.full(n, 7.0)
        column[n // 2] = bad
        return Draws(rng.random(n), **{part: column})

    found = check_estimator(draw, 0.5, samples=20_000, cost=7.0 if part == "cost" else None)
    assert found.outcome == "rejected", str(found)
    assert found.findings[0].check == "finite values"


def test_a_pass_is_said_in_few_lines_and_a_failure_whole():
    passed = check_estimator(lambda rng, n: rng.random((n, 9)), np.full(9, 0.5), samples=20_000, tolerance=1e-3)
    assert str(passed).count("\n") <= 3
    assert "tolerance (0.001, 0.0)" in str(passed)
    assert "mean of channel 0 to 8" in str(passed)
    failed = check_estimator(uniform, 0.6, samples=20_000)
    assert "z = " in str(failed)
    assert "reproduce: " in str(failed)
    for one in (passed, failed):
        assert len(repr(one)) < 120
        assert one.outcome in repr(one)


def test_a_verdict_draws_itself_and_loads_matplotlib_only_then():
    code = (
        "import sys, fogproof; v = fogproof.check_estimator(lambda r, n: r.random(n), 0.5, samples=2000); str(v); repr(v);"
        "assert 'matplotlib' not in sys.modules; html = v._repr_html_(); assert '<svg' in html and 'not rejected' in html;"
        "assert len(v.plot().axes) == 1"
    )
    subprocess.run([sys.executable, "-c", code], check=True)


def test_html_holds_every_finding_and_no_markup_of_the_subject():
    finding = Finding("check <b>", "inconclusive", "1 < 2 & so on")
    text = Verdict((finding,), 1e-6, 1000, 1)._repr_html_()
    assert "check &lt;b&gt;" in text
    assert "1 &lt; 2 &amp; so on" in text
    with pytest.raises(FogproofError, match="print"):
        Verdict((finding,), 1e-6, 1000, 1).plot()


def test_every_kind_of_figure_can_be_plotted():
    for domain, k, kind in ((UnitSquare(), 2, "z-map"), (Interval(0, 1), 1, "bins")):
        found = check_sampler(
            lambda u, k=k: u if k == 2 else u[:, 0], lambda x: np.ones(len(x)), domain, dimensions=k, samples=20_000
        )
        assert {finding.figure["kind"] for finding in found.findings if finding.figure} == {kind}
        assert found.plot().axes
