"""Random walks through layers over a ground: what comes back, what arrives below, and what a distant eye sees."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fogproof.contracts import Draws
from fogproof.errors import InvalidValueError
from fogproof.estimators.grounds import ROOM
from fogproof.estimators.phase.functions import phase_value, polar
from fogproof.scene.grounds import Ground, require_ground
from fogproof.scene.kinds import given
from fogproof.scene.slab_layers import SlabLayer, require_layers
from fogproof.validate import number


@dataclass(frozen=True)
class LayeredWalks:
    """Photons of a beam from above, each followed until it leaves or is absorbed.

    layers  the uppermost first
    mu0     cosine of the beam to the normal, in (0, 1]
    ground  what lies below; None for nothing
    view    cosine and azimuth [rad] of an eye far above to which every collision sends what it can (next-event estimation);
            azimuth 0 is straight ahead. None for none
    """

    layers: tuple[SlabLayer, ...]
    mu0: float
    ground: Ground | None = None
    view: tuple[float, float] | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "layers", require_layers("layers", self.layers))
        if not number("mu0", self.mu0, "must lie in (0, 1]", 0, 1) > 0:
            raise InvalidValueError("mu0", "must lie in (0, 1]", self.mu0)
        if self.ground is not None:
            require_ground("ground", self.ground)
        if self.view is not None and not (len(self.view) == 2 and 0 < self.view[0] <= 1 and np.isfinite(self.view[1])):
            raise InvalidValueError("view", "must be a cosine in (0, 1] and an azimuth [rad]", self.view)

    def draw(self, rng: np.random.Generator, n: int) -> Draws:
        """Return n realisations (n, 2), columns back and arrived below, or (n, 3) with the BRDF [1/sr] towards the eye."""
        value = np.zeros((n, 2 if self.view is None else 3))
        edges = np.cumsum([layer.tau for layer in self.layers])
        depth, way = np.zeros(n), np.tile([np.sqrt((1 - self.mu0) * (1 + self.mu0)), 0.0, -self.mu0], (n, 1))
        alive, cost = np.arange(n), np.zeros(n)
        while len(alive):
            depth = depth - way[:, 2] * rng.standard_exponential(len(alive))
            value[alive[depth < 0], 0] += 1
            below = depth >= edges[-1]
            value[alive[below], 1] += 1
            inside = (depth >= 0) & ~below
            going = np.zeros(len(alive), bool)
            layer = np.searchsorted(edges, depth, side="right")
            for i, one in enumerate(self.layers):
                here = np.flatnonzero(inside & (layer == i))
                self._see_scattered(value, alive[here], one, depth[here], way[here])
                here = here[rng.random(len(here)) < one.albedo]
                way[here] = _turned(way[here], one, rng.random((len(here), 2)))
                going[here] = True
            if self.ground is not None:
                here = np.flatnonzero(below)
                self._see_ground(value, alive[here], edges[-1], way[here])
                way[here], kept = _bounced(self.ground, way[here], rng.random((len(here), 3)))
                depth[here] = edges[-1]
                going[here] = kept
            cost[alive] += 1
            alive, depth, way = alive[going], depth[going], way[going]
        return Draws(value, cost)

    def _see_scattered(
        self, value: np.ndarray, who: np.ndarray, layer: SlabLayer, depth: np.ndarray, way: np.ndarray
    ) -> None:
        """Add what a collision sends to the eye: albedo f_p exp(-depth/mu)/mu."""
        if self.view is None or not len(who):
            return
        mu = self.view[0]
        cosine = np.clip(way @ _towards(*self.view), -1, 1)
        value[who, 2] += layer.albedo * phase_value(layer.phase, cosine) * np.exp(-depth / mu) / mu

    def _see_ground(self, value: np.ndarray, who: np.ndarray, depth: float, way: np.ndarray) -> None:
        """Add what the ground sends to the eye."""
        if self.view is None or not len(who):
            return
        mu, azimuth = self.view
        apart = azimuth - np.arctan2(way[:, 1], way[:, 0])
        brdf = given(self.ground, ROOM, "value")(self.ground, -way[:, 2], mu, apart)
        value[who, 2] += brdf * np.exp(-depth / mu)


def _towards(mu: float, azimuth: float) -> np.ndarray:
    sine = np.sqrt((1 - mu) * (1 + mu))
    return np.array([sine * np.cos(azimuth), sine * np.sin(azimuth), mu])


def _turned(way: np.ndarray, layer: SlabLayer, u: np.ndarray) -> np.ndarray:
    """Return directions (n, 3) scattered about their ways."""
    turn = polar(layer.phase, u[:, 0])
    cosine, sine = (turn.coversine - turn.versine) / 2, np.sqrt(turn.versine * turn.coversine)
    azimuth = 2 * np.pi * u[:, 1]
    # A vector across each way: the axis on which it is the shortest.
    shortest = np.eye(3)[np.argmin(np.abs(way), axis=1)]
    one = np.cross(way, shortest)
    one /= np.linalg.norm(one, axis=1, keepdims=True)
    other = np.cross(way, one)
    new = cosine[:, None] * way + (sine * np.cos(azimuth))[:, None] * one + (sine * np.sin(azimuth))[:, None] * other
    turned: np.ndarray = new / np.linalg.norm(new, axis=1, keepdims=True)
    return turned


def _bounced(ground: Ground, way: np.ndarray, u: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return directions after the ground, and which photons it does not absorb."""
    mu, azimuth, weight = given(ground, ROOM, "reflect")(ground, -way[:, 2], u)
    angle = np.arctan2(way[:, 1], way[:, 0]) + azimuth
    sine = np.sqrt((1 - mu) * (1 + mu))
    return np.stack([sine * np.cos(angle), sine * np.sin(angle), mu], axis=1), u[:, 2] < weight
