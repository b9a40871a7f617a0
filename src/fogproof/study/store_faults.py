"""What can be wrong with the store of a study, in sentences from which the study can go on."""

from __future__ import annotations

import sqlite3
from pathlib import Path

from fogproof.errors import FogproofError
from fogproof.study.files import differences

APPLICATION = 0x666F6770  # "fogp"
VERSION = 4
TABLES = {"study", "stretches", "batches", "failures", "sessions"}


class StoreError(FogproofError):
    """The store of a study cannot be read or written; what it holds is kept, and the message says how to go on."""

    code = "store"


class DamagedError(StoreError):
    """The file was a store and can no longer be read as one."""


def require_ours(path: Path, application: int, version: int) -> None:
    """Raise if a file is another program's, or of another version of the store."""
    if application != APPLICATION:
        what = f"{path} is an SQLite file of another program"
        raise StoreError(f"{what}; it was left as it is: choose another folder with -o", str(path))
    if version != VERSION:
        newer = "a newer" if version > VERSION else "an older"
        what = f"{path} has version {version} of the store, this fogproof has version {VERSION}"
        raise StoreError(f"{what}: go on with {newer} fogproof, or choose another folder with -o", str(path))


def require_whole(path: Path, connection: sqlite3.Connection) -> None:
    """Raise if a part of the file is missing; what is in the rows is looked at when they are read."""
    pages = connection.execute("pragma page_count").fetchone()[0] * connection.execute("pragma page_size").fetchone()[0]
    log = path.with_name(path.name + "-wal")
    if path.stat().st_size < pages and not (log.exists() and log.stat().st_size):
        raise damaged(path, "it has been cut short")
    verdict = connection.execute("pragma quick_check(1)").fetchone()[
        0
    ]  # pages that lead in a circle would be read for ever
    if verdict != "ok":
        raise damaged(path, str(verdict).replace("\n", ", "))
    if connection.execute("select count(*) from sqlite_master where type in ('trigger', 'view')").fetchone()[0]:
        raise damaged(path, "it holds triggers or views, which are not ours and could undo what is stored")
    tables = {row[0] for row in connection.execute("select name from sqlite_master where type = 'table'")}
    if not tables >= TABLES:
        raise damaged(path, "tables are missing")


def changed(path: Path, before: str, after: str) -> StoreError:
    """Return what to say where the store is another study's."""
    changes = "\n  ".join(differences(before, after)[:20])
    what = f"the study was changed after {path.parent} was started:\n  {changes}\n"
    fix = "it may ask for more than before, not for other batches in the place of those that are there: change it back"
    return StoreError(f"{what}{fix} to go on there, or choose another folder with -o", str(path))


def gone(path: Path) -> StoreError:
    """Return what to say of a file that was moved or removed under our hands."""
    what = f"{path} was moved or removed while the study ran, with all that was drawn"
    return StoreError(f"{what}; put it back, or start anew, and give the same command again", str(path))


def damaged(path: Path, reason: str) -> DamagedError:
    """Return what to say of a damaged file."""
    fix = "add --salvage to put it aside and go on with the batches that can still be read"
    return DamagedError(f"{path} is damaged: {reason}; {fix}", str(path))


FAULTS = (sqlite3.Error, UnicodeDecodeError)
"""What reading a file by SQLite may raise: the words of an error about a damaged schema may be no text themselves."""


def explained(path: Path, error: sqlite3.Error | UnicodeDecodeError) -> StoreError:
    """Say what an error of SQLite means for the run."""
    if isinstance(error, UnicodeDecodeError) or "decode to UTF-8" in str(error):
        return damaged(path, "a name in its schema is no text")
    text, code = str(error), getattr(error, "sqlite_errorcode", 0) & 0xFF
    kept = "what is there is kept"
    match code:
        case sqlite3.SQLITE_BUSY | sqlite3.SQLITE_LOCKED:
            return StoreError(
                f"another process is working in {path.parent}; wait for it, or choose another folder", str(path)
            )
        case sqlite3.SQLITE_FULL:
            return StoreError(f"no room left for {path}: {kept}; make room and give the same command again", str(path))
        case sqlite3.SQLITE_READONLY | sqlite3.SQLITE_CANTOPEN | sqlite3.SQLITE_PERM:
            what = f"cannot write {path}: {text}"
            return StoreError(f"{what}; {kept}; make the folder writable, or choose another with -o", str(path))
        case sqlite3.SQLITE_IOERR:
            what = f"cannot write {path}: {text}"
            return StoreError(
                f"{what} (no room left, no permission, or a faulty disk); {kept}; then give the same command again",
                str(path),
            )
        case sqlite3.SQLITE_NOTADB:
            return StoreError(
                f"{path} is not an SQLite file; it was left as it is: choose another folder with -o", str(path)
            )
        case sqlite3.SQLITE_CORRUPT:
            return damaged(path, text)
    return StoreError(f"{path}: {text}; {kept}", str(path))
