"""From a spec, and a program or a file, to a verdict."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.checks import Finding, Verdict, check_estimator, check_family, check_sampler, fresh_seed
from fogproof.checks.digits import digits_of
from fogproof.checks.subject import Precision, Subject
from fogproof.contracts import Draw
from fogproof.domains import Discrete
from fogproof.errors import InvalidInputError, NotInstalledError, SubjectError
from fogproof.input_files import read_toml
from fogproof.pipe.columns import columns_of
from fogproof.pipe.entries import with_its_table
from fogproof.pipe.estimator import PipeEstimator, by_order, draws_of
from fogproof.pipe.faults import BROKEN, ProgramError
from fogproof.pipe.files import read_rows
from fogproof.pipe.process import Timeouts
from fogproof.pipe.program import Program
from fogproof.pipe.ratios import check_ratios
from fogproof.pipe.recorded import Recorded, check_recorded
from fogproof.pipe.sampler import PipeSampler, draw_of, misread
from fogproof.pipe.seeds import function_of_its_seed
from fogproof.pipe.spec import Spec, spec_of
from fogproof.pipe.truth import KnownLaw, expectation_of, truth_of

SAMPLES = 1_000_000
_FAMILY_SAMPLES = 10_000_000
_NO_PDF = (
    'the program does not answer "pdf", and the spec has no phase, medium or table that says what the density should be'
)


@dataclass(frozen=True)
class Settings:
    """What is common to all checks; None: the check's own."""

    samples: int | None = None
    resolution: float | None = None
    alpha: float = 1e-6
    seed: int | None = None


@dataclass(frozen=True)
class Checked:
    """A verdict, what the program did besides, and what it wrote to stderr."""

    verdict: Verdict
    notes: tuple[str, ...] = ()
    said: str = ""


def check_program(
    command: str | Sequence[str],
    spec: str | Path | Mapping[str, Any],
    settings: Settings | None = None,
    timeouts: Timeouts | None = None,
) -> Checked:
    """Judge a program that speaks the protocol of `docs/pipe.md`; it is ended with its children, whatever happens.

    command  its command line; no shell reads it
    spec     a TOML file, or its table
    """
    settings = settings or Settings()
    table, origin = (spec, "spec") if isinstance(spec, Mapping) else (read_toml(spec, "the spec file"), str(spec))
    for name in ("columns", "type"):
        if name in table:
            raise InvalidInputError(
                f"{origin}: {name} is of files; a program says it in its greeting: leave it out", name
            )
    base = spec_of(table, origin)
    program: Program | None = None
    try:
        program = Program(command, timeouts)
        with program:
            judge = partial(_family, table=table, origin=origin) if base.family else _single
            verdict = judge(program, base, settings)
            seeded = function_of_its_seed(program, base)
        if (
            program.ahead
        ):  # it may have come too late to be seen between two questions, and stood for the answer to the next
            raise ProgramError(f"the program {program.ahead}", BROKEN)
        if seeded is not None:
            cause = verdict.cause or seeded.cause
            verdict = replace(verdict, findings=(*verdict.findings, seeded), cause=cause)
        if program.failure and verdict.outcome != "rejected":  # it may have failed before, and been silent about it
            verdict = replace(verdict, findings=(*verdict.findings, Finding("end", "inconclusive", program.failure)))
    except SubjectError as error:
        verdict = failed(error, settings)
    words = command if isinstance(command, str) else shlex.join(command)
    verdict = replace(verdict, reproduce=_command(["--exec", words], origin, settings, verdict.seed))
    notes = tuple(dict.fromkeys(program.notes)) if program else ()
    shown = program.shown if program else None
    return Checked(verdict, notes + _digits(verdict, shown), program.said if program else "")


def _digits(verdict: Verdict, numbers: np.ndarray | None) -> tuple[str, ...]:
    """Return a note on how few digits numbers have, where that is what is wrong."""
    found = digits_of(numbers) if verdict.cause == "coarse numbers" and numbers is not None else None
    return (f"of its numbers, {found.words}",) if found else ()


def check_file(path: str | Path, spec: str | Path | Mapping[str, Any], settings: Settings | None = None) -> Checked:
    """Judge the samples or realisations in a file."""
    settings = settings or Settings()
    table, origin = (spec, "spec") if isinstance(spec, Mapping) else (read_toml(spec, "the spec file"), str(spec))
    base = spec_of(table, origin)
    if base.family:
        raise InvalidInputError(
            f"{origin}: a file holds samples of one member; leave family out, give parameters", "family"
        )
    outcome = _of_file(Path(path), base, settings)
    reproduce = _command([str(path)], origin, settings, outcome.verdict.seed)
    return replace(outcome, verdict=replace(outcome.verdict, reproduce=reproduce))


def _of_file(path: Path, base: Spec, settings: Settings) -> Checked:
    rows, named = read_rows(path, len(base.columns), base.type)
    columns = columns_of(path, base, rows.shape, named)
    precision: Precision = base.precision or ("float32" if rows.dtype == np.float32 else "float64")
    if not base.samples_points:
        options: dict[str, Any] = {
            "alpha": settings.alpha,
            "seed": settings.seed,
            **_estimator_options(base, precision),
        }
        reference = by_order(expectation_of(base), base, columns)
        return Checked(check_estimator(draws_of(rows, columns), reference, **options))
    _require_labels(base, columns)
    truth = truth_of(base, precision)
    hint = misread(truth.domain, rows, columns, truth.density and partial(_value, truth))
    if hint:
        return Checked(failed(ProgramError(f"the file {hint[0]}", hint[1]), settings))
    draw = draw_of(rows, columns, truth.domain)
    if truth.density is None and draw.pdf is None:
        fix = "give a column of densities, or phase, medium or table in the spec"
        raise InvalidInputError(f"{path} has no densities; {fix}", "columns")
    if truth.density is None and isinstance(truth.domain, Discrete):
        truth, draw = with_its_table(truth, draw, Recorded(draw).pilot) or (truth, draw)
    if truth.density is None:
        subject = _subject(base, truth, _never, _never, precision)
        with np.errstate(all="ignore"):  # what is infinite or undefined is found, not warned of
            verdict = check_ratios(subject, draw, settings.alpha, settings.seed)
        return Checked(_unless_swapped(verdict, subject, draw, settings))
    recorded = Recorded(draw)
    subject = _subject(base, truth, recorded.sample, partial(_value, truth), precision, recorded.pilot)
    most = min(settings.samples or base.samples or recorded.tested, truth.most or recorded.tested)
    verdict = check_recorded(recorded, subject, most, settings.resolution, settings.alpha, settings.seed)
    return Checked(verdict, truth.notes + _digits(verdict, draw.x))


def _unless_swapped(verdict: Verdict, subject: Subject, draw: Draw, settings: Settings) -> Verdict:
    """Return the verdict; where points and densities pass the other way round, their columns are its cause."""
    if verdict.outcome != "rejected" or subject.domain.shape or subject.atoms or draw.pdf is None:
        return verdict
    other = draw._replace(x=draw.pdf, pdf=draw.x)
    if check_ratios(subject, other, settings.alpha, verdict.seed).outcome != "not rejected":
        return verdict
    told = "points and densities pass when their columns are swapped"
    return replace(verdict, cause="layout", diagnosis=told)


def _command(what: Sequence[str], spec: str, settings: Settings, seed: int) -> str:
    """Return the command line that repeats a check."""
    options = [f"--alpha={settings.alpha:g}", f"--seed={seed}"]
    options += [f"--samples={settings.samples}"] if settings.samples else []
    options += [f"--resolution={settings.resolution:g}"] if settings.resolution else []
    return shlex.join(["fogproof", "check", *what, "--spec", spec, *options])


def failed(error: SubjectError, settings: Settings) -> Verdict:
    """Return the verdict on what broke its contract."""
    cause = getattr(error, "cause", "contract")
    seed = settings.seed if settings.seed is not None else fresh_seed()
    return Verdict((Finding("contract", "rejected", str(error), cause=cause),), settings.alpha, 0, seed, cause=cause)


def _single(program: Program, spec: Spec, settings: Settings) -> Verdict:
    member, most = _member(program, spec)
    samples = settings.samples or spec.samples or SAMPLES
    common: dict[str, Any] = {"alpha": settings.alpha, "seed": settings.seed, "resolution": settings.resolution}
    if isinstance(member, PipeEstimator):
        return check_estimator(member.draw, member.reference, samples=samples, **common, **member.options)
    return check_sampler(
        member.sample,
        member.pdf,
        member.domain,
        dimensions=member.dimensions,
        atoms=member.atoms,
        eval=member.eval,
        samples=min(samples, most or samples),
        **common,
        **member.options,
    )


def _family(program: Program, base: Spec, settings: Settings, table: Mapping[str, Any], origin: str) -> Verdict:
    def make(parameters: Mapping[str, float]) -> PipeSampler | PipeEstimator:
        return _member(program, spec_of(table, origin, parameters))[0]

    samples = settings.samples or base.samples or _FAMILY_SAMPLES
    return check_family(make, _parameters(base), samples=samples, alpha=settings.alpha, seed=settings.seed)


def _member(program: Program, spec: Spec) -> tuple[PipeSampler | PipeEstimator, int | None]:
    """Return the program with the spec's parameters as a check takes it, and how many samples it can be judged by at most."""
    greeting = program.greeting
    if greeting.samples != spec.samples_points:
        is_one, other = ("a sampler", "an estimator") if greeting.samples else ("an estimator", "a sampler")
        raise program.refuse(f"is {is_one} by its columns {list(greeting.columns)}; the spec describes {other}")
    precision: Precision = spec.precision or ("float32" if greeting.type == "float32" else "float64")
    if greeting.type == "float32" and precision == "float64":
        raise program.refuse('writes float32 numbers where the spec says precision = "float64"')
    if not spec.samples_points:
        reference = by_order(expectation_of(spec), spec, greeting.columns)
        options = _estimator_options(spec, precision)
        return PipeEstimator(program, spec.dimensions, precision, spec.parameters, reference, options), None
    _require_labels(spec, greeting.columns)
    truth = truth_of(spec, precision)
    program.notes += truth.notes
    given, wanted = len(greeting.places("x")), int(np.prod(truth.domain.shape, dtype=int))
    if given != wanted:
        raise program.refuse(f'greets with {given} columns "x"; a point of {truth.domain} has {wanted}')
    own = "pdf" in greeting.answers
    if not own and truth.density is None:
        raise InvalidInputError(_NO_PDF, "--exec")
    law = None if own else partial(_value, truth)
    options = _sampler_options(spec, truth, precision, truth.density if own else None)
    atoms, dimensions = truth.atoms, spec.dimensions
    sampler = PipeSampler(program, truth.domain, dimensions, precision, atoms, spec.parameters, law, options)
    return sampler, truth.most


def _require_labels(spec: Spec, columns: tuple[str, ...]) -> None:
    if spec.events and "event" not in columns:
        fix = "write one with every sample, or leave events out"
        raise InvalidInputError(f"events are declared, and there is no column event; {fix}", "events")


def _sampler_options(spec: Spec, truth: KnownLaw, precision: Precision, reference: Any) -> dict[str, Any]:
    """Return what `check_sampler` is to know besides."""
    return {
        "axis": truth.axis,
        "mean_cosine": truth.mean_cosine,
        "albedo": spec.albedo,
        "cdf": truth.cdf,
        "reference": reference,
        "precision": precision,
        "events": {int(label): probability for label, probability in spec.events.items()},
        "uniform_bits": spec.uniform_bits,
        "quasi_random": spec.quasi_random,
    }


def _estimator_options(spec: Spec, precision: Precision) -> dict[str, Any]:
    """Return what `check_estimator` is to know besides."""
    names = ("variance", "cost", "bounds", "nonnegative", "tails", "tolerance")
    return {"precision": precision, **{name: getattr(spec, name) for name in names}}


def _subject(spec: Spec, truth: KnownLaw, sampler: Any, pdf: Any, precision: Precision, pilot: int = 0) -> Subject:
    """Return the samples of a file as a subject: nobody is there to be asked for others."""
    options = _sampler_options(spec, truth, precision, None)
    return Subject(sampler, pdf, truth.domain, None, truth.atoms, pilot=pilot, **options)


def _value(truth: KnownLaw, x: np.ndarray) -> np.ndarray:
    assert truth.density is not None
    return np.asarray(truth.density(x).value)


def _never(x: np.ndarray) -> np.ndarray:
    raise InvalidInputError("there is nobody to be asked for a density", "pdf")


def _parameters(spec: Spec) -> Any:
    """Return all combinations of listed values, or a strategy where a parameter has a range."""
    if not any(isinstance(values, tuple) for values in spec.family.values()):
        return [dict(zip(spec.family, values, strict=True)) for values in product(*spec.family.values())]
    try:
        from hypothesis import strategies
    except ImportError:
        raise NotInstalledError("Hypothesis", "hypothesis") from None
    ranges = {
        name: strategies.floats(*values) if isinstance(values, tuple) else strategies.sampled_from(values)
        for name, values in spec.family.items()
    }
    return strategies.fixed_dictionaries(ranges)
