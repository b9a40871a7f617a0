"""Change bits, pages and fields of a finished study's store: every change is found, or changes nothing that the record says.

python tools/torture_store.py --bits 500 --pages 50 --fields 10

Fields are those of the tables as they stand in the file, each changed `--fields` times in a row chosen at random: a column that is
new is among them by itself.

For each change: the record is made from the changed file. It must be the undisturbed one to the last digit, times included, or the
store must say that it is damaged; then `salvage` must lead to the undisturbed statistics.
"""

from __future__ import annotations

import argparse
import random
import sqlite3
import struct
import sys
import tempfile
from collections import Counter
from collections.abc import Callable
from contextlib import closing, suppress
from pathlib import Path
from typing import Any

from fogproof.study import StoreError
from fogproof.study.batches import draw_batch
from fogproof.study.cells import cells_of
from fogproof.study.files import Study
from fogproof.study.plan import batches_of
from fogproof.study.record import Circumstances, make_record
from fogproof.study.store import FILE, opened

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "fixtures"))

_RUN = Circumstances("torture", "now", 0.0, "threads", 1)
Change = Callable[[Path, random.Random], str]
"""Changes a store, and says what it changed."""
_TIMED = ("cpu_seconds", "digest", "exit_code", "batches", "sessions", "failures")


def said(study: Study, folder: Path, salvage: bool = False) -> dict[str, Any]:
    """Return what a record says of what is stored, after whatever is missing has been drawn."""
    cells = cells_of(study)
    batches = batches_of(cells)
    with opened(folder, study, salvage) as store:
        done = store.done()
        missing = [batch for batch in batches if batch.number not in done]
        store.add(draw_batch(cells[b.cell], b, float(cells[b.cell].reference.value)) for b in missing)
        record = make_record(study, cells, batches, store, _RUN)
    return {key: record[key] for key in (*_TIMED, "scenes")}


def flip_bit(path: Path, rng: random.Random) -> str:
    """Change one bit anywhere in the file."""
    data = bytearray(path.read_bytes())
    place, bit = rng.randrange(len(data)), rng.randrange(8)
    data[place] ^= 1 << bit
    path.write_bytes(data)
    return f"bit {bit} of byte {place}"


def swap_pages(path: Path, rng: random.Random, size: int = 4096) -> str:
    """Exchange two pages of the file, the first one left alone."""
    data = bytearray(path.read_bytes())
    a, b = rng.sample(range(1, len(data) // size), 2)
    one, two = (slice(i * size, (i + 1) * size) for i in (a, b))
    data[one], data[two] = data[two], data[one]
    path.write_bytes(data)
    return f"pages {a} and {b}"


def fields(path: Path) -> list[tuple[str, str, str]]:
    """Return (table, key, column) of every column of every table."""
    with closing(sqlite3.connect(path)) as connection:
        tables = [name for (name,) in connection.execute("select name from sqlite_master where type = 'table'")]
        columns = {table: connection.execute(f"pragma table_info({table})").fetchall() for table in tables}
    return [(table, rows[0][1], row[1]) for table, rows in columns.items() for row in rows]


def change_field(table: str, key: str, column: str) -> Change:
    """Return the change of one bit of this column, in any row of its table."""

    def change(path: Path, rng: random.Random) -> str:
        with closing(sqlite3.connect(path)) as connection, connection:
            while True:
                which, old = rng.choice(connection.execute(f"select {key}, {column} from {table}").fetchall())
                with suppress(sqlite3.IntegrityError):  # another row has this key
                    connection.execute(f"update {table} set {column} = ? where {key} = ?", (changed(old, rng), which))
                    return f"{column} of {table} {which}"

    return change


def changed(value: Any, rng: random.Random) -> Any:
    """Return a value with one bit changed, of the same type where there was a value."""
    match value:
        case None:
            return 0.0
        case "" | b"":  # no bit to change: one more letter
            return " " if value == "" else b" "
        case int():
            return struct.unpack("<q", changed(struct.pack("<q", value), rng))[0]
        case float():
            return struct.unpack("<d", changed(struct.pack("<d", value), rng))[0]
        case str():
            place = rng.randrange(len(value))
            return value[:place] + chr(ord(value[place]) ^ 1) + value[place + 1 :]
    data = bytearray(value)
    data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return bytes(data)


def outcome(
    study: Study, whole: Path, undisturbed: dict[str, Any], change: Change, rng: random.Random
) -> tuple[str, str]:
    """Return what became of one change ("found", "harmless" or a fault in capitals), and which change it was."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name) / "run"
        folder.mkdir()
        (folder / FILE).write_bytes((whole / FILE).read_bytes())
        what = change(folder / FILE, rng)
        try:
            return ("harmless" if said(study, folder) == undisturbed else "WRONG RECORD"), what
        except StoreError as error:
            if "--salvage" not in str(error):
                return "found, not ours any more", f"{what}: {error}"
        try:
            again = said(study, folder, salvage=True)
        except StoreError as error:
            return "SALVAGE REFUSED", f"{what}: {error}"
        return ("found" if again["digest"] == undisturbed["digest"] else "SALVAGED TO SOMETHING ELSE"), what


def torture(study: Study, bits: int, pages: int, times: int, seed: int) -> Counter[str]:
    """Return how often each outcome came; faults are printed.

    times  that each column is changed
    """
    rng, counts = random.Random(seed), Counter[str]()
    with tempfile.TemporaryDirectory() as name:
        whole = Path(name)
        said(study, whole)
        with opened(whole, study) as store:  # a row in every table
            store.begin("now", "{}")
            store.fail(0, 3, "it broke")
        undisturbed = said(study, whole)
        of_fields = [change_field(*field) for field in fields(whole / FILE)] * times
        for change in [flip_bit] * bits + [swap_pages] * pages + of_fields:
            came, what = outcome(study, whole, undisturbed, change, rng)
            counts[came] += 1
            if came.isupper():
                print(f"{came}: {what}", file=sys.stderr)
    return counts


def main() -> None:
    """Print how often each outcome came."""
    from study_fixtures import SMALL, study_from

    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--bits", type=int, default=500)
    parser.add_argument("--pages", type=int, default=50)
    parser.add_argument("--fields", type=int, default=10)
    parser.add_argument("--seed", type=int, default=random.SystemRandom().randrange(2**31))
    arguments = parser.parse_args()
    study = study_from({**SMALL, "scenes": SMALL["scenes"][:1]})
    counts = torture(study, arguments.bits, arguments.pages, arguments.fields, arguments.seed)
    print(f"seed {arguments.seed}: " + ", ".join(f"{n} {came}" for came, n in counts.items()))
    raise SystemExit(any(came.isupper() for came in counts))


if __name__ == "__main__":
    main()
