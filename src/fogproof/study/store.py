"""The store of a study: an SQLite file in the run folder that holds every batch drawn so far, whatever happens.

Each batch, or handful of batches that arrived together, is one transaction of a write-ahead log. One process at a time works on a
folder: it holds SQLite's own lock, which the system takes back when the process dies. A file that is not such a store, or belongs
to another study or another version, is never touched.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
import zlib
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from fogproof.errors import FogproofError
from fogproof.study.batches import COLUMNS, BatchResult
from fogproof.study.files import Study, differences

FILE = "study.sqlite"
APPLICATION = 0x666F6770  # "fogp"
VERSION = 1
_TABLES = """
create table study (key text primary key, value text not null) without rowid;
create table batches (id integer primary key, moments blob not null, tail blob not null, cost real, wall real not null,
                      cpu real not null, crc integer not null);
create table failures (id integer primary key, attempts integer not null, error text not null);
create table sessions (started text not null, environment text not null);
"""

_COLUMNS = "id, moments, tail, cost, wall, cpu, crc"
Row = tuple[int, bytes, bytes, float | None, float, float, int]
"""A batch as it is stored, see `BatchResult`; the last is a checksum of both arrays."""


class StoreError(FogproofError):
    """The store of a study cannot be read or written; what it holds is kept, and the message says how to go on."""

    code = "store"


class Store:
    """An open store; `opened` makes it."""

    def __init__(self, path: Path, connection: sqlite3.Connection) -> None:
        self.path = path
        self._connection = connection

    def count(self) -> int:
        """Return how many batches are there."""
        with self._told():
            return int(self._connection.execute("select count(*) from batches").fetchone()[0])

    def done(self) -> set[int]:
        """Return the indices of the batches that are there."""
        with self._told():
            return {row[0] for row in self._connection.execute("select id from batches")}

    def add(self, results: Iterable[BatchResult]) -> None:
        """Add batches, all of them or none; one that is there already stays as it is."""
        with self._told(), self._connection:
            rows = [_packed(result) for result in results]
            self._connection.executemany("insert or ignore into batches values (?, ?, ?, ?, ?, ?, ?)", rows)
            self._connection.executemany("delete from failures where id = ?", [(row[0],) for row in rows])

    def fail(self, index: int, attempts: int, error: str) -> None:
        """Note that a batch could not be drawn."""
        with self._told(), self._connection:
            self._connection.execute("insert or replace into failures values (?, ?, ?)", (index, attempts, error))

    def failures(self) -> list[tuple[int, int, str]]:
        """Return (batch, attempts, error) of the batches that could not be drawn."""
        with self._told():
            return list(self._connection.execute("select id, attempts, error from failures order by id"))

    def begin(self, started: str, environment: str) -> None:
        """Note that a session of work begins."""
        with self._told(), self._connection:
            self._connection.execute("insert into sessions values (?, ?)", (started, environment))

    def sessions(self) -> list[tuple[str, str]]:
        """Return (started, environment) of every session of work."""
        with self._told():
            return list(self._connection.execute("select started, environment from sessions"))

    def rows(self) -> Iterator[Row]:
        """Yield all batches by index, as bytes; one whose bits have been changed on the disk raises."""
        with self._told():
            for row in self._connection.execute(f"select {_COLUMNS} from batches order by id"):
                if zlib.crc32(row[2], zlib.crc32(row[1])) != row[6]:
                    raise _damaged(self.path, f"batch {row[0]} is not what was written")
                yield row

    def close(self) -> None:
        """Close the file, and let others work on it."""
        with contextlib.suppress(sqlite3.Error):
            self._connection.close()

    @contextlib.contextmanager
    def _told(self) -> Iterator[None]:
        try:
            yield
        except sqlite3.Error as error:
            raise _explained(self.path, error) from None


@contextlib.contextmanager
def opened(folder: Path, study: Study, salvage: bool = False) -> Iterator[Store]:
    """Open the store in a folder for one study, made if need be.

    salvage  whether a damaged file is put aside and what can be read of it copied
    """
    path = folder / FILE
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise StoreError(f"cannot make the folder {folder}: {error.strerror or error}", str(folder)) from None
    for place in (folder, path):
        if place.exists() and not os.access(place, os.W_OK):
            fix = "make the folder writable, or choose another with -o"
            raise StoreError(f"cannot write {path}: no permission to write {place}; {fix}", str(path))
    store = None
    try:
        try:
            store = _open(path, study)
            for _ in store.rows() if salvage else ():
                pass  # every checksum is looked at
        except _DamagedError:
            if store is not None:
                store.close()
            if not salvage:
                raise
            store = _salvaged(path, study)
        yield store
    finally:
        if store is not None:
            store.close()


class _DamagedError(StoreError):
    """The file was a store and can no longer be read as one."""


def _connect(path: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(path, timeout=0.5, check_same_thread=False)
    connection.execute("pragma locking_mode = exclusive")
    return connection


def _open(path: Path, study: Study) -> Store:
    connection = None
    try:
        connection = _connect(path)
        connection.execute("begin exclusive")
        application = connection.execute("pragma application_id").fetchone()[0]
        version = connection.execute("pragma user_version").fetchone()[0]
        tables = connection.execute("select count(*) from sqlite_master").fetchone()[0]
        if application == 0 and version == 0 and tables == 0:
            connection.execute("commit")
            _create(connection, study)
        else:
            _require_ours(path, application, version)
            _require_whole(path, connection)
            _require_same(path, connection, study)
            connection.execute("commit")
        connection.execute("pragma journal_mode = wal")
        connection.execute("pragma synchronous = normal")
        return Store(path, connection)
    except BaseException as error:
        if connection is not None:
            connection.close()
        if isinstance(error, sqlite3.Error):
            raise _explained(path, error) from None
        raise


def _create(connection: sqlite3.Connection, study: Study) -> None:
    """Write the schema in one transaction, journal and all: a store is there whole or not at all."""
    connection.execute("pragma journal_mode = delete")
    connection.execute("begin exclusive")
    for statement in _TABLES.split(";"):
        connection.execute(statement)
    values = {"fingerprint": study.fingerprint, "text": study.text}
    connection.executemany("insert into study values (?, ?)", values.items())
    connection.execute(f"pragma application_id = {APPLICATION}")
    connection.execute(f"pragma user_version = {VERSION}")
    connection.execute("commit")


def _require_ours(path: Path, application: int, version: int) -> None:
    if application != APPLICATION:
        what = f"{path} is an SQLite file of another program"
        raise StoreError(f"{what}; it was left as it is: choose another folder with -o", str(path))
    if version != VERSION:
        newer = "a newer" if version > VERSION else "an older"
        what = f"{path} has version {version} of the store, this fogproof has version {VERSION}"
        raise StoreError(f"{what}: go on with {newer} fogproof, or choose another folder with -o", str(path))


def _require_whole(path: Path, connection: sqlite3.Connection) -> None:
    pages = connection.execute("pragma page_count").fetchone()[0] * connection.execute("pragma page_size").fetchone()[0]
    log = path.with_name(path.name + "-wal")
    if path.stat().st_size < pages and not (log.exists() and log.stat().st_size):
        raise _damaged(path, "it has been cut short")
    tables = {row[0] for row in connection.execute("select name from sqlite_master where type = 'table'")}
    if not {"study", "batches", "failures", "sessions"} <= tables:
        raise _damaged(path, "tables are missing")
    connection.execute(
        "select count(*) from batches"
    ).fetchone()  # walks through all pages; `rows` looks at what is in them


def _require_same(path: Path, connection: sqlite3.Connection, study: Study) -> None:
    values = dict(connection.execute("select key, value from study"))
    if values.get("fingerprint") == study.fingerprint:
        return
    changes = "\n  ".join(differences(values.get("text", "{}"), study.text)[:20])
    what = f"the study was changed after {path.parent} was started:\n  {changes}\n"
    raise StoreError(f"{what}change it back to go on there, or choose another folder with -o", str(path))


def _damaged(path: Path, reason: str) -> _DamagedError:
    fix = "add --salvage to put it aside and go on with the batches that can still be read"
    return _DamagedError(f"{path} is damaged: {reason}; {fix}", str(path))


def _explained(path: Path, error: sqlite3.Error) -> StoreError:
    """Say what an error of SQLite means for the run."""
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
            return _damaged(path, text)
    return StoreError(f"{path}: {text}; {kept}", str(path))


def _packed(result: BatchResult) -> tuple[object, ...]:
    moments, tail = result.moments.tobytes(), result.tail.tobytes()
    cost = None if np.isnan(result.cost) else result.cost
    return result.index, moments, tail, cost, result.wall, result.cpu, zlib.crc32(tail, zlib.crc32(moments))


def _salvaged(path: Path, study: Study) -> Store:
    """Put a damaged store aside and start a new one with the batches of it that can be read; each proves itself by its sum."""
    aside = next(p for i in range(1, 1000) if not (p := path.with_name(f"{FILE}.damaged-{i}")).exists())
    for suffix in ("", "-wal", "-journal"):
        file = path.with_name(path.name + suffix)
        if file.exists():
            file.rename(aside.with_name(aside.name + suffix))
    old = sqlite3.connect(aside)
    try:
        with contextlib.suppress(sqlite3.Error):
            _require_ours(
                aside, *(old.execute(f"pragma {key}").fetchone()[0] for key in ("application_id", "user_version"))
            )
            _require_same(aside, old, study)
        store = _open(path, study)
        store.add(_readable(old))
    finally:
        old.close()
    return store


def _readable(old: sqlite3.Connection) -> Iterator[BatchResult]:
    """Yield the batches of a damaged file that can be read, from both ends towards the damage."""
    seen: set[int] = set()
    for order in ("asc", "desc"):
        with contextlib.suppress(sqlite3.Error):
            for index, moments, tail, cost, wall, cpu, crc in old.execute(
                f"select {_COLUMNS} from batches order by id {order}"
            ):
                if index in seen:
                    break
                if (
                    isinstance(moments, bytes)
                    and isinstance(tail, bytes)
                    and zlib.crc32(tail, zlib.crc32(moments)) == crc
                ):
                    seen.add(index)
                    table = np.frombuffer(moments).reshape(-1, len(COLUMNS))
                    yield BatchResult(index, table, np.frombuffer(tail), np.nan if cost is None else cost, wall, cpu)
