"""One systematic error: how it changes a subject, and what a person would call it."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from typing import Any, Generic, TypeVar

from fogproof.catalogue import EstimatorCase, SamplerCase, all_cases
from fogproof.zoo.bug import Bug

AnyCase = TypeVar("AnyCase", SamplerCase, EstimatorCase)


@dataclass(frozen=True)
class Mutated:
    """A changed subject.

    subject   what `make` of its case returns
    needed    lower bound on the samples that the best test needs
    equal     whether nothing has changed at all
    """

    subject: Any
    needed: Callable[[], float] = lambda: 1.0
    equal: bool = False


@dataclass(frozen=True)
class Mutation(Generic[AnyCase]):
    """One error.

    name    of it, part of the mutants' names
    title   for people
    causes  that are right
    plant   case -> the changed subject, None where the error does not apply; builds the case's subject
    """

    name: str
    title: str
    causes: tuple[str, ...]
    plant: Callable[[AnyCase], Mutated | None]


def mutants(kind: type[AnyCase], mutations: Iterable[Mutation[AnyCase]]) -> list[Bug]:
    """Return each error in each case of the catalogue that runs by default, where it applies and the case is right."""
    found = []
    for case in all_cases():
        if not isinstance(case, kind) or case.by_name or case.expected != "not rejected":
            continue
        for mutation in mutations:
            mutated = mutation.plant(case)
            if mutated is not None:
                found.append(_bug(case, mutation, mutated))
    return found


def _bug(case: AnyCase, mutation: Mutation[AnyCase], mutated: Mutated) -> Bug:
    name = f"mutants/{mutation.name}/{case.name}"
    broken = replace(case, name=name, make=lambda: mutated.subject, twin=None)
    most = (
        case.samples if isinstance(case, EstimatorCase) else 0
    )  # a realisation may be a path of thousands of scatterings
    return Bug(name, mutation.title, case.name, mutation.causes, broken, mutated.needed, mutated.equal, most)
