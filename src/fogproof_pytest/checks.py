"""What a test gets as `fogproof`: the package's checks, each inside its share of the session's false-alarm probability."""

from __future__ import annotations

import hashlib
import itertools
from collections.abc import Callable
from typing import Any

import fogproof
from fogproof.checks import InconclusiveError, RejectedError, Verdict
from fogproof.checks.arguments import shared_among
from fogproof.errors import InvalidValueError


class Checks:
    """Stands for the package `fogproof` in one test.

    share     the test's share of the false-alarm probability
    calls     how many checks share it equally; None: the k-th gets 1 / (k (k + 1)) of it, which adds up to at most all of it
    verdicts  told of every verdict, in plain data
    """

    def __init__(
        self, test: str, share: float, seed: int, calls: int | None, passes: bool, verdicts: list[dict[str, Any]]
    ) -> None:
        self._test, self._share, self._seed = test, share, seed
        self._calls, self._passes, self._verdicts = calls, passes, verdicts
        self._count = itertools.count(1)

    def __getattr__(self, name: str) -> Any:
        thing = getattr(fogproof, name)
        return self._checking(name, thing) if name.startswith(("check_", "compare_")) else thing

    def _checking(self, name: str, check: Callable[..., Any]) -> Callable[..., Any]:
        def checked(*arguments: Any, **options: Any) -> Any:
            __tracebackhide__ = True
            number = next(self._count)
            if "alpha" in options:
                fix = "give the test a weight instead: @pytest.mark.fogproof(weight=...)"
                raise InvalidValueError("alpha", "is shared out by the session", options["alpha"], fix)
            takes = shared_among(check, {"alpha": 0.0, "seed": 0})
            if "alpha" in takes:
                options["alpha"] = self._alpha(number)
            if "seed" in takes:
                options.setdefault("seed", self._seed_of(number))
            found = check(*arguments, **options)
            if isinstance(found, Verdict):
                self._verdicts.append({"check": name, **found.to_dict()})
                self._raise(found)
                return found
            if isinstance(getattr(found, "verdict", None), Verdict):  # an image, and what its verdict rests on
                self._verdicts.append({"check": name, **found.verdict.to_dict()})
                self._raise(found.verdict)
                return found
            self._verdicts += [{"check": f"{name} of {one.name}", **one.verdict.to_dict()} for one in found]
            for relation in sorted(found, key=lambda one: one.verdict.outcome != "rejected"):
                self._raise(relation.verdict, f"{relation}\n")
            return found

        return checked

    def _raise(self, verdict: Verdict, about: str = "") -> None:
        """Raise for a verdict that fails the test; `about` says first what it is about."""
        __tracebackhide__ = True
        if verdict.outcome == "rejected":
            raise RejectedError(f"{about}{verdict}")
        if verdict.outcome == "inconclusive" and not self._passes:
            ways = "give it what would decide, or mark the test @pytest.mark.fogproof(inconclusive='pass')"
            raise InconclusiveError(f"{about}{verdict}\n  an inconclusive verdict is no pass: {ways}")

    def _alpha(self, number: int) -> float:
        if self._calls is None:
            return self._share / (number * (number + 1))
        if number > self._calls:
            raise InvalidValueError(
                "calls", f"must be at least the checks of the test, this is number {number}", self._calls
            )
        return self._share / self._calls

    def _seed_of(self, number: int) -> int:
        """Return a seed that depends on the test's name: another run of it with the session's seed says the same."""
        words = f"{self._seed}/{self._test}/{number}".encode()
        return int.from_bytes(hashlib.blake2b(words, digest_size=8).digest()) >> 2
