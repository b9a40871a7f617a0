"""A check in parts says what it says in one piece; stopping early and going on never inflate the false alarms."""

import json
from dataclasses import replace

import numpy as np
import pytest

from fogproof import HalfLine, InvalidValueError, UnitSphere, check_sampler
from fogproof.checks import SamplerCheck
from fogproof.checks.escalation import EARLY, stages
from fogproof.checks.subject import Subject

SPHERE = Subject(
    lambda u: np.stack(
        [
            2 * np.sqrt(u[:, 0] * (1 - u[:, 0])) * np.cos(2 * np.pi * u[:, 1]),
            2 * np.sqrt(u[:, 0] * (1 - u[:, 0])) * np.sin(2 * np.pi * u[:, 1]),
            1 - 2 * u[:, 0],
        ],
        axis=-1,
    ),
    lambda x: np.full(len(x), 0.25 / np.pi),
    UnitSphere(),
    2,
)
LINE = Subject(
    lambda u: np.where(u[:, 0] < 0.25, np.inf, -np.log1p(-u[:, 1])),
    lambda x: 0.75 * np.exp(-x),
    HalfLine(0),
    2,
    {np.inf: 0.25},
)


def said(verdict):
    return [(f.check, f.outcome, f.p_value, f.effect) for f in verdict.findings]


@pytest.mark.parametrize("subject", [SPHERE, LINE])
def test_batches_drawn_apart_written_down_and_merged_give_the_same_verdict(subject):
    def check():
        return SamplerCheck.of(subject, None, 200_000, 1e-6, 7)

    whole = check().run()
    assert whole.outcome == "not rejected", str(whole)
    first, second = (check().tally(batches) for batches in (range(2), range(2, check().batches)))
    later = check()
    written = [json.loads(json.dumps(tally.to_dict())) for tally in (first, second)]
    merged = later.read(written[0]).merged(later.read(written[1]))
    assert said(later.verdict(merged)) == said(whole)
    options = {"dimensions": subject.dimensions, "atoms": subject.atoms, "samples": 200_000, "seed": 7}
    assert said(check_sampler(subject.sample, subject.pdf, subject.domain, **options)) == said(whole)


def test_a_part_is_no_pass_and_no_batch_counts_twice():
    check = SamplerCheck.of(LINE, None, 200_000, 1e-6, 7)
    part = check.tally([0, 1])
    assert check.verdict(part).outcome == "inconclusive"
    with pytest.raises(InvalidValueError, match="only once"):
        part.merged(check.tally([1]))


def test_a_part_that_is_grossly_wrong_is_rejected_at_once():
    wrong = Subject(lambda u: 2 * LINE.sample(u), LINE.pdf, LINE.domain, 2, LINE.atoms)
    check = SamplerCheck.of(wrong, None, 1_000_000, 1e-6, 7)
    assert check.verdict(check.tally([0])).outcome == "rejected"
    assert check.run().samples < 100_000


def test_the_looks_spend_no_more_than_alpha():
    for samples in (1000, 10**5, 10**6, 10**8):
        for resolution in (None, 0.1, 0.01, 0.001):
            looks = stages(samples, resolution, 1e-6, 10.0)
            assert sum(look.share for look in looks) <= 1 + 1e-12
            assert looks[-1].samples == samples
            assert [look.samples for look in looks] == sorted({look.samples for look in looks})
            assert all(look.share == EARLY or look.share > 0.05 for look in looks) or resolution is None


def test_a_resolution_stops_what_is_clearly_right_and_goes_on_with_what_is_doubtful():
    options = {"dimensions": 2, "atoms": LINE.atoms, "resolution": 0.03}
    samples = {check_sampler(LINE.sample, LINE.pdf, LINE.domain, seed=seed, **options).samples for seed in range(20)}
    assert min(samples) < 50_000

    def nearly(u):
        return np.where(u[:, 0] < 0.273, np.inf, -np.log1p(-u[:, 1]))

    verdict = check_sampler(nearly, LINE.pdf, LINE.domain, **options)
    assert verdict.outcome == "rejected", "what the first look only doubts, a later one rejects"


OTHERS = [
    replace(LINE, sample=lambda u: np.where(u[:, 0] < 0.25, np.inf, -2 * np.log1p(-u[:, 1]))),
    replace(LINE, pdf=lambda x: 0.75 * np.exp(-x) * 1.001),
    replace(LINE, atoms={np.inf: 0.26}),
    replace(LINE, domain=HalfLine(-1)),
]


def test_tallies_of_another_check_are_refused():
    check = SamplerCheck.of(LINE, None, 200_000, 1e-6, 7)
    first, rest = check.tally([0]), check.tally(range(1, check.batches))
    others = [SamplerCheck.of(other, None, 200_000, 1e-6, 7) for other in OTHERS]
    others += [SamplerCheck.of(LINE, None, samples, 1e-6, seed) for samples, seed in ((200_001, 7), (200_000, 8))]
    for other in others:
        theirs = other.tally(range(1, other.batches))
        with pytest.raises(InvalidValueError, match="must be of one check: the same subject, samples, seed"):
            first.merged(theirs)
        for foreign in (theirs.to_dict(), other.tally([0]).to_dict()):
            with pytest.raises(InvalidValueError, match="must be of this check"):
                check.read(json.loads(json.dumps(foreign)))
        with pytest.raises(InvalidValueError, match="must be of this check"):
            check.verdict(theirs)
    assert check.verdict(first.merged(rest)).outcome == "not rejected"


@pytest.mark.parametrize("batches", [[99], [-1], [0.5], ["x"]])
def test_batches_are_those_there_are(batches):
    with pytest.raises(InvalidValueError, match="batches must be whole numbers from 0 to"):
        SamplerCheck.of(LINE, None, 200_000, 1e-6, 7).tally(batches)


def test_a_state_that_nobody_wrote_is_refused():
    check = SamplerCheck.of(LINE, None, 200_000, 1e-6, 7)
    state = json.loads(json.dumps(check.tally([0]).to_dict()))
    wrong = [{}, None, [], "x", state | {"fine": 3}, state | {"plane": "x"}, state | {"batches": "x"}]
    wrong += [state | {"serial": [{"dtype": "f8", "shape": [1], "data": "eA=="}]}, state | {"batches": [0, 1]}]
    for broken in wrong:
        with pytest.raises(InvalidValueError, match=r"must be what Tally\.to_dict returned|must have drawn what"):
            check.read(broken)
    for drawn in (0, 10**9):
        with pytest.raises(InvalidValueError, match="must have drawn what its batches hold"):
            check.read(state | {"drawn": drawn})
    assert check.read(state).drawn == check.sizes[0]
