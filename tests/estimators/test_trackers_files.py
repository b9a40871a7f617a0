"""Protects: voxel grids read from files have every value in its place, and a bad file is a sentence, never a traceback."""

from __future__ import annotations

import struct
from pathlib import Path

import numpy as np
import pytest

import fogproof
from fogproof.errors import FogproofError, InvalidInputError, InvalidValueError, UnsupportedError

BOX = {"lower": (0, 0, 0), "upper": (1, 2, 3)}


def vol(values: np.ndarray, *, encoding: int = 1, version: int = 3, magic: bytes = b"VOL") -> bytes:
    """Return a .vol file of values (nx, ny, nz, channels), written value by value."""
    nx, ny, nz, channels = values.shape
    data = magic + struct.pack("<b5i6f", version, encoding, nx, ny, nz, channels, -1, -2, -3, 1, 2, 3)
    for z in range(nz):
        for y in range(ny):
            for x in range(nx):
                for c in range(channels):
                    value = values[x, y, z, c]
                    data += struct.pack("<f", value) if encoding == 1 else struct.pack("<B", int(value))
    return data


@pytest.mark.parametrize("channels", [1, 3])
def test_vol_float32(tmp_path: Path, channels: int) -> None:
    values = np.random.default_rng(0).random((2, 3, 4, channels)).astype(np.float32)
    path = tmp_path / "smoke.vol"
    path.write_bytes(vol(values))
    grid = fogproof.read_voxel_grid(path, scale=2.0, interpolation="nearest", albedo=0.5)
    expected = 2.0 * values.astype(np.float64)
    assert np.array_equal(grid.sigma_t, expected[..., 0] if channels == 1 else expected)
    assert grid.lower.tolist() == [-1, -2, -3]
    assert grid.upper.tolist() == [1, 2, 3]
    assert (grid.interpolation, float(grid.albedo)) == ("nearest", 0.5)


def test_vol_bytes(tmp_path: Path) -> None:
    values = np.arange(24.0).reshape(2, 3, 4, 1) * 10
    path = tmp_path / "smoke.vol"
    path.write_bytes(vol(values, encoding=3))
    assert np.allclose(fogproof.read_voxel_grid(path).sigma_t, values[..., 0] / 255, rtol=1e-15)


def test_vol_written_by_mitsuba(tmp_path: Path) -> None:
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    values = np.random.default_rng(1).random((4, 3, 2, 1)).astype(np.float32)  # z, y, x, channel
    path = tmp_path / "smoke.vol"
    mitsuba.VolumeGrid(values).write(str(path))
    grid = fogproof.read_voxel_grid(path)
    assert np.array_equal(grid.sigma_t, values[..., 0].transpose(2, 1, 0))


@pytest.mark.parametrize("kind", [np.float32, np.float64, np.uint8])
def test_npy(tmp_path: Path, kind: type) -> None:
    values = (np.arange(24).reshape(2, 3, 4)).astype(kind)
    np.save(tmp_path / "smoke.npy", values)
    grid = fogproof.read_voxel_grid(tmp_path / "smoke.npy", scale=0.5, **BOX)
    assert np.array_equal(grid.sigma_t, 0.5 * values.astype(float))


def with_nan() -> np.ndarray:
    values = np.ones((2, 2, 2, 1))
    values[1, 0, 1] = np.nan
    return values


BAD_VOL = {
    "too short": (b"VOL\x03", InvalidInputError, "header"),
    "another format": (vol(np.ones((1, 1, 1, 1)), magic=b"XYZ"), InvalidInputError, "VOL"),
    "version": (vol(np.ones((1, 1, 1, 1)), version=2), UnsupportedError, "version 3"),
    "encoding": (
        vol(np.ones((1, 1, 1, 1)), encoding=3).replace(b"\x03\x03", b"\x03\x02"),
        UnsupportedError,
        "encoding 2",
    ),
    "truncated": (vol(np.ones((2, 2, 2, 1)))[:-1], InvalidInputError, "32 bytes"),
    "too long": (vol(np.ones((2, 2, 2, 1))) + b"\0", InvalidInputError, "32 bytes"),
    "empty": (vol(np.ones((0, 2, 2, 1))), InvalidInputError, "empty grid"),
    "nan": (vol(with_nan()), InvalidValueError, "finite"),
    "negative": (vol(-np.ones((2, 2, 2, 1))), InvalidValueError, ">= 0"),
}


@pytest.mark.parametrize("name", BAD_VOL)
def test_bad_vol(tmp_path: Path, name: str) -> None:
    data, error, words = BAD_VOL[name]
    path = tmp_path / "smoke.vol"
    path.write_bytes(data)
    with pytest.raises(error, match=words) as caught:
        fogproof.read_voxel_grid(path)
    assert "smoke.vol" in str(caught.value)


def saved(array: np.ndarray) -> bytes:
    import io

    stream = io.BytesIO()
    np.save(stream, array, allow_pickle=True)
    return stream.getvalue()


BAD_NPY = {
    "garbage": b"not an array",
    "nothing": b"",
    "pickled objects": saved(np.array([{}], dtype=object)),
    "text": saved(np.array(["a"])),
    "flat": saved(np.ones(3)),
    "no voxels": saved(np.ones((0, 2, 2))),
    "nan": saved(np.full((2, 2, 2), np.nan)),
    "infinite": saved(np.full((2, 2, 2), np.inf)),
    "negative": saved(np.full((2, 2, 2), -1.0)),
}


@pytest.mark.parametrize("name", BAD_NPY)
def test_bad_npy(tmp_path: Path, name: str) -> None:
    path = tmp_path / "smoke.npy"
    path.write_bytes(BAD_NPY[name])
    with pytest.raises(FogproofError, match=r"smoke\.npy"):
        fogproof.read_voxel_grid(path, **BOX)


def test_what_else_can_be_wrong(tmp_path: Path) -> None:
    np.save(tmp_path / "smoke.npy", np.ones((2, 2, 2)))
    with pytest.raises(InvalidValueError, match="lower"):
        fogproof.read_voxel_grid(tmp_path / "smoke.npy")
    with pytest.raises(InvalidInputError, match="cannot read"):
        fogproof.read_voxel_grid(tmp_path / "absent.npy", **BOX)
    with pytest.raises(UnsupportedError, match=r"\.vdb"):
        fogproof.read_voxel_grid(tmp_path / "smoke.vdb", **BOX)
    with pytest.raises(InvalidValueError, match="scale"):
        fogproof.read_voxel_grid(tmp_path / "smoke.npy", scale=-1.0, **BOX)
