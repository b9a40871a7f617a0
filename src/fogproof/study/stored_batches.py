"""The batches of a study as they stand in its store.

Every row carries a checksum of all that it says, its key included, and of what it is a batch of (`identity`): a changed bit, a row
in another's place and a page of another file are all found when the rows are read. A study that asks for more than it did goes on
with what is there: a batch is known by what it is, not by its number in the study.
"""

from __future__ import annotations

import contextlib
import hashlib
import sqlite3
import struct
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np

from fogproof.study.batches import COLUMNS, BatchResult
from fogproof.study.files import Study
from fogproof.study.plan import Batches, BatchStretch
from fogproof.study.store_faults import FAULTS, changed, damaged, explained, gone

_COLUMNS = "id, moments, tail, cost, wall, cpu, fixed, sum"
_ROOM = 1 << 40
"""Keys a stretch has: a batch's key is the stretch's times this, plus the batch's place in the stretch."""
Row = tuple[int, bytes, bytes, float | None, float, float, bytes]
"""A batch as it is read: its number in the study, and see `BatchResult`."""


class Store:
    """An open store; `opened` makes it."""

    def __init__(self, path: Path, connection: sqlite3.Connection, batches: Batches, identities: list[str]) -> None:
        self.path = path
        self._connection = connection
        self._batches = batches
        self._identities = identities
        self._keys: list[int] = []
        self._file = _of(path)

    def done(self) -> set[int]:
        """Return the numbers of the batches that are there."""
        with self._faults_in_words():
            found: set[int] = set()
            for key, stretch in zip(self._keys, self._batches.stretches, strict=True):
                rows = self._connection.execute("select id from batches where id >= ? and id < ?", (key, key + _ROOM))
                found.update(stretch.begin + row[0] - key for row in rows)
            return found

    def add(self, results: Iterable[BatchResult]) -> None:
        """Add batches, all of them or none; one that is there already stays as it is."""
        with self._faults_in_words(), self._connection:
            rows = [self._packed(result) for result in results]
            self._connection.executemany("insert or ignore into batches values (?, ?, ?, ?, ?, ?, ?, ?)", rows)
            self._connection.executemany("delete from failures where id = ?", [(row[0],) for row in rows])
        self.require_there()

    def require_there(self) -> None:
        """Raise if the file has lost its name: what is written goes into it all the same, and nobody would find it."""
        if _of(self.path) != self._file:
            raise gone(self.path)

    def fail(self, number: int, attempts: int, error: str) -> None:
        """Note that a batch could not be drawn."""
        error = error.encode("utf-8", "backslashreplace").decode()
        row = (self._key(number)[0], attempts, error)
        with self._faults_in_words(), self._connection:
            self._connection.execute("insert or replace into failures values (?, ?, ?, ?)", (*row, _sum(*row)))

    def failures(self) -> list[tuple[int, int, str]]:
        """Return (batch, attempts, error) of the batches that could not be drawn."""
        with self._faults_in_words():
            rows = self._checked("failures", "select id, attempts, error, sum from failures")
            return sorted((self._number(key), attempts, error) for key, attempts, error in rows)

    def begin(self, started: str, environment: str) -> None:
        """Note that a session of work begins."""
        with self._faults_in_words(), self._connection:
            number = self._connection.execute("select coalesce(max(id), 0) + 1 from sessions").fetchone()[0]
            row = (number, started, environment)
            self._connection.execute("insert into sessions values (?, ?, ?, ?)", (*row, _sum(*row)))

    def sessions(self) -> list[tuple[str, str]]:
        """Return (started, environment) of every session of work."""
        with self._faults_in_words():
            rows = self._checked("sessions", "select id, started, environment, sum from sessions order by id")
            return [(started, environment) for _, started, environment in rows]

    def rows(self) -> Iterator[Row]:
        """Yield all batches by number, as bytes; one that is not what was written raises."""
        with self._faults_in_words():
            for key, stretch, identity in zip(self._keys, self._batches.stretches, self._identities, strict=True):
                query = f"select {_COLUMNS} from batches where id >= ? and id < ? order by id"
                # A cursor that is left open keeps the file locked, even when its connection has been closed.
                with contextlib.closing(self._connection.execute(query, (key, key + _ROOM))) as found:
                    last = key - 1
                    for row in found:
                        if row[0] <= last or not _whole(row, identity):
                            raise damaged(self.path, f"batch {stretch.begin + row[0] - key} is not what was written")
                        last = row[0]
                        yield stretch.begin + row[0] - key, *row[1:7]

    def close(self) -> None:
        """Close the file, and let others work on it."""
        with contextlib.suppress(*FAULTS):
            self._connection.close()

    def take_up(self, study: Study) -> None:
        """Make this the store of a study, which may be new, or ask for more than what the file was made for."""
        with self._faults_in_words():
            known = self._known()
            lost = set(known) - set(self._identities)
            wanted = dict(zip(self._identities, self._batches.stretches, strict=True))
            fewer = any(wanted[identity].replicates < known[identity][1] for identity in set(known) - lost)
            text = self._text()
            if lost or fewer:
                raise changed(self.path, text, study.text)
            new = max((key for key, _ in known.values()), default=-1) + 1
            for identity, stretch in wanted.items():
                number, replicates = known.get(identity, (new, stretch.replicates))
                new += identity not in known
                if identity in known and replicates < stretch.replicates:
                    self._drop_partial(number, stretch, replicates)
                if known.get(identity) != (number, stretch.replicates):
                    row = (number, identity, stretch.replicates)
                    self._connection.execute("insert or replace into stretches values (?, ?, ?, ?)", (*row, _sum(*row)))
                self._keys.append(number * _ROOM)
            if text != study.text:
                said = ("text", study.text)
                self._connection.execute("insert or replace into study values (?, ?, ?)", (*said, _sum(*said)))
            self._require_planned()
        self.failures(), self.sessions()  # a damaged one is found before anything is drawn

    def readable(self, old: sqlite3.Connection) -> Iterator[BatchResult]:
        """Yield the batches of a damaged file that can be read, from both ends towards the damage.

        Which stretch a key belongs to is asked of the file where it can tell, and taken from the plan where it cannot: a batch
        of anything else has another sum.
        """
        places = {identity: place for place, identity in enumerate(self._identities)}
        places_of = dict(enumerate(range(len(places))))
        with contextlib.suppress(*FAULTS):
            for *row, stored in old.execute("select id, identity, replicates, sum from stretches"):
                if _sum(*row) == stored and row[1] in places:
                    places_of[row[0]] = places[row[1]]
        seen: set[int] = set()
        for order in ("asc", "desc"):
            with contextlib.suppress(*FAULTS):
                for row in old.execute(f"select {_COLUMNS} from batches order by id {order}"):
                    if row[0] in seen:
                        break  # the damage has been met from the other side, or leads in a circle
                    seen.add(row[0])
                    place = places_of.get(row[0] // _ROOM)
                    if place is None:
                        continue
                    stretch, at = self._batches.stretches[place], row[0] % _ROOM
                    if at < len(stretch) and _whole(row, self._identities[place]):
                        moments = np.frombuffer(row[1]).reshape(-1, len(COLUMNS))
                        cost = np.nan if row[3] is None else row[3]
                        tail, fixed = np.frombuffer(row[2]), np.frombuffer(row[6])
                        yield BatchResult(stretch.begin + at, moments, tail, cost, row[4], row[5], fixed)

    def _known(self) -> dict[str, tuple[int, int]]:
        """Return (number, replicates) of the stretches that the file was made for, by identity."""
        rows = list(self._checked("stretches", "select id, identity, replicates, sum from stretches"))
        return {identity: (number, replicates) for number, identity, replicates in rows}

    def _text(self) -> str:
        texts = [value for _, value in self._checked("study", "select key, value, sum from study where key = 'text'")]
        if not texts and self._connection.execute("select count(*) from stretches").fetchone()[0]:
            raise damaged(self.path, "the text of the study is gone")
        return texts[0] if texts else "{}"

    def _drop_partial(self, number: int, stretch: BatchStretch, replicates: int) -> None:
        """Drop the last batch of a stretch that has grown, where it holds fewer replicates than it now has to."""
        if stretch.parts == 1 and replicates % stretch.together:
            key = number * _ROOM + replicates // stretch.together
            for table in ("batches", "failures"):
                self._connection.execute(f"delete from {table} where id = ?", (key,))

    def _require_planned(self) -> None:
        """Every batch must be one of the plan: a key that is none was written by nobody."""
        for table in ("batches", "failures"):
            count = self._connection.execute(f"select count(*) from {table} not indexed").fetchone()[0]
            for key, stretch in zip(self._keys, self._batches.stretches, strict=True):
                within = f"select count(*) from {table} where id >= ? and id < ?"
                count -= self._connection.execute(within, (key, key + len(stretch))).fetchone()[0]
            if count:
                raise damaged(self.path, f"{table} that no study asked for are in it")

    def _checked(self, what: str, query: str) -> Iterator[tuple[Any, ...]]:
        for *row, stored in self._connection.execute(query).fetchall():
            if _sum(*row) != stored:
                raise damaged(self.path, f"its table of {what} is not what was written")
            yield tuple(row)

    def _key(self, number: int) -> tuple[int, str]:
        place = self._batches.stretch(number)
        return self._keys[place] + number - self._batches.stretches[place].begin, self._identities[place]

    def _number(self, key: int) -> int:
        place = self._keys.index(key // _ROOM * _ROOM)
        return self._batches.stretches[place].begin + key % _ROOM

    def _packed(self, result: BatchResult) -> tuple[object, ...]:
        key, identity = self._key(result.index)
        cost = None if np.isnan(result.cost) else float(result.cost)
        times = (float(result.wall), float(result.cpu), result.fixed.tobytes())
        row = (key, result.moments.tobytes(), result.tail.tobytes(), cost, *times)
        return *row, _sum(identity, *row)

    @contextlib.contextmanager
    def _faults_in_words(self) -> Iterator[None]:
        try:
            yield
        except FAULTS as error:
            raise explained(self.path, error) from None


def _sum(*fields: str | bytes | int | float | None) -> int:
    """Return a checksum of some fields, their types and lengths: 64 bits, as SQLite's integers."""
    words = hashlib.blake2b(digest_size=8)
    for field in fields:
        if isinstance(field, float):
            field = struct.pack("<d", field)
        data = field if isinstance(field, bytes) else repr(field).encode("utf-8", "surrogatepass")
        words.update(f"{type(field).__name__} {len(data)}:".encode())
        words.update(data)
    return int.from_bytes(words.digest(), "little", signed=True)


def _of(path: Path) -> tuple[int, int] | None:
    """Return what a path leads to, None if to nothing."""
    with contextlib.suppress(OSError):
        found = path.stat()
        return found.st_dev, found.st_ino
    return None


def _whole(row: tuple[Any, ...], identity: str) -> bool:
    """Return whether a stored batch is what was written, and a batch of what has this identity."""
    return bool(_sum(identity, *row[:-1]) == row[-1])
