"""What a test gets as `fogproof`: the package's checks, each inside its share of the session's false-alarm probability."""

from __future__ import annotations

import hashlib
import itertools
import json
import os
from collections import deque
from collections.abc import Callable
from typing import Any

import fogproof
from fogproof.checks import InconclusiveError, RejectedError, Verdict
from fogproof.checks.arguments import shared_among
from fogproof.errors import InvalidValueError
from fogproof.unnamed import unnamed_file


class Checks:
    """Stands for the package `fogproof` in one test.

    share     the test's share of the false-alarm probability
    calls     how many checks share it equally; None: the k-th gets 1 / (k (k + 1)) of it, which adds up to at most all of it
    news      told of every verdict: (test, its number, plain data, why it fails the test or "")
    keep      told of all that at once, wherever it is reached: (test, plain data, why, the process if it is a forked one)
    """

    def __init__(
        self,
        test: str,
        share: float,
        seed: int,
        calls: int | None,
        passes: bool,
        news: deque[tuple[Any, ...]],
        keep: Callable[[str, dict[str, Any] | None, str, str], None],
    ) -> None:
        self._test, self._share, self._seed = test, share, seed
        self._calls, self._passes, self._news, self._keep = calls, passes, news, keep
        self._count, self._number, self._running = itertools.count(1), itertools.count(), list[str]()
        self._ended = False
        forks = unnamed_file()
        self._process, self._forks = os.getpid(), None if forks is None else os.fdopen(forks, "w+b")

    def _end(self) -> str:
        """Take no more checks: the test has ended. Return what still runs, "" if nothing does."""
        self._ended = True
        if self._forks is not None and self._process == os.getpid():
            with self._forks as forks:
                forks.seek(0)
                for line in forks:
                    self._put(*json.loads(line))
        return ", ".join(self._running)

    def __getattr__(self, name: str) -> Any:
        self._running.append(name)  # the first use of a check loads much
        try:
            thing = getattr(fogproof, name)
        finally:
            self._running.remove(name)
        return self._checking(name, thing) if name.startswith(("check_", "compare_")) else thing

    def _checking(self, name: str, check: Callable[..., Any]) -> Callable[..., Any]:
        def checked(*arguments: Any, **options: Any) -> Any:
            __tracebackhide__ = True
            if self._ended:
                why = f"{name} was called by the fixture of {self._test}, which had ended: it was not judged"
                self._tell(None, why)
                raise InvalidValueError("fogproof", why, name, "ask for the fixture in the test that uses it")
            self._running.append(name)
            try:
                return checked_now(*arguments, **options)
            finally:
                self._running.remove(name)

        def checked_now(*arguments: Any, **options: Any) -> Any:
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
                self._judged(name, found)
                self._raise(found)
                return found
            if isinstance(getattr(found, "verdict", None), Verdict):  # an image, and what its verdict rests on
                self._judged(name, found.verdict)
                self._raise(found.verdict)
                return found
            for one in found:
                self._judged(f"{name} of {one.name}", one.verdict)
            for relation in sorted(found, key=lambda one: one.verdict.outcome != "rejected"):
                self._raise(relation.verdict, f"{relation}\n")
            return found

        return checked

    def _judged(self, name: str, verdict: Verdict) -> None:
        fails = verdict.outcome == "rejected" or (verdict.outcome == "inconclusive" and not self._passes)
        self._tell({"check": name, **verdict.to_dict()}, f"{name}: {verdict.outcome}" if fails else "")

    def _tell(self, told: dict[str, Any] | None, why: str) -> None:
        self._keep(self._test, told, why, "" if self._process == os.getpid() else f"process {os.getpid()}")
        self._put(told, why)

    def _put(self, told: dict[str, Any] | None, why: str) -> None:
        """Tell of a verdict; a process that the test has forked leaves it in a file that both have open."""
        if self._forks is None or self._process == os.getpid():
            self._news.append((self._test, next(self._number), told, why))
        else:
            os.write(self._forks.fileno(), json.dumps([told, why]).encode() + b"\n")

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
