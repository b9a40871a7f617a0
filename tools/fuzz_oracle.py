"""Throw broken lines at `fogproof oracle -`: each may cost its own answer and no other.

python tools/fuzz_oracle.py              20000 lines
python tools/fuzz_oracle.py --lines 1000 --seed 7
python tools/fuzz_oracle.py --lines 100000 --mostly-right

Nine of ten lines are examples of quantities with numbers, keys, kinds, shapes or bytes changed, the tenth is one whose
answer is known; the other way round if they are to be mostly right. All must be answered, in order, the known ones rightly; there
may be no NaN, no negative zero or error, and nothing on stderr. Lines that meet a fault of our own, code "internal", are printed;
then the exit code is 1.
"""

from __future__ import annotations

import argparse
import copy
import json
import random
import secrets
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Iterator
from typing import Any

from fogproof.oracle import answer
from fogproof.quantities import quantities

EVERY = 10

NUMBERS: list[Any] = [
    0, 1, -1, 0.5, -0.0, 2**53 + 1, 10**30, 10**308, -(10**310), 1e-44, 5e-324, 2.2e-308, 1e-160, 1e154, 1e200, 1.7e308,
    -1e308, 1 - 2**-53, 1 + 1e-9, 3.141592653589793, "inf", "-inf", "nan", "1", "", None, True, [], {}, [[]], [1, 2],
    [[1], [2]], [0.1, 0.2, 0.3], [1, [2, 3]], [["a"]], [None], {"kind": "point"}, "\ud800", "\u2028", "x" * 3000,
]  # fmt: skip
TEXTS = [
    b"", b"{", b"}", b"null", b"[]", b"[1]", b'"quantity"', b"{}", b"NaN", b"\x00", b"\xff\xfe{\x00}\x00", b"\xc3\x28",
    b'{"quantity": "phase_pdf"}', b'{"quantity": NaN}', b'{"quantity": "\\ud800"}', b'{"id": 1, "id": 2}', b"\xef\xbb\xbf{}",
    b'{"quantity": "transmittance", "quantity": "free_path"}', b"[" * 100000, b"[" * 400 + b"]" * 400, b"1e999", b"-" * 50,
]  # fmt: skip


def broken_line(rng: random.Random) -> bytes:
    """Return an example with something changed, as one line."""
    quantity = rng.choice(list(quantities().values()))
    request: Any = {"quantity": quantity.name, **copy.deepcopy(quantity.example), "id": -1}
    changes = (scale, scale, scale, change_value, change_value, drop_key, add_key, swap_table, broadcast)
    for _ in range(rng.choice((1, 1, 2, 3))):
        rng.choice(changes)(rng, request)
    text = json.dumps(request, ensure_ascii=rng.random() < 0.5).encode("utf-8", "surrogatepass")
    match rng.randrange(18):
        case 0:
            return rng.choice(TEXTS) or b"?"
        case 1:
            at = rng.randrange(len(text))
            return text[:at] + bytes([rng.choice([c for c in range(256) if c != 10])]) + text[at + 1 :]
        case 2:
            return text[: rng.randrange(1, len(text))]
        case 3:
            digits = rng.choice(
                (b"7" * 5000, b"1e400", b"NaN", b"-Infinity", b"0x10", b"1" * 400, b"01", b"-0.0", b"1E5")
            )
            return text.replace(b"0", digits, 1)
        case 4:
            depth = rng.choice((10, 63, 64, 65, 100, 300, 500, 900, 990, 5000))
            return text.replace(b"1", b"[" * depth + b"1" + b"]" * depth, 1)
        case 5:
            return text[:-1] + b", " + text[1:]
    return text


def places(value: Any) -> Iterator[tuple[Any, Any]]:
    """Yield (container, key) of everything in a request but its name."""
    for key in list(value) if isinstance(value, dict) else range(len(value)) if isinstance(value, list) else ():
        if key != "quantity":
            yield value, key
            yield from places(value[key])


def any_place(rng: random.Random, request: Any) -> tuple[Any, Any]:
    """Return the container and the key of something in a request."""
    return rng.choice(list(places(request)))


def change_value(rng: random.Random, request: Any) -> None:
    """Put something else in place of a value."""
    container, key = any_place(rng, request)
    container[key] = copy.deepcopy(rng.choice(NUMBERS))


def scale(rng: random.Random, request: Any) -> None:
    """Put another number in place of one: near it, or many orders away."""
    numbers = [(c, k) for c, k in places(request) if type(c[k]) in (int, float) and abs(c[k]) < 1e300]
    if numbers:
        container, key = rng.choice(numbers)
        power = rng.choice((rng.uniform(-1, 1), rng.uniform(-20, 20), rng.uniform(-320, 300)))
        container[key] = (container[key] or rng.choice((1e-9, 1.0))) * 10.0**power


def drop_key(rng: random.Random, request: Any) -> None:
    """Leave something out."""
    container, key = any_place(rng, request)
    if key != "id":
        del container[key]


def add_key(rng: random.Random, request: Any) -> None:
    """Add a key, known or unknown."""
    keys = [*quantities()[request["quantity"]].arguments, "kind", "", "\x00", "luck"]
    request[rng.choice(keys)] = copy.deepcopy(rng.choice(NUMBERS))


def swap_table(rng: random.Random, request: Any) -> None:
    """Put a table of another example in place of one."""
    tables = [(c, k) for c, k in places(request) if isinstance(c[k], dict)]
    others = [(c, k) for q in quantities().values() for c, k in places(q.example) if isinstance(c[k], dict)]
    if tables:
        (container, key), (other, name) = rng.choice(tables), rng.choice(others)
        container[key] = copy.deepcopy(other[name])


def broadcast(rng: random.Random, request: Any) -> None:
    """Give a number many axes, or values enough to be too many."""
    container, key = any_place(rng, request)
    if isinstance(container[key], int | float):
        n = rng.choice((0, 1, 2, 3, 7, 3000))
        container[key] = rng.choice(([container[key]] * n, [[container[key]]] * n, [[container[key]] * n]))


def known_lines(rng: random.Random) -> tuple[list[dict[str, Any]], list[dict[str, Any]]]:
    """Return cheap requests, and their answers found one by one."""
    phase = {"kind": "henyey-greenstein", "g": 0.6}
    requests = [
        {"quantity": "phase_pdf", "phase": phase, "mu": rng.uniform(-1, 1)},
        {"quantity": "airlight_integral", "sigma_t": rng.random(), "h": 1, "a": -2, "b": "inf"},
        {"quantity": "plane_parallel_sky", "tau": rng.random(), "mu_sun": 0.5, "mu_view": [0.5, 0.9], "azimuth": 0},
    ]
    return requests, [answer(request) for request in requests]


def fuzz(lines: int, seed: int, seconds: float = 5.0, mostly_right: bool = False) -> Counter[str]:
    """Return what became of each line, and raise `AssertionError` for what must not be; faults of our own are counted."""
    rng = random.Random(seed)
    requests, answers = known_lines(rng)
    sent = [
        json.dumps({**requests[i % len(requests)], "id": i}).encode() if _known(i, mostly_right) else broken_line(rng)
        for i in range(lines)
    ]
    command = [sys.executable, "-c", "from fogproof.cli import main; main()", "oracle", "-", "--timeout", str(seconds)]
    run = subprocess.run(command, input=b"\n".join(sent), capture_output=True, timeout=60 + lines, check=False)
    assert run.returncode == 2, f"exit code {run.returncode}: {run.stderr[-500:]!r}"
    assert not run.stderr, run.stderr[-2000:]
    replies = run.stdout.split(b"\n")[:-1]
    assert len(replies) == len(sent), f"{len(sent)} lines, {len(replies)} answers"
    outcomes: Counter[str] = Counter()
    for i, (line, text) in enumerate(zip(sent, replies, strict=True)):
        reply = json.loads(text, parse_constant=lambda name: f"constant {name}")
        told = f"line {i}: {line[:600]!r} -> {text[:600]!r}"
        code = reply["error"]["code"] if "value" not in reply else "answered"
        outcomes[code] += 1
        if code == "internal":
            print(told)
        if code == "answered":
            numbers = [*flat(reply["value"]), *flat(reply["error"])]
            assert all(n in ("inf", "-inf") or (isinstance(n, int | float) and str(n) != "-0.0") for n in numbers), told
            assert all(n == "inf" or n >= 0 for n in flat(reply["error"])), told
        if _known(i, mostly_right):
            right = answers[i % len(requests)]
            assert (code, reply.get("id")) == ("answered", i), told
            pairs = zip(flat(reply["value"]), flat(right["value"].tolist()), flat(right["error"].tolist()), strict=True)
            assert all(abs(value - truth) <= 2 * error for value, truth, error in pairs), told
    return outcomes


def _known(line: int, mostly_right: bool) -> bool:
    return (line % EVERY == 0) != mostly_right


def flat(value: Any) -> Iterator[Any]:
    """Yield the numbers of nested lists."""
    if isinstance(value, list):
        for item in value:
            yield from flat(item)
    else:
        yield value


def main() -> None:
    """Fuzz and say what became of the lines."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--lines", type=int, default=20_000)
    parser.add_argument("--seed", type=int, default=secrets.randbits(32))
    parser.add_argument("--mostly-right", action="store_true", help="every tenth line is broken, the others are not")
    options = parser.parse_args()
    print(f"seed {options.seed}", flush=True)
    start = time.monotonic()
    outcomes = fuzz(options.lines, options.seed, mostly_right=options.mostly_right)
    print(f"{options.lines} lines in {time.monotonic() - start:.0f} s, all answered in order: {dict(outcomes)}")
    sys.exit(1 if outcomes["internal"] else 0)


if __name__ == "__main__":
    main()
