"""A run of the catalogue spends its false-alarm probability once, whichever cases it is of."""

import pytest

from fogproof.catalogue import all_cases
from fogproof.catalogue.cases import SamplerCase
from fogproof.verify import running
from fogproof.verify.results import Result


def shares_of(monkeypatch, cases, alpha):
    asked = {}

    def note(case, seed, share, twins=False):
        asked[case.name] = share
        return Result(case, "passed", None, "", 0.0)

    monkeypatch.setattr(running, "run_case", note)
    list(running.run(cases, seed=1, alpha=alpha, workers=1))
    return asked


def test_the_cases_share_alpha(monkeypatch):
    cases = list(all_cases())
    every = shares_of(monkeypatch, cases, 1e-3)
    assert sum(every.values()) == pytest.approx(1e-3, rel=1e-9)
    some = shares_of(monkeypatch, cases[5:25], 1e-3)
    assert all(some[name] == every[name] for name in some), "choosing some changes nothing"


def test_what_the_oracle_knows_of_a_density_is_asked():
    """Every sampler of our own is held to the oracle: none is judged by itself."""
    samplers = [
        c for c in all_cases() if isinstance(c, SamplerCase) and not c.name.startswith(("outsiders/", "mitsuba/"))
    ]
    held = [case for case in samplers if case.reference is not None]
    assert held == samplers
    assert len(held) > 80
    chosen = [case for case in held if case.name.startswith(("cosines", "free-path", "equiangular"))][::6]
    assert len(chosen) >= 3
    for case in chosen:
        findings = case.run(1e-9, 1, 200).findings
        assert "pdf against the reference" in {f.check for f in findings}, case.name
