"""Invariant: what is written comes back; what is broken, lies about its size or would run code is one named error."""

import pickle
import struct

import numpy as np
import pytest

from fogproof.errors import FogproofError, InvalidInputError
from fogproof.images.formats import format_of


def channels(count, rows=5, columns=7):
    rng = np.random.default_rng(3)
    names = ["Y"] if count == 1 else ["R", "G", "B"]
    return {name: rng.random((rows, columns), np.float32) for name in names}


@pytest.mark.parametrize("suffix", ["exr", "npy", "pfm"])
@pytest.mark.parametrize("count", [1, 3])
def test_round_trip(tmp_path, suffix, count):
    path, wanted = tmp_path / f"a.{suffix}", channels(count)
    format_of(path).write(path, wanted)
    found = format_of(path).read(path)
    assert set(found) == set(wanted)
    for name, pixels in wanted.items():
        assert (found[name] == pixels).all()


def test_pfm_is_read_from_the_lowest_row_in_either_order_of_bytes(tmp_path):
    path = tmp_path / "a.pfm"
    path.write_bytes(b"Pf\n2 2\n1.0\n" + struct.pack(">4f", 1, 2, 3, 4))
    assert format_of(path).read(path)["Y"].tolist() == [[3, 4], [1, 2]]


def test_half_stays_half(tmp_path):
    import OpenEXR

    path = tmp_path / "a.exr"
    header = {"compression": OpenEXR.PIZ_COMPRESSION, "type": OpenEXR.scanlineimage}
    OpenEXR.File(header, {"Y": np.ones((3, 3), np.float16)}).write(str(path))
    assert format_of(path).read(path)["Y"].dtype == np.float16


@pytest.mark.parametrize("tiles", [False, True])
@pytest.mark.parametrize("parts", [1, 3])
def test_bytes_after_an_exr_are_found(tmp_path, tiles, parts):
    import OpenEXR

    path = tmp_path / "a.exr"
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.tiledimage if tiles else OpenEXR.scanlineimage}
    if tiles:
        header["tiles"] = OpenEXR.TileDescription()
    made = [
        OpenEXR.Part({**header, "name": f"part{k}"}, {"RGB"[k]: np.full((70, 90), float(k), np.float32)}, f"part{k}")
        for k in range(parts)
    ]
    OpenEXR.File(made).write(str(path))
    whole = path.read_bytes()
    assert list(format_of(path).read(path)) == list("RGB"[:parts])
    for more in (b"\0", whole):
        path.write_bytes(whole + more)
        with pytest.raises(InvalidInputError, match=f"{len(more)} bytes follow the image, which nothing reads"):
            format_of(path).read(path)


def bad_files():
    class Evil:
        def __reduce__(self):
            return (print, ("run",))

    npy = np.lib.format.magic(1, 0) + struct.pack("<H", 118)
    header = b"{'descr': '<f4', 'fortran_order': False, 'shape': (60000, 60000), }"
    objects = b"{'descr': '|O', 'fortran_order': False, 'shape': (2, 2), }"
    yield "lies.npy", npy + header.ljust(117) + b"\n" + b"\0" * 16, "claims 60000 x 60000"
    yield "pickle.npy", npy + objects.ljust(117) + b"\n" + pickle.dumps(Evil()), "an image is of numbers"
    yield "text.npy", b"hello", "not a NumPy array"
    yield "empty.npy", b"", "not a NumPy array"
    yield "lies.pfm", b"PF\n99999 99999\n-1\n" + b"\0" * 12, "claims 99999 x 99999"
    yield "short.pfm", b"PF\n2 2\n-1\n" + b"\0" * 12, "truncated"
    yield "scale.pfm", b"Pf\n1 1\n0\n" + b"\0" * 4, "scale"
    yield "units.pfm", b"Pf\n1 1\n-2.0\n" + b"\0" * 4, "scale is -2, which some readers apply"
    yield "text.pfm", b"P6\n2 2\n255\n", "does not begin like a PFM"
    yield "text.exr", b"hello", "does not begin like an OpenEXR"
    yield "short.exr", b"\x76\x2f\x31\x01" + b"\2\0\0\0", "broken or truncated"
    yield "picture.png", b"\x89PNG", "8-bit"
    yield "picture.xyz", b"", "images are read from"


@pytest.mark.parametrize(("name", "content", "words"), list(bad_files()), ids=lambda x: x if isinstance(x, str) else "")
def test_what_is_no_image_is_one_named_error(tmp_path, name, content, words):
    path = tmp_path / name
    path.write_bytes(content)
    with pytest.raises(InvalidInputError, match=words):
        format_of(path).read(path)


@pytest.mark.parametrize("suffix", ["exr", "npy", "pfm"])
def test_broken_bytes_cost_nothing_but_an_error(tmp_path, suffix):
    path = tmp_path / f"a.{suffix}"
    format_of(path).write(path, channels(3))
    good, rng = path.read_bytes(), np.random.default_rng()
    for _ in range(60):
        bad = bytearray(good)
        for _ in range(rng.integers(1, 6)):
            bad[rng.integers(len(bad) if rng.random() < 0.3 else min(400, len(bad)))] = rng.integers(256)
        path.write_bytes(bytes(bad[: rng.integers(1, len(bad) + 1)] if rng.random() < 0.5 else bad))
        try:
            found = format_of(path).read(path)
        except FogproofError:
            continue
        assert all(pixels.ndim == 2 for pixels in found.values())
