"""`check_relations`: does a renderer keep the relations that hold whatever the scene, without an oracle?"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from fogproof.checks import Verdict, batch_generator, compare_estimators, fresh_seed
from fogproof.errors import InvalidValueError, UnsupportedError
from fogproof.relations import PathSetting, comparisons
from fogproof.relations.drawn import drawn
from fogproof.validate import number

Render = Callable[[PathSetting], Any]
"""PathSetting -> something with `draw(rng, n)`, or that function itself: n independent realisations of the radiance."""


@dataclass(frozen=True)
class RelationVerdict:
    """What became of one relation.

    name      of the relation
    isolates  where to look if it is rejected
    verdict   of the two sides
    """

    name: str
    isolates: str
    verdict: Verdict

    def __str__(self) -> str:
        told = f"{self.name}: {self.verdict.outcome}"
        return f"{told}; look at {self.isolates}" if self.verdict.outcome == "rejected" else told


def check_relations(
    render: Render,
    setting: PathSetting,
    *,
    samples: int = 200_000,
    alpha: float = 1e-6,
    seed: int | None = None,
    **options: Any,
) -> tuple[RelationVerdict, ...]:
    """Hold a renderer to every relation that a setting allows; all of them share one false-alarm probability.

    render   setting -> estimator; it declines a setting by raising `UnsupportedError`, and relations that need it are left out
    samples  of each side of each relation, at most
    options  further arguments of `compare_estimators`, such as nonnegative=True

    A relation that fails names the part it isolates. Relations that hold prove nothing about what all settings share.
    """
    if not callable(render):
        raise InvalidValueError("render", "must be a function of a PathSetting that returns an estimator", render)
    number("alpha", alpha, "must lie in (0, 1)", 0, 1, open_ends=True)
    root = fresh_seed() if seed is None else seed
    allowed = comparisons(setting)
    results = []
    for comparison in allowed:
        try:
            first, second = drawn(render, comparison.first), drawn(render, comparison.second)
        except UnsupportedError:
            continue
        verdict = compare_estimators(
            first,
            second,
            samples=samples,
            alpha=alpha / len(allowed),
            seed=int(batch_generator(root, comparison.name, 0, 0).integers(2**62)),
            **options,
        )
        results.append(RelationVerdict(comparison.name, comparison.isolates, verdict))
    return tuple(results)
