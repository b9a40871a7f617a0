"""Files of a command that judges and that cannot be written, as on a full disk: each is named, and no verdict is lost with it."""

from __future__ import annotations

import contextlib
from collections.abc import Iterator
from dataclasses import dataclass, field

from fogproof.cli.terminal import BAD_INPUT, say
from fogproof.errors import FogproofError

REJECTED = 1
"""The exit code where something was rejected."""


@dataclass(frozen=True)
class Unwritten:
    """Why files are not there, each reason told once."""

    reasons: dict[str, None] = field(default_factory=dict)

    def tell(self, reason: str) -> None:
        """Say on stderr why a file could not be written."""
        if reason not in self.reasons:
            self.reasons[reason] = None
            say(f"fogproof: {reason}", err=True)

    @contextlib.contextmanager
    def noted(self) -> Iterator[None]:
        """Write in this block: what fails is said, and the command goes on."""
        try:
            yield
        except (FogproofError, OSError) as error:
            self.tell(str(error))

    def code(self, judged: int) -> int:
        """Return the exit code: a rejection comes before what is not written, and that before all else that was judged."""
        return BAD_INPUT if self.reasons and judged != REJECTED else judged
