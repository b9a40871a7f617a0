"""OpenEXR, by its own library; the header is read first, so that nothing lies about sizes unseen."""

from __future__ import annotations

import contextlib
import os
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.errors import InvalidInputError, NotInstalledError
from fogproof.images.exr_chunks import end_of_chunks
from fogproof.images.formats import LARGEST, Channels, too_large
from fogproof.input_files import open_regular, size_of
from fogproof.reports.files import write_output


def read(path: Path) -> Channels:
    """Read the channels of all flat parts; those of later parts that share a name carry the part's name before it."""
    exr = _library()
    with open_regular(path, "the image") as file:
        if file.read(4) != b"\x76\x2f\x31\x01":
            raise InvalidInputError(f"{path}: does not begin like an OpenEXR file", str(path))
        file.seek(0)
        try:
            for part in exr.File(file, header_only=True).parts:
                _check(path, part)
            file.seek(0)
            with _stdout_kept():
                parts = exr.File(file, separate_channels=True, num_threads=1).parts
            found: Channels = {}
            for part in parts:
                for name, channel in part.channels.items():
                    key = f"{part.header.get('name', 'part')}.{name}" if name in found else name
                    found[key] = np.asarray(channel.pixels)
            end = end_of_chunks(file, ["tile" in str(part.header["type"]) for part in parts])
            more = 0 if end is None else size_of(file) - end
        except InvalidInputError:
            raise
        except (RuntimeError, ValueError, TypeError, KeyError, OSError, MemoryError, UnicodeDecodeError) as error:
            reason = str(error).splitlines()[0] if str(error) else type(error).__name__
            raise InvalidInputError(f"{path}: is a broken or truncated OpenEXR file: {reason}", str(path)) from None
    if more > 0:
        what = f"{more} bytes follow the image, which nothing reads: it is broken, or two files were joined"
        raise InvalidInputError(f"{path}: {what}", str(path))
    if not found:
        raise InvalidInputError(f"{path}: is broken or truncated: no channel of it can be read", str(path))
    if len({pixels.shape for pixels in found.values()}) > 1:
        raise InvalidInputError(f"{path}: its channels or parts differ in size", str(path))
    return found


@contextlib.contextmanager
def _stdout_kept() -> Iterator[None]:
    """Send to stderr what the library prints on stdout about broken files: stdout is for programs."""
    try:
        kept = os.dup(1)
    except OSError:  # there is no stdout
        yield
        return
    try:
        with contextlib.suppress(OSError):
            os.dup2(2, 1)
        yield
    finally:
        os.dup2(kept, 1)
        os.close(kept)


def _check(path: Path, part: Any) -> None:
    header = part.header
    low, high = (np.asarray(corner, np.int64) for corner in header["dataWindow"])
    columns, rows = (int(n) for n in high - low + 1)
    channels = header["channels"]
    if columns < 1 or rows < 1 or 4 * columns * rows * max(len(channels), 1) > LARGEST:
        raise too_large(path, columns, rows, len(channels))
    if any(channel.xSampling != 1 or channel.ySampling != 1 for channel in channels):
        raise InvalidInputError(f"{path}: has subsampled channels (luminance and chroma); write R, G and B", str(path))
    if "deep" in str(header["type"]):
        raise InvalidInputError(f"{path}: is a deep image; write a flat one", str(path))


def write(path: Path, channels: Channels) -> None:
    """Write channels in single precision, ZIP-compressed."""
    exr = _library()
    header = {"compression": exr.ZIP_COMPRESSION, "type": exr.scanlineimage}
    pixels = {name: np.ascontiguousarray(channel, np.float32) for name, channel in channels.items()}
    try:
        with tempfile.TemporaryDirectory() as folder:
            whole = Path(folder) / "image.exr"
            exr.File(header, pixels).write(str(whole))
            content = whole.read_bytes()
    except (RuntimeError, OSError) as error:
        raise InvalidInputError(
            f"cannot write {path}: {getattr(error, 'strerror', None) or error}", str(path)
        ) from None
    write_output(path, content)


def _library() -> Any:
    try:
        import OpenEXR
    except ImportError:
        raise NotInstalledError("OpenEXR", "images") from None
    return OpenEXR
