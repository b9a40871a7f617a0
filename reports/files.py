"""Files that never stand in the place of somebody else's."""

from __future__ import annotations

import contextlib
import glob
import json
import os
import re
import struct
import sys
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path

from fogproof.errors import InvalidInputError
from fogproof.whole_files import begun, content_bytes, short_name, write_file

FIGURES = ("figures/*.png", "figures/*.svg")
"""Pictures beside a page: which ones, a run may show only when it is over."""

REPORT = ("index.html", "results.json", "results.csv", "junit.xml", *FIGURES)
"""What a report writes into its folder."""

COMPARISON = ("comparison.html", "before.json", "after.json")
"""What a comparison of two runs adds."""

_HEAD = 65536
_PAGES = {
    ".html": re.compile(rb" \xe2\x80\x93 fogproof [^<]*</title>"),
    ".md": re.compile(rb"\nWritten by `fogproof [a-z]+"),
    ".png": re.compile(rb"tEXtSoftware\0fogproof"),
    ".svg": re.compile(rb"<!-- fogproof -->"),
}
_RECORD = re.compile(rb'\{\s*"(schema|format)":\s*"fogproof')
"""How most records begin: one that was cut says still whose it is."""
_PLAIN = "scene.json"
"""The end of names of records without a mark: renderers read them."""


def prepare_folder(folder: Path, names: tuple[str, ...] = REPORT, force: bool | None = None) -> None:
    """Make `folder` and see that it can be written, and that no file of somebody else's is replaced.

    A page or picture is ours if it says so, a record if its `schema` (`format`) is one of ours. Of what bears no mark, such as a
    table, the records beside it decide. A file that is empty or all NUL, as a power cut leaves those that were just written, is
    ours if anything beside it is. Better to learn all that before a run than after it. What fails leaves no folder behind.

    names  of the files that will be written there; a pattern stands for all that are there
    force  replace whatever is there; None where nobody can ask for that
    """
    records = [folder / name for name in names if name.endswith(".json") and not name.endswith(_PLAIN)]
    there = [] if force else [path for path in _written(folder, names) if os.path.lexists(path)]
    marked = [path for path in there if path.suffix in _PAGES or path in records]
    ours = {path for path in marked if _is_ours(path)}
    lost = {path for path in marked if ours and _is_blank(path)}
    beside = ours if lost.intersection(records) else ours.intersection(records)
    for path in there:
        if path not in ours | lost and (path in marked or not beside):
            fix = "choose another folder" + ("" if force is None else ", or add --force to replace it")
            raise InvalidInputError(f"{path} was not written by fogproof; {fix}", str(path))
    probe = folder / begun("probe", os.getpid())
    write_file(probe, b"")
    probe.unlink(missing_ok=True)
    _clear_unfinished(folder, (*names, "probe", ".probe.*"))


def _clear_unfinished(folder: Path, names: Iterable[str]) -> None:
    """Remove what killed processes left of files of these names (or patterns): what `write_file` had begun."""
    for name in map(Path, names):
        for path in (folder / name.parent).glob(begun(name.name, "*")):
            with contextlib.suppress(OSError, ValueError):  # somebody removes it at the same time; no process's number
                if not _runs(int(path.name.split(".")[-2])):
                    path.unlink()


def _runs(process: int) -> bool:
    """Whether a process is there, of whomever; where nobody can be asked it is."""
    if os.name != "posix":
        return True
    try:
        os.kill(process, 0)
    except ProcessLookupError:
        return False
    except (OSError, OverflowError):
        return True
    return True


def _written(folder: Path, names: Iterable[str]) -> Iterator[Path]:
    """Yield the files of these names, of patterns those that are there."""
    for name in names:
        if "*" in name:
            yield from sorted(folder.glob(name))
        else:
            yield folder / name


@contextlib.contextmanager
def locked(folder: Path) -> Iterator[None]:
    """Keep a folder that is there from other runs of fogproof.

    The lock is the folder's own: no file is left, and a process that is killed holds it no more. Systems of files without locks
    have none.
    """
    try:
        import fcntl
    except ImportError:  # Windows
        yield
        return
    try:
        opened = os.open(folder, os.O_RDONLY)
    except OSError:
        yield
        return
    try:
        with contextlib.suppress(OSError):
            try:
                fcntl.flock(opened, fcntl.LOCK_EX | fcntl.LOCK_NB)
            except BlockingIOError:
                what = f"another run of fogproof writes into {folder}; wait for its end, or choose another folder"
                raise InvalidInputError(what, str(folder)) from None
        yield
    finally:
        os.close(opened)


def _is_ours(path: Path) -> bool:
    """Whether a file bears our mark; anything that is no file does not."""
    if not path.is_file():
        return False
    try:
        if path.suffix in _PAGES:
            with path.open("rb") as page:
                return _PAGES[path.suffix].search(page.read(_HEAD)) is not None
        content = path.read_bytes()
        if _RECORD.match(content):
            return True
        record = json.loads(content)
    except (OSError, ValueError, RecursionError):
        return False
    mark = record.get("schema", record.get("format")) if isinstance(record, dict) else None
    return isinstance(mark, str) and mark.startswith("fogproof")


def _is_blank(path: Path) -> bool:
    """Whether a file is empty, or holds NULs alone."""
    try:
        return path.is_file() and not path.read_bytes().strip(b"\0")
    except OSError:
        return False


def require_other(output: str | Path, *sources: str | Path) -> None:
    """Refuse to write a file that is read; the source "-" is what stdin reads."""
    if any(_is_same(output, source) for source in sources):
        raise InvalidInputError(f"{output} is the file that is read; write to another", str(output))


def _is_same(output: str | Path, source: str | Path) -> bool:
    with contextlib.suppress(OSError, ValueError, AttributeError):  # one of them is not there, or no file
        if source != "-":
            return os.path.samefile(output, source)
        return os.path.isfile(output) and os.path.samestat(os.stat(output), os.fstat(sys.stdin.fileno()))
    return False


def write_output(output: str | Path, content: str | bytes, *sources: str | Path) -> Path:
    """Write the file that a user names: links are followed, devices and pipes written into, anything else put there whole.

    sources  files that the content was made from, which it must not replace
    """
    require_other(output, *sources)
    path = Path(output)
    if path.is_file() or not path.exists() or path.is_dir():
        path = Path(os.path.realpath(path))
        _clear_unfinished(path.parent, [glob.escape(short_name(path.name))])
        return write_file(path, content)
    try:  # by its own name: what /dev/stdout leads to may have none
        path.write_bytes(content_bytes(content))
    except OSError as error:
        raise InvalidInputError(f"cannot write {output}: {error.strerror}", str(output)) from None
    return path


def write_picture(path: Path, content: str | bytes) -> Path:
    """Write a PNG (bytes) or an SVG (text) with the mark by which it is known as ours."""
    if isinstance(content, str):
        return write_file(path, content.replace("<svg", "<!-- fogproof -->\n<svg", 1))
    chunk = b"tEXtSoftware\0fogproof"
    packed = struct.pack(">I", len(chunk) - 4) + chunk + struct.pack(">I", zlib.crc32(chunk))
    after = 8 + 25  # the signature and the first chunk, IHDR
    return write_file(path, content[:after] + packed + content[after:])
