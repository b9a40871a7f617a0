"""How much memory does each function of the oracle take for many numbers? It has to stay flat but for arguments and answers.

    python tools/oracle_memory.py [--numbers 300000] [--seconds 2] [NAME ...]

Every array argument of every quantity's example is made long in turn, tenfold each time, until `--numbers` are reached or a call
takes a tenth of `--seconds`. What NumPy takes at most beside arguments and answers is measured, and carried on by its last slope to
what is asked within a minute. Where that is above 300 MiB, a call goes on to take `--seconds`, threefold each time: what is taken
for blocks of numbers grows before it stays flat. Above 300 MiB at the end the exit code is 1.
"""

from __future__ import annotations

import argparse
import sys
import time
import tracemalloc
import warnings
from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from fogproof.quantities import Quantity, quantities
from fogproof.scene import Ray
from fogproof.scene.files import read_fields

MIB = 2**20
LIMIT = 300
FEWEST = 100
COPIES = 6
"""Arrays of the answer's size that are no working memory: arguments, value, error, and what broadcasts them."""
MINUTE = 60

LOBE = {"kind": "henyey-greenstein", "g": 0.5}


class Taken(NamedTuple):
    """What a call took: numbers, seconds, MiB at most beside what is of the order of the answer."""

    numbers: int
    seconds: float
    mebibytes: float


def carried_on(call: Callable[[int], Any], most: int, seconds: float) -> tuple[Taken, float]:
    """Return what the largest call took, and the MiB that as many as are answered within a minute would take."""
    call(2)
    before, last = Taken(0, 0.0, 0.0), measured(call, FEWEST)
    while last.numbers < most:
        quick = last.seconds < seconds / 10
        would = _would(before, last, most)
        if not quick and (would <= LIMIT or last.seconds > seconds):
            break
        before, last = last, measured(call, min(most, (10 if quick else 3) * last.numbers))
    return last, _would(before, last, most)


def _would(before: Taken, last: Taken, most: int) -> float:
    """Return the MiB that as many numbers as are answered within a minute would take, by the slope of the last two calls."""
    slope = (last.mebibytes - before.mebibytes) / (last.numbers - before.numbers)
    more = min(most, last.numbers * MINUTE / max(last.seconds, 1e-9)) - last.numbers
    return last.mebibytes + max(0.0, slope * more)


def measured(function: Callable[[int], Any], numbers: int) -> Taken:
    """Measure one call."""
    tracemalloc.start()
    start = time.perf_counter()
    try:
        found = function(numbers)
        seconds, peak = time.perf_counter() - start, tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    return Taken(numbers, seconds, max(0.0, peak - 8 * COPIES * np.size(found.value)) / MIB)


def calls(quantity: Quantity) -> Iterator[tuple[str, Callable[[int], Any]]]:
    """Return for each array argument of the example a function that asks with so many values of it."""
    examples = [("", quantity.example)]
    if "phase" in quantity.arguments and "phase" not in quantity.example:
        turns = {"azimuth": 1} if "azimuth" in quantity.arguments else {}
        examples.append((", a lobe", {**quantity.example, "phase": LOBE, **turns}))
    for words, example in examples:
        for path, mark in quantity.arrays.items():
            if mark.table or path.partition(".")[0] not in example:
                continue

            def call(numbers: int, path: str = path, axes: int = mark.axes, example: dict[str, Any] = example) -> Any:
                return quantity.function(**_long(quantity, example, path, axes, numbers))

            yield path + words, call


def _long(quantity: Quantity, example: dict[str, Any], path: str, axes: int, numbers: int) -> dict[str, Any]:
    arguments = read_fields(quantity.arguments, example, "example")
    for name, mark in quantity.arrays.items():
        value = arguments.get(name)
        if isinstance(value, np.ndarray) and not mark.table:
            arguments[name] = value.reshape(-1, 3)[0] if mark.axes else value.ravel()[min(1, value.size - 1)]
    if "ray" in arguments:
        ray = arguments["ray"]
        arguments["ray"] = Ray(ray.origin.reshape(-1, 3)[0], ray.direction.reshape(-1, 3)[0], ray.length.ravel()[0])
    nearby = 1 - 0.1 * np.random.default_rng(1).random(numbers)
    outer, _, inner = path.partition(".")
    if inner:
        ray = arguments[outer]
        keys = {"origin": ray.origin, "direction": ray.direction, "length": ray.length}
        if inner == "direction":
            keys[inner] = _turned(keys[inner], nearby)
        elif inner == "origin":
            keys[inner] = keys[inner] + 0.01 * (nearby[:, None] - 1)
        else:
            keys[inner] = keys[inner] * nearby
        return {**arguments, outer: Ray(**keys)}
    value = arguments[outer]
    return {**arguments, outer: _turned(value, nearby) if axes else value * nearby}


def _turned(vector: np.ndarray, nearby: np.ndarray) -> np.ndarray:
    """Return vectors (n, 3) near one, and of its length: directions stay directions."""
    turned = vector + 0.1 * (nearby[:, None] - 1) * np.array([0.3, 0.2, 0.1])
    return np.asarray(turned * (np.linalg.norm(vector) / np.linalg.norm(turned, axis=1, keepdims=True)))


def main() -> int:
    """Print a line a call; return 1 if one takes too much."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("names", nargs="*", help="quantities; all of them unless given")
    parser.add_argument("--numbers", type=int, default=300_000)
    parser.add_argument("--seconds", type=float, default=2)
    given = parser.parse_args()
    known = quantities()
    bad = []
    print(f"{'quantity':36} {'numbers of':22} {'how many':>9} {'seconds':>8} {'MiB':>7} {'would':>7}")
    for name in given.names or known:
        for path, call in calls(known[name]):
            try:
                last, would = carried_on(call, given.numbers, given.seconds)
            except Exception as error:
                print(f"{name:36} {path:22} {type(error).__name__}: {error}", flush=True)
                bad.append(f"{name} ({path})")
                continue
            print(
                f"{name:36} {path:22} {last.numbers:9d} {last.seconds:8.2f} {last.mebibytes:7.0f} {would:7.0f}",
                flush=True,
            )
            if would > LIMIT:
                bad.append(f"{name} ({path})")
    print(f"above {LIMIT} MiB: {', '.join(bad) or 'none'}")
    return int(bool(bad))


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    sys.exit(main())
