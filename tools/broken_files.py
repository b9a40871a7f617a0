"""Broken files: valid ones of every kind that is read, with a few seeded changes of bytes, headers, numbers, keys and types."""

from __future__ import annotations

import copy
import io
import json
import random
import struct
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.images.formats import format_of

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fixtures"))

VALUES: list[Any] = [
    0, 1, -1, 0.5, -0.0, 10**30, 10**308, -(10**310), 5e-324, 1e200, float("inf"), float("nan"), "inf", "nan", "1", "", None,
    True, [], {}, [[]], [1, 2], [0.1, 0.2, 0.3], [1, [2, 3]], ["a"], [None], {"kind": "point"}, "\x1b[31m", "\u202e", "x" * 3000,
]  # fmt: skip
KINDS = [
    "<f8",
    "<f4",
    ">f4",
    "|u1",
    "<i8",
    "|O",
    "<U4",
    "<c16",
    "|V8",
    "|b1",
    "<f16",
    "<M8[s]",
    [("a", "<f8")],
    "f9",
    "",
    3,
    None,
]
SIZES = [0, 1, 2, 3, -1, 2**31, 2**32, 2**62, 2**64, 10**30, True, 1.5, "2", None]
SCENE = {
    "scattering": "single", "background": 0.5,
    "medium": {"sigma_a": 0.1, "sigma_s": 0.2, "phase": {"kind": "henyey-greenstein", "g": 0.5}},
    "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 4}, "light": {"position": [0, 1, 2], "intensity": 3},
}  # fmt: skip
STUDY = {
    "title": "a study", "samples": [10, 100], "replicates": 8,
    "scenes": [{
        "name": "lamp", "quantity": "airlight", "medium": {"sigma_a": 0.1, "sigma_s": 0.2},
        "ray": {"origin": [0, 0, 0], "direction": [0, 0, 1], "length": 4}, "light": {"position": [0, 1, 2], "intensity": 3},
        "estimators": [{"kind": "airlight", "placing": "equiangular"}, {"kind": "mis"}],
    }],
}  # fmt: skip

SPEC = {
    "dimensions": 2, "axis": [0, 0, 1], "phase": {"kind": "henyey-greenstein", "g": "$g"}, "parameters": {"g": 0.5},
    "family": {"g": [0.1, 0.5]}, "columns": ["x", "x", "x"], "type": "float32",
}  # fmt: skip


def broken_bytes(rng: random.Random, data: bytes) -> bytes:
    """Return the bytes with up to three changes."""
    for _ in range(rng.randrange(4)):
        at = rng.randrange(len(data) + 1)
        match rng.randrange(5):
            case 0:
                data = data[:at]
            case 1:
                data = data[:at] + rng.randbytes(rng.randrange(1, 9)) + data[at:]
            case 2:
                data = data[:at] + data[at + rng.randrange(1, 9) :]
            case 3:
                data = rng.choice((b"", b"PK\x03\x04", b"\x00", b"\x80\x04")) + data
            case _:
                data = data[:at] + bytes([rng.randrange(256)]) + data[at + 1 :]
    return data


def broken_table(rng: random.Random, table: Any) -> Any:
    """Return the table with one to three values, keys or types exchanged."""
    table = copy.deepcopy(table)
    for _ in range(rng.randrange(1, 4)):
        places = list(_places(table))
        if not places:
            break
        inside, key = rng.choice(places)
        match rng.randrange(5):
            case 0:
                del inside[key]
            case 1 if isinstance(inside, dict):
                inside[rng.choice(("kind", "x", "", "length", "\x1b"))] = rng.choice(VALUES)
            case 2 if isinstance(inside[key], int | float) and abs(inside[key]) < 1e300:
                inside[key] = -inside[key] if rng.random() < 0.3 else inside[key] * 10.0 ** rng.randrange(-300, 300, 50)
            case _:
                inside[key] = copy.deepcopy(rng.choice(VALUES))
    return table


def _places(table: Any) -> Iterator[tuple[Any, Any]]:
    for key in table if isinstance(table, dict) else range(len(table)):
        yield table, key
        if isinstance(table[key], dict | list):
            yield from _places(table[key])


def npy(rng: random.Random) -> bytes:
    """Return a grid whose header may lie."""
    out = io.BytesIO()
    np.save(out, np.arange(24, dtype=rng.choice(("<f8", "<f4", ">f4", "u1", "<i8"))).reshape(2, 3, 4))
    data = out.getvalue()
    if rng.random() < 0.6:
        shape = tuple(rng.choice(SIZES) for _ in range(rng.randrange(6)))
        table = {"descr": rng.choice(KINDS), "fortran_order": rng.choice((True, False, 1, None)), "shape": shape}
        if rng.random() < 0.2:
            del table[rng.choice(list(table))]
        header = repr(table).encode() if rng.random() < 0.9 else b"(" * rng.randrange(3000)
        data = b"\x93NUMPY\x01\x00" + struct.pack("<H", len(header) + 1) + header + b"\n" + data[128:]
    return broken_bytes(rng, data)


def vol(rng: random.Random) -> bytes:
    """Return a grid whose header may lie."""
    sizes = [rng.choice((1, 2, 3, 0, -1, 2**31 - 1, 2**16)) if rng.random() < 0.1 else 2 for _ in range(4)]
    box = [
        rng.choice((0.0, 1.0, -1.0, float("nan"), float("inf"), 1e38)) if rng.random() < 0.05 else k // 3
        for k in range(6)
    ]
    head = struct.pack("<3sBi4i6f", b"VOL", rng.choice((3, 3, 3, 0, 255)), rng.choice((1, 1, 3, 0, -5)), *sizes, *box)
    return broken_bytes(rng, head + np.linspace(0, 1, 16, dtype="<f4").tobytes())


def nvdb(rng: random.Random) -> bytes:
    """Return a sparse grid, of which headers and tables are more often broken than values."""
    from nanovdb_writer import nanovdb_bytes

    codec = rng.randrange(2)
    data = bytearray(nanovdb_bytes({(1, 2, 3): 0.5, (9, 2, 3): 1.0}, np.eye(3), (0, 0, 0), codec=codec))
    for _ in range(rng.randrange(3)):
        data[rng.randrange(min(len(data), rng.choice((16, 300, 1200, 300_000))))] = rng.randrange(256)
    return broken_bytes(rng, bytes(data))


def image(rng: random.Random, path: Path) -> bytes:
    """Return an image of the format that the path's suffix says."""
    value = np.random.default_rng(rng.randrange(2**32)).random((5, 7), np.float32)
    format_of(path).write(path, dict.fromkeys(rng.choice(("Y", "RGB")), value))
    data = bytearray(path.read_bytes())
    for _ in range(rng.randrange(4)):
        data[rng.randrange(min(len(data), 500))] = rng.randrange(256)
    return broken_bytes(rng, bytes(data))


def rows(rng: random.Random) -> bytes:
    """Return samples as text."""
    lines = [",".join(str(rng.random()) for _ in range(3)) for _ in range(20)]
    return broken_bytes(rng, "\n".join(rng.choice(([], ["x,x,pdf"])) + lines).encode())


def toml(value: Any, top: bool = True) -> str:
    """Return a table as TOML; what TOML has no word for, as it comes."""
    if isinstance(value, dict):
        rows = [f"{json.dumps(str(key))} = {toml(item, top=False)}" for key, item in value.items()]
        return "\n".join(rows) if top else "{" + ", ".join(rows) + "}"
    if isinstance(value, list):
        return "[" + ", ".join(toml(item, top=False) for item in value) + "]"
    return json.dumps(value).replace("Infinity", "inf").replace("NaN", "nan")


def text_of(rng: random.Random, table: Any) -> bytes:
    """Return a broken table as JSON, perhaps broken as a text too."""
    text = json.dumps(broken_table(rng, table)).encode()
    return broken_bytes(rng, text) if rng.random() < 0.2 else text
