"""Invariant: a file from outside is read or refused by a named error, before memory is taken for it and without waiting."""

import io
import os
import struct

import numpy as np
import pytest
from fuzz_files import fuzz
from report_records import typical

from fogproof.checks.json_values import jsonable
from fogproof.errors import FogproofError, InvalidInputError
from fogproof.reports.records.runs import load_record
from fogproof.scene.files import read_scene
from fogproof.scene.volume_files import read_voxel_grid
from fogproof.study.files import read_study

READERS = {
    "grid.npy": lambda path: read_voxel_grid(path, lower=(0, 0, 0), upper=(1, 1, 1)),
    "grid.vol": read_voxel_grid,
    "scene.toml": read_scene,
    "study.toml": read_study,
    "results.json": lambda path: load_record(path.parent),
}


def header(text, version=1):
    data = text.encode() + b"\n"
    return b"\x93NUMPY" + bytes([version, 0]) + struct.pack("<H" if version == 1 else "<I", len(data)) + data


def array(values):
    out = io.BytesIO()
    np.save(out, values)
    return out.getvalue()


def described(shape, descr="'<f8'"):
    return header(f"{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}}}") + b"\0" * 8


LIES = {
    "huge": described("(99999, 99999, 99999)"),
    "more than 64 bits": described("(4294967296, 4294967296, 4)"),
    "of nothing": described("(0, 4294967296, 4294967296)"),
    "negative": described("(-1, -1, 1)"),
    "short": described("(1, 1, 2)"),
    "long": described("(1, 1, 1)") + b"\0",
    "objects": described("(1, 1, 1)", "'|O'"),
    "complex": described("(1, 1, 1)", "'<c16'"),
    "void": described("(1, 1, 1)", "'V0'"),
    "fields": described("(1, 1, 1)", "[('a', '<f8')]"),
    "code": header("__import__('os').abort()"),
    "nested": header("(" * 500),
    "unended": header("{'descr': '<f8', 'shape': (1,"),
    "long header": header("{}" + " " * 10**6, version=2),
    "archive": b"PK\x03\x04" + b"\0" * 40,
    "empty": b"",
    "two axes": array(np.ones((2, 2))),
    "not a number": array(np.full((1, 1, 1), np.nan)),
}


@pytest.mark.parametrize("data", LIES.values(), ids=LIES)
def test_a_lying_header_is_named(tmp_path, data):
    path = tmp_path / "grid.npy"
    path.write_bytes(data)
    with pytest.raises(FogproofError, match=r"grid\.npy"):
        READERS["grid.npy"](path)


def test_a_vol_header_that_lies(tmp_path):
    path = tmp_path / "grid.vol"
    for sizes in ((2**31 - 1,) * 4, (2, 2, 2, 1), (0, 1, 1, 1)):
        path.write_bytes(struct.pack("<3sBi4i6f", b"VOL", 3, 1, *sizes, 0, 0, 0, 1, 1, 1))
        with pytest.raises(FogproofError, match=r"grid\.vol"):
            read_voxel_grid(path)


@pytest.mark.parametrize("order", ["C", "F"])
@pytest.mark.parametrize("kind", ["<f8", ">f4", "<f2", "u1", "<i8"])
def test_what_is_right_is_read(tmp_path, order, kind):
    values = np.arange(24, dtype=kind).reshape(2, 3, 4)
    np.save(tmp_path / "grid.npy", np.asarray(values, order=order))
    assert np.array_equal(READERS["grid.npy"](tmp_path / "grid.npy").sigma_t, values)


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system has no pipes with names")
@pytest.mark.parametrize("name", READERS)
@pytest.mark.parametrize("what", ["folder", "pipe", "device"])
def test_only_regular_files_are_read(tmp_path, name, what):
    path = tmp_path / name
    {"folder": path.mkdir, "pipe": lambda: os.mkfifo(path), "device": lambda: path.symlink_to("/dev/zero")}[what]()
    with pytest.raises(InvalidInputError, match="cannot read"):
        READERS[name](path)


def test_broken_files(tmp_path):
    counts, faults = fuzz(300, 1, tmp_path, jsonable(typical(2)))
    assert not faults
    assert counts.total() == 300
    assert min(counts[f"{kind} refused"] for kind in ("npy", "vol", "scene", "study", "record", "results")) > 2
