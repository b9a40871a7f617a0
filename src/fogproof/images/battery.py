"""The relations of a scene, held to a renderer: which sides it renders, what they are compared with, and who is wrong."""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from fogproof.analytic import image
from fogproof.checks.verdict import Verdict
from fogproof.contracts import Reference
from fogproof.errors import FogproofError, SubjectError, UnsupportedError
from fogproof.images.compare import compare_renders
from fogproof.images.judging import ALPHA, TOLERANCE
from fogproof.images.pairs import compare_pair
from fogproof.images.picture import RenderedImage
from fogproof.images.same_law import exchanged, noise_falls
from fogproof.relations import Comparison, ImageSetting, RadianceTerm, comparisons
from fogproof.relations.anywhere import same
from fogproof.scene import ImageScene
from fogproof.scene.to_json import to_json

ORACLE_SHARE = 0.5
"""Of alpha, for the oracle's rows."""

Render = Callable[[ImageSetting, int], np.ndarray]
"""(setting, which of its independent renders) -> (rows, columns, channels) linear radiance.

It raises `UnsupportedError` where the renderer has no such thing, another `FogproofError` where it failed.
"""


@dataclass(frozen=True)
class ImageRelation:
    """What became of one relation.

    name      of the relation
    isolates  where to look if it is rejected
    verdict   of the two sides against each other; None where a side was not rendered
    first     each rendered side against the oracle: an outcome, "" where there is no oracle
    second
    reason    why a side was not rendered, or who is wrong
    failed    whether it is not known because the renderer failed, or what it left cannot be read
    """

    name: str
    isolates: str
    verdict: Verdict | None
    first: str = ""
    second: str = ""
    reason: str = ""
    failed: bool = False

    @property
    def outcome(self) -> str:
        """What is told of the relation: that of both sides, or that a side is not the oracle's."""
        if self.verdict is None:
            return "error" if self.failed else "not rendered"
        against = {self.first, self.second}
        return "rejected" if "rejected" in against else self.verdict.outcome


@dataclass(frozen=True)
class Battery:
    """How a renderer is asked.

    render       the renderer
    integrators  its ways to render; the first is its usual one
    threads      whether it can be told how many threads to use
    seeds        whether it can be told a seed
    renders      independent renders of each side
    rounding     relative and absolute error of storing a number, as `RenderedImage` has it
    tolerance    relative error that does not matter
    alpha        false-alarm probability of the whole battery
    oracle       whether each side is held to the oracle too
    """

    render: Render
    integrators: Sequence[str] = ("",)
    threads: bool = False
    seeds: bool = True
    renders: int = 2
    rounding: tuple[float, float] = (2.0**-24, 2.0**-149)
    tolerance: float = TOLERANCE
    alpha: float = ALPHA
    oracle: bool = True


def planned(scene: ImageScene, battery: Battery) -> list[Comparison]:
    """Return the relations that a scene and a renderer allow."""
    base = ImageSetting(scene, integrator=battery.integrators[0])
    told = (
        "next-event estimation, MIS weights, the sampling of distances: whatever the integrators do in different ways"
    )
    ways = [same(f"integrators/{name}", told, base, replace(base, integrator=name)) for name in battery.integrators[1:]]
    without = ({"threads"} if not battery.threads else set()) | (
        {"seeds", "more-samples"} if not battery.seeds else set()
    )
    return ways + [one for one in comparisons(base) if one.name not in without]


def image_relations(scene: ImageScene, battery: Battery, only: Sequence[Comparison] = ()) -> Iterator[ImageRelation]:
    """Yield what becomes of each relation as soon as it is known; one false-alarm probability for all, and the oracle's rows.

    only  those of `planned` that are wanted; their share of alpha does not depend on which are
    """
    sight = _Sight(battery)
    everything = planned(scene, battery)
    alpha = battery.alpha * (1 - ORACLE_SHARE if battery.oracle else 1) / (len(everything) + 1)
    checks = max(sum(len(one.first) + len(one.second) for one in everything), 1)
    for comparison in only or everything:
        try:
            first, second = (sight.side(terms) for terms in (comparison.first, comparison.second))
        except (FogproofError, OSError) as error:  # of this relation alone: the others are asked for all the same
            failed = not isinstance(error, UnsupportedError)
            yield ImageRelation(comparison.name, comparison.isolates, None, reason=str(error), failed=failed)
            continue
        done = _compared(first, second, battery, alpha if not comparison.same_law else 0.5 * alpha)
        if comparison.same_law:
            done = exchanged(done, first, second, 0.5 * alpha)
        if comparison.name == "more-samples":
            done = noise_falls(done, first, second, alpha)
        against = ("", "")
        if battery.oracle:
            truth = comparison.first[0].setting if _plain(comparison) else None
            share = battery.alpha * ORACLE_SHARE / checks
            against = sight.against(comparison.first, truth, share), sight.against(comparison.second, truth, share)
        first_told, second_told = against
        yield ImageRelation(comparison.name, comparison.isolates, done, first_told, second_told, _who(done, against))


def _who(verdict: Verdict, against: tuple[str, str]) -> str:
    """Return in words which side the oracle knows to be wrong."""
    wrong = [side for side, outcome in zip(("first", "second"), against, strict=True) if outcome == "rejected"]
    if wrong:
        return "both sides are not the oracle's" if len(wrong) == 2 else f"the {wrong[0]} side is not the oracle's"
    return "the oracle does not tell which side is wrong" if verdict.outcome == "rejected" else ""


def _plain(comparison: Comparison) -> bool:
    """Return whether both sides are the same image, so that the oracle needs to be asked for one of them."""
    terms = (*comparison.first, *comparison.second)
    return len(terms) == 2 and all(
        term.setting is not None and term.factor == 1 and term.channel is None and term.view is None for term in terms
    )


def _compared(first: RenderedImage, second: RenderedImage, battery: Battery, alpha: float) -> Verdict:
    """Return the verdict of two sides; where both are black nothing was compared."""
    shape = np.broadcast_shapes(
        first.renders.shape, second.renders.shape
    )  # grey beside colours, a constant beside an image
    first, second = (
        replace(one, renders=np.broadcast_to(one.renders, shape), names=_names(shape[-1])) for one in (first, second)
    )
    verdict = compare_pair(first, second, tolerance=battery.tolerance, alpha=alpha).verdict
    if not np.any(first.renders) and not np.any(second.renders):
        findings = tuple(
            replace(one, outcome="inconclusive", message="both sides are black") for one in verdict.findings
        )
        return replace(verdict, findings=findings)
    return verdict


@dataclass
class _Sight:
    """What has been rendered and what the oracle has said of it."""

    battery: Battery
    rendered: dict[str, np.ndarray] = field(default_factory=dict)
    failed: dict[str, FogproofError | OSError] = field(default_factory=dict)
    told: dict[str, Reference | None] = field(default_factory=dict)
    judged: dict[tuple[str, str], str] = field(default_factory=dict)

    def side(self, terms: Sequence[RadianceTerm]) -> RenderedImage:
        """Return the renders of a sum of terms."""
        total: np.ndarray = np.zeros((1, 1, 1, 1))
        size = 0.0
        for term in terms:
            value = np.ones((1, 1, 1, 1)) if term.setting is None else self.renders(term.setting)
            if term.channel is not None:
                value = value[..., term.channel : term.channel + 1]
            if term.view is not None:
                value = np.stack([term.view(one) for one in value])
            total, size = total + term.factor * value, size + abs(term.factor)
        relative, step = self.battery.rounding
        return RenderedImage(
            total, None, (relative * max(len(terms), 1), step * max(size, 1)), _names(total.shape[-1]), ()
        )

    def renders(self, setting: ImageSetting) -> np.ndarray:
        """Return the independent renders of a setting, (n, rows, columns, channels); a grey image has one channel."""
        key = _key(setting)
        if key in self.failed:  # nobody waits for the same failure once more
            raise self.failed[key]
        if key not in self.rendered:
            try:
                each = [self.battery.render(setting, i) for i in range(self.battery.renders)]
                if len(shapes := {one.shape for one in each}) > 1:
                    raise SubjectError(f"independent renders of one scene differ in size: {sorted(shapes)}")
            except (FogproofError, OSError) as error:
                self.failed[key] = error
                raise
            found = np.stack(each).astype(float)
            alike = found.shape[-1] > 1 and setting.scene.channels is None and (found == found[..., :1]).all()
            self.rendered[key] = found[..., :1] if alike else found
        return self.rendered[key]

    def against(self, terms: Sequence[RadianceTerm], truth: ImageSetting | None, alpha: float) -> str:
        """Return the worst outcome of a side's images against the oracle's."""
        outcomes = [
            self.oracle(term.setting, truth or term.setting, alpha) for term in terms if term.setting is not None
        ]
        return next((one for one in ("rejected", "inconclusive", "not rejected") if one in outcomes), "")

    def oracle(self, setting: ImageSetting, truth: ImageSetting, alpha: float) -> str:
        """Return the outcome of a setting's image against the oracle's, "" where that has no answer."""
        key = json.dumps(to_json(truth.scene))
        if (_key(setting), key) not in self.judged:
            self.judged[_key(setting), key] = self._judge(setting, truth.scene, key, alpha)
        return self.judged[_key(setting), key]

    def _judge(self, setting: ImageSetting, truth: ImageScene, key: str, alpha: float) -> str:
        if key not in self.told:
            try:
                self.told[key] = image(truth)
            except FogproofError:
                self.told[key] = None
        reference, renders = self.told[key], self.renders(setting)
        if reference is None:
            return ""
        picture = RenderedImage(renders, None, self.battery.rounding, _names(renders.shape[-1]), ())
        done = compare_renders(
            picture, truth, reference=reference, tolerance=self.battery.tolerance, alpha=alpha, explain=False
        )
        return done.verdict.outcome


def _key(setting: ImageSetting) -> str:
    return json.dumps([to_json(setting.scene), setting.integrator, setting.threads, setting.more, setting.copy])


def _names(channels: int) -> tuple[str, ...]:
    """Return the names of channels."""
    return ("radiance",) if channels == 1 else tuple(f"channel {c}" for c in range(channels))
