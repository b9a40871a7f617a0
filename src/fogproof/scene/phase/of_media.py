"""The phase function of several media together: at each place the mean of theirs, weighted by what scatters there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True, eq=False)
class PhaseOfMedia:
    """f_p(x, mu) = sum sigma_s,i(x) f_p,i(mu) / sum sigma_s,i(x), normalised wherever anything scatters.

    medium  the composite medium whose parts are meant
    """

    medium: Any
