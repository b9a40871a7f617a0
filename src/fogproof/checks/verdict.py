"""What a check says: findings, each with its p-value, effect and resolution, gathered into one verdict."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from typing import TYPE_CHECKING, Any, Literal

from fogproof.checks.json_values import jsonable
from fogproof.checks.names import channels_aside, in_ranges
from fogproof.errors import FogproofError, UnsupportedError
from fogproof.text import p_value

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ALLOWED = ("tolerance", "bounds", "tails", "precision", "resolution")
"""Settings that change what a pass means: they are printed with it."""

_SHOWN = 3
"""Findings of an outcome that `str` tells in full."""

Outcome = Literal["rejected", "not rejected", "inconclusive"]


class RejectedError(FogproofError, AssertionError):
    """A check rejected its subject; the message explains. It is an `AssertionError`, so test runners show a failure."""

    code = "rejected"


class InconclusiveError(FogproofError, AssertionError):
    """A check could not tell; the message says what would decide. It is an `AssertionError` too: unproven is no pass."""

    code = "inconclusive"


@dataclass(frozen=True)
class Resolution:
    """The smallest error of a named kind that a check would have caught, missing it with probability <= `miss`.

    of  the value that it is an error of; None for what is relative by itself, as probabilities are
    """

    kind: str
    value: float
    miss: float = 0.01
    of: float | None = None

    @property
    def relative(self) -> float | None:
        """The error as a share of what it is an error of, where that is known and not 0."""
        return self.value if self.of is None else self.value / abs(self.of) if self.of else None

    def __str__(self) -> str:
        sure = f" with probability {1 - self.miss:g}" if self.miss else ""
        article = "an" if self.kind.startswith(tuple("aeiou")) else "a"
        share = f" ({self.relative:.2g} of it)" if self.of and self.relative is not None else ""
        return f"{article} {self.kind} above {self.value:.2g}{share} would have been caught{sure}"


@dataclass(frozen=True)
class EffectInterval:
    """Where the true effect lies, but for a probability 1 - confidence."""

    low: float
    high: float
    confidence: float

    def __str__(self) -> str:
        return f"[{self.low:.3g}, {self.high:.3g}] at {self.confidence:.0%}"


@dataclass(frozen=True)
class Finding:
    """One sub-check.

    check       its name
    outcome     rejected, not rejected or inconclusive
    message     one sentence for people
    p_value     None for a deterministic check
    alpha       its share of the false-alarm probability
    exact       True if the p-value is uniform for a right subject, False if it is an upper bound
    statistic   the test statistic
    effect      size of the misfit, in the unit of the resolution's kind
    resolution  what this check could not have missed
    figure      data for a plot, JSON-ready
    interval    where the true effect lies
    region      where the misfit is, and in which direction, in words
    cause       the likely class of error where it is rejected: "normalisation", "wrong measure", "atom", ...
    distribution_free     True if the p-value holds whatever the law of the values
    """

    check: str
    outcome: Outcome
    message: str
    p_value: float | None = None
    alpha: float | None = None
    exact: bool = False
    statistic: float | None = None
    effect: float | None = None
    resolution: Resolution | None = None
    figure: dict[str, Any] | None = field(default=None, hash=False)
    interval: EffectInterval | None = None
    region: tuple[str, ...] = ()
    cause: str = ""
    distribution_free: bool = False

    def located(self, region: str) -> Finding:
        """Return the finding with one more word on where the misfit is."""
        return replace(self, region=(*self.region, region))

    def because(self, cause: str) -> Finding:
        """Return the finding with a likely cause."""
        return replace(self, cause=cause)


@dataclass(frozen=True, repr=False)
class Verdict:
    """All findings about one subject, inside one false-alarm probability `alpha`.

    cause      the likely class of error, "" if nothing was rejected
    reproduce  one line that repeats the check
    diagnosis  the cause as a sentence: what explains the misfit, with its fitted parameter and how much is left
    unchecked  what the subject returns and nothing was declared for
    """

    findings: tuple[Finding, ...]
    alpha: float
    samples: int
    seed: int
    seconds: float = field(default=0.0, compare=False)
    settings: dict[str, Any] = field(default_factory=dict, hash=False)
    cause: str = ""
    reproduce: str = ""
    diagnosis: str = ""
    unchecked: tuple[str, ...] = ()

    @property
    def outcome(self) -> Outcome:
        """Rejected if any finding is; otherwise inconclusive if any is; otherwise not rejected."""
        outcomes = {finding.outcome for finding in self.findings}
        return (
            "rejected" if "rejected" in outcomes else "inconclusive" if "inconclusive" in outcomes else "not rejected"
        )

    @property
    def p_value(self) -> float | None:
        """The smallest p-value of the statistical findings, not corrected for their number; None if there are none."""
        return min((f.p_value for f in self.findings if f.p_value is not None), default=None)

    @property
    def resolution(self) -> Resolution | None:
        """The resolution of the first finding that states one, the headline of a pass: of channels alike, the coarsest."""
        stated = [f.resolution for f in self.findings if f.resolution is not None and f.resolution.miss > 0]
        alike = [one for one in stated if channels_aside(one.kind) == channels_aside(stated[0].kind)]
        return max(alike, key=lambda one: one.value, default=None)

    def raise_if_rejected(self) -> None:
        """Raise `RejectedError` with the whole explanation if the outcome is "rejected"."""
        if self.outcome == "rejected":
            raise RejectedError(self.explain())

    def raise_unless_passed(self) -> None:
        """Raise `RejectedError` or `InconclusiveError` with the whole explanation unless the outcome is "not rejected"."""
        self.raise_if_rejected()
        if self.outcome == "inconclusive":
            raise InconclusiveError(self.explain())

    def __bool__(self) -> bool:
        raise UnsupportedError(
            f"a verdict is not true or false: it is rejected, not rejected or inconclusive (this one: {self.outcome});"
            ' write verdict.raise_unless_passed(), or compare verdict.outcome == "not rejected"',
            "verdict",
        )

    def __repr__(self) -> str:
        cause = f", likely {self.cause}" if self.cause else ""
        return (
            f"<Verdict: {self.outcome}{cause}; {len(self.findings)} findings, {self.samples} samples, seed {self.seed}>"
        )

    def __str__(self) -> str:
        return self.explain(_SHOWN)

    def explain(self, most: int | None = None) -> str:
        """Return the verdict in words: at most so many findings of each outcome in full, all of them for None."""
        lines = [f"{self.outcome} (alpha {self.alpha:g}, {self.samples} samples, seed {self.seed})"]
        if self.cause:
            lines.append(f"  likely: {self.cause}" + (f"; {self.diagnosis}" if self.diagnosis else ""))
        for outcome in ("rejected", "inconclusive"):
            found = [f for f in self.findings if f.outcome == outcome]
            told = found if most is None or len(found) <= most + 1 else found[:most]
            lines += [f"  {f.outcome:12}  {_line_of(f)}" for f in told]
            if more := [f.check for f in found[len(told) :]]:
                lines.append(f"  {outcome:12}  by {len(more)} more: {', '.join(in_ranges(more))}")
        passed = [f.check for f in self.findings if f.outcome == "not rejected"]
        if passed:
            lines.append(f"  not rejected: {', '.join(in_ranges(passed))}")
        if self.resolution is not None:
            lines.append(f"  {self.resolution}")
        allowed = [
            f"{name} {self.settings[name]}" for name in ALLOWED if self.settings.get(name) not in (None, "float64")
        ]
        if allowed:
            lines.append(f"  declared: {', '.join(allowed)}")
        lines += [f"  unchecked: {what}" for what in self.unchecked]
        if self.outcome != "not rejected" and self.reproduce:
            lines.append(f"  reproduce: {self.reproduce}")
        return "\n".join(lines)

    def plot(self) -> Figure:
        """Return a matplotlib figure of what was found, rejected findings first."""
        from fogproof.checks.plots import plotted

        return plotted(self)

    def _repr_html_(self) -> str:
        from fogproof.checks.plots import as_html

        return as_html(self)

    def to_dict(self) -> dict[str, Any]:
        """Return the JSON-ready form; numbers that JSON lacks become "inf", "-inf" or "nan"."""
        return jsonable(
            {
                "outcome": self.outcome,
                "p_value": self.p_value,
                "alpha": self.alpha,
                "samples": self.samples,
                "seed": self.seed,
                "seconds": self.seconds,
                "settings": self.settings,
                "resolution": self.resolution,
                "cause": self.cause,
                "reproduce": self.reproduce,
                "diagnosis": self.diagnosis,
                "unchecked": self.unchecked,
                "findings": self.findings,
            }
        )


def _line_of(finding: Finding) -> str:
    """Return one finding in a line."""
    p = "" if finding.p_value is None else f" p = {p_value(finding.p_value)}.".replace("= <", "<")
    where = "".join(f" {region};" for region in finding.region).removesuffix(";")
    where = f"{where}." if where else ""
    size = f" Effect in {finding.interval}." if finding.interval and finding.outcome == "rejected" else ""
    return f"{finding.check}: {finding.message}.{where}{p}{size}"
