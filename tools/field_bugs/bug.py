"""One bug that shipped somewhere, as a sampler that has it."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fogproof import UnitSphere, Verdict, check_sampler


@dataclass(frozen=True)
class Bug:
    """A planted bug.

    name     of it
    source   where it was reported
    sample, pdf, domain, options   arguments of `check_sampler`, with the bug in one of them
    causes   the names of the cause that are right
    """

    name: str
    source: str
    sample: Callable[..., Any]
    pdf: Callable[[np.ndarray], Any]
    causes: tuple[str, ...]
    domain: Any = field(default_factory=UnitSphere)
    options: Mapping[str, Any] = field(default_factory=lambda: {"dimensions": 2})

    def check(self, samples: int, seed: int) -> Verdict:
        """Return the verdict on it."""
        options = {"samples": samples, "seed": seed, **self.options}
        return check_sampler(self.sample, self.pdf, self.domain, **options)


def ones(x: np.ndarray) -> np.ndarray:
    """Return the density 1."""
    return np.ones(len(x))


def even(x: np.ndarray) -> np.ndarray:
    """Return the uniform density on the sphere."""
    return np.full(len(x), 0.25 / np.pi)


def directions(mu: np.ndarray, turn: np.ndarray) -> np.ndarray:
    """Return unit vectors with cosine mu about z and a share of the turn."""
    sine, phi = np.sqrt(np.maximum(1 - mu * mu, 0)), 2 * np.pi * turn
    return np.stack([sine * np.cos(phi), sine * np.sin(phi), mu], axis=-1)


def hg_cosine(g: float, u: np.ndarray) -> np.ndarray:
    """Return the cosine of Henyey & Greenstein's law."""
    s = (1 - g * g) / (1 - g + 2 * g * u)
    return np.clip((1 + g * g - s * s) / (2 * g), -1, 1)


def hg(g: float) -> tuple[Callable[[np.ndarray], np.ndarray], Callable[[np.ndarray], np.ndarray]]:
    """Return sampler and pdf of Henyey & Greenstein's phase function about z."""
    return (
        lambda u: directions(hg_cosine(g, u[:, 0]), u[:, 1]),
        lambda x: (1 - g * g) / (4 * np.pi * (1 + g * g - 2 * g * x[:, 2]) ** 1.5),
    )


def frame(normal: tuple[float, float, float]) -> np.ndarray:
    """Return rows (t1, t2, normal) of an orthonormal frame."""
    n = np.asarray(normal) / np.linalg.norm(normal)
    t = np.cross(n, np.eye(3)[np.argmin(np.abs(n))])
    t /= np.linalg.norm(t)
    return np.stack([t, np.cross(n, t), n])
