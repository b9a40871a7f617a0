"""The store of a study: an SQLite file in the run folder that holds every batch drawn so far, whatever happens.

Each batch, or the few batches that arrived together, is one transaction of a write-ahead log. One process at a time works on a
folder: it holds SQLite's own lock, which the system takes back when the process dies. A file that is not such a store, or belongs
to another study or another version, is never touched.

What is in the rows, and how damage to them is found, is told in `stored_batches`.
"""

from __future__ import annotations

import contextlib
import os
import sqlite3
from collections.abc import Iterator
from pathlib import Path

from fogproof.study.cells import cells_of
from fogproof.study.files import Study
from fogproof.study.identity import identity_of
from fogproof.study.plan import batches_of
from fogproof.study.store_faults import (
    APPLICATION,
    FAULTS,
    VERSION,
    DamagedError,
    StoreError,
    damaged,
    explained,
    require_ours,
    require_whole,
)
from fogproof.study.stored_batches import Store

FILE = "study.sqlite"
_HEAD = 100
"""Bytes that the shortest file of SQLite has."""
_TABLES = """
create table study (key text primary key, value text not null, sum integer not null) without rowid;
create table stretches (id integer primary key, identity text not null, replicates integer not null, sum integer not null);
create table batches (id integer primary key, moments blob not null, tail blob not null, cost real, wall real not null,
                      cpu real not null, fixed blob not null, sum integer not null);
create table failures (id integer primary key, attempts integer not null, error text not null, sum integer not null);
create table sessions (id integer primary key, started text not null, environment text not null, sum integer not null);
"""


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
    if path.exists() and not path.is_file():
        raise StoreError(f"{path} is no file; remove it, or choose another folder with -o", str(path))
    store = None
    try:
        try:
            if path.exists() and path.stat().st_size < _HEAD and (folder / "results.json").exists():
                raise damaged(path, f"it has {path.stat().st_size} bytes, though there are results")
            store = _open(path, study)
            for _ in store.rows() if salvage else ():
                pass  # every checksum is looked at
        except DamagedError:
            if store is not None:
                store.close()
            if not salvage:
                raise
            store = None
        if store is None:  # not before what was raised is gone: a cursor in its traceback keeps the damaged file locked
            store = _salvaged(path, study)
        yield store
    finally:
        if store is not None:
            store.close()


def _connect(path: Path) -> sqlite3.Connection:
    connection = sqlite3.connect(path, timeout=0.5, check_same_thread=False)
    connection.execute("pragma locking_mode = exclusive")
    return connection


def _open(path: Path, study: Study) -> Store:
    connection = None
    try:
        connection = _connect(path)
        store = _of(path, connection, study)
        connection.execute("begin exclusive")
        application = connection.execute("pragma application_id").fetchone()[0]
        version = connection.execute("pragma user_version").fetchone()[0]
        tables = connection.execute("select count(*) from sqlite_master").fetchone()[0]
        if application == 0 and version == 0 and tables == 0:
            connection.execute("commit")
            _create(connection, store, study)
        else:
            require_ours(path, application, version)
            require_whole(path, connection)
            store.take_up(study)
            connection.execute("commit")
        connection.execute("pragma journal_mode = wal")
        connection.execute("pragma synchronous = normal")
        return store
    except BaseException as error:
        if connection is not None:
            connection.close()
        if isinstance(error, FAULTS):
            raise explained(path, error) from None
        raise


def _of(path: Path, connection: sqlite3.Connection, study: Study) -> Store:
    cells = cells_of(study)
    batches = batches_of(cells)
    identities = [identity_of(cells[stretch.cell], stretch.size) for stretch in batches.stretches]
    return Store(path, connection, batches, identities)


def _create(connection: sqlite3.Connection, store: Store, study: Study) -> None:
    """Write the schema in one transaction, journal and all: a store is there whole or not at all."""
    connection.execute("pragma journal_mode = delete")
    connection.execute("begin exclusive")
    for statement in _TABLES.split(";"):
        connection.execute(statement)
    store.take_up(study)
    connection.execute(f"pragma application_id = {APPLICATION}")
    connection.execute(f"pragma user_version = {VERSION}")
    connection.execute("commit")


def _salvaged(path: Path, study: Study) -> Store:
    """Put a damaged store aside and start a new one with the batches of it that can be read; each proves itself by its sum."""
    aside = next(p for i in range(1, 1000) if not (p := path.with_name(f"{FILE}.damaged-{i}")).exists())
    for suffix in ("", "-wal", "-journal"):
        file = path.with_name(path.name + suffix)
        if file.exists():
            file.rename(aside.with_name(aside.name + suffix))
    old = sqlite3.connect(aside)
    try:
        store = _open(path, study)
        store.add(store.readable(old))
    finally:
        old.close()
    return store
