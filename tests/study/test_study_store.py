"""What has been stored survives: a file that is not ours is never touched, one that is damaged is never trusted, and every fault
of disk or user ends in a sentence from which the study can go on."""

import os
import random
import resource
import shutil
import sqlite3
import subprocess
import sys
import tempfile
from pathlib import Path

import pytest
from study_fixtures import SMALL, drawn, study_from, toml
from torture_store import torture

from fogproof.checks.limits import within
from fogproof.study import StoreError
from fogproof.study.batches import run_batch
from fogproof.study.cells import cells_of
from fogproof.study.plan import batches_of
from fogproof.study.run import draw_missing
from fogproof.study.store import FILE, opened
from fogproof.workers.executors import open_workers

STUDY = study_from({**SMALL, "scenes": SMALL["scenes"][:1]})


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    """The folder of a finished run, and what it sums up to."""
    folder = tmp_path_factory.mktemp("whole")
    return folder, drawn(STUDY, folder)["digest"]


@pytest.fixture
def undisturbed(whole):
    return whole[1]


@pytest.fixture
def finished(whole):
    """Put a finished run into a folder."""
    return lambda folder: shutil.copytree(whole[0], folder, dirs_exist_ok=True)


def tampered(path, *statements):
    connection = sqlite3.connect(path)
    for statement in statements:
        connection.execute(statement)
    connection.commit()
    connection.close()


FOREIGN = {
    "another program's": ["create table mine (x)", "insert into mine values (1)"],
    "another program's, signed": ["pragma application_id = 77", "create table mine (x)"],
    "empty but versioned": ["pragma user_version = 3"],
}


@pytest.mark.parametrize("statements", FOREIGN.values(), ids=FOREIGN)
def test_a_foreign_database_is_left_alone(tmp_path, statements):
    tampered(tmp_path / FILE, *statements)
    before = (tmp_path / FILE).read_bytes()
    with pytest.raises(StoreError, match="another program; it was left as it is"), opened(tmp_path, STUDY):
        pass
    assert (tmp_path / FILE).read_bytes() == before


def test_what_is_no_database_is_left_alone(tmp_path):
    (tmp_path / FILE).write_text("dear diary, " * 400)
    with pytest.raises(StoreError, match="is not an SQLite file; it was left as it is"), opened(tmp_path, STUDY):
        pass
    assert (tmp_path / FILE).read_text().startswith("dear diary")


@pytest.mark.parametrize(("version", "word"), [(99, "a newer fogproof"), (0, "an older fogproof")])
def test_another_version_is_refused(tmp_path, version, word, finished):
    finished(tmp_path)
    tampered(tmp_path / FILE, f"pragma user_version = {version}")
    with pytest.raises(StoreError, match=f"has version {version} of the store.*{word}"), opened(tmp_path, STUDY):
        pass


def test_a_changed_study_is_refused_with_the_difference(tmp_path, finished):
    finished(tmp_path)
    other = study_from({**SMALL, "scenes": SMALL["scenes"][:1], "samples": [64, 512, 8192]})
    with pytest.raises(StoreError, match=r"samples: \[64, 512, 4096\] has become \[64, 512, 8192\]"):
        drawn(other, tmp_path)


def test_an_empty_file_is_a_beginning(tmp_path, undisturbed):
    (tmp_path / FILE).touch()
    assert drawn(STUDY, tmp_path)["digest"] == undisturbed


def cut_short(path):
    data = path.read_bytes()
    path.write_bytes(data[: len(data) * 2 // 3 // 4096 * 4096])


def torn(path):
    data = bytearray(path.read_bytes())
    data[4096 * 8 : 4096 * 9] = bytes(4096)
    path.write_bytes(bytes(data))


def changed_bits(path):
    connection = sqlite3.connect(path)
    key, blob = connection.execute("select id, moments from batches limit 1").fetchone()
    blob = blob[:20] + bytes([blob[20] ^ 1]) + blob[21:]
    connection.execute("update batches set moments = ? where id = ?", (blob, key))
    connection.commit()
    connection.close()


def without_tables(path):
    tampered(path, "drop table failures")


@pytest.mark.parametrize("damage", [cut_short, torn, changed_bits, without_tables], ids=lambda f: f.__name__)
def test_a_damaged_store_is_put_aside_and_salvaged(tmp_path, undisturbed, damage, finished):
    finished(tmp_path)
    damage(tmp_path / FILE)
    with pytest.raises(StoreError, match=r"(?s)is damaged.*--salvage"):
        drawn(STUDY, tmp_path)
    with opened(tmp_path, STUDY, salvage=True) as store:
        kept = len(store.done())
    assert kept < len(batches_of(cells_of(STUDY))) or damage is without_tables
    assert (tmp_path / f"{FILE}.damaged-1").exists()
    assert drawn(STUDY, tmp_path)["digest"] == undisturbed


@pytest.mark.parametrize("word", [b"batches", b"stretches", b"sessions", b"CREATE", b"TABLE"])
def test_a_schema_whose_words_are_no_text_is_damage(tmp_path, word, finished):
    """SQLite's own error quotes them then, and cannot be read either. Batches whose table has its name are all taken over."""
    finished(tmp_path)
    path = tmp_path / FILE
    data = path.read_bytes()
    assert word in data
    path.write_bytes(data.replace(word, word[:2] + bytes([0xF4]) + word[3:]))
    with pytest.raises(StoreError, match=r"(?s)is damaged.*--salvage"), opened(tmp_path, STUDY):
        pass
    with opened(tmp_path, STUDY, salvage=True) as store:
        every = len(batches_of(cells_of(STUDY)))
        assert len(store.done()) == (every if word in (b"stretches", b"sessions") else 0)


def test_salvaging_finds_most_of_a_torn_file(tmp_path, finished):
    finished(tmp_path)
    torn(tmp_path / FILE)
    with opened(tmp_path, STUDY, salvage=True) as store:
        assert len(store.done()) > 0


def test_salvaging_does_not_take_what_belongs_to_another_study(tmp_path, finished):
    finished(tmp_path)
    changed_bits(tmp_path / FILE)
    other = study_from({**SMALL, "scenes": SMALL["scenes"][:1], "seed": 9})
    with pytest.raises(StoreError, match="the study was changed"), opened(tmp_path, other, salvage=True):
        pass
    assert (tmp_path / FILE).exists()


def test_one_process_at_a_time(tmp_path):
    with (
        opened(tmp_path, STUDY),
        pytest.raises(StoreError, match="another process is working in"),
        opened(tmp_path, STUDY),
    ):
        pass
    with opened(tmp_path, STUDY) as store:
        assert store.done() == set()


def test_a_full_disk_keeps_what_is_there(tmp_path, undisturbed):
    cells, batches = cells_of(STUDY), batches_of(cells_of(STUDY))
    with opened(tmp_path, STUDY) as store, open_workers("threads", 1) as pool:
        store._connection.execute("pragma max_page_count = 12")
        with pytest.raises(StoreError, match=r"no room left .* is kept; make room and give the same command again"):
            draw_missing(STUDY, cells, batches, store, pool)
    with opened(tmp_path, STUDY) as store:
        assert 0 < len(store.done()) < len(batches)
    assert drawn(STUDY, tmp_path)["digest"] == undisturbed


def test_a_file_that_may_not_grow_ends_in_a_sentence(tmp_path):
    (tmp_path / "study.toml").write_text(toml(SMALL))
    out = subprocess.run(
        [sys.executable, "-c", "from fogproof_command import main; main()", "study", str(tmp_path / "study.toml"),
         "-o", str(tmp_path / "run")],
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (60_000, 60_000)),
        capture_output=True, text=True, timeout=1800,
    )  # fmt: skip
    assert out.returncode == 2, out.stderr
    assert out.stderr.startswith("fogproof: ")
    assert "is kept" in out.stderr
    assert "Traceback" not in out.stderr


@pytest.mark.parametrize("started", [False, True], ids=["new", "started"])
def test_a_read_only_folder_is_told(started):
    folder = Path(tempfile.mkdtemp())
    try:
        if started:
            drawn(STUDY, folder)
            (folder / FILE).chmod(0o444)
        folder.chmod(0o555)

        def opens():
            if os.getuid() == 0:
                os.setuid(65534)  # root may write anywhere
            try:
                with opened(folder, STUDY):
                    return "opened"
            except StoreError as error:
                return str(error)

        said = within(1800, opens)
        assert "no permission to write" in said
        assert "make the folder writable, or choose another with -o" in said
    finally:
        folder.chmod(0o755)
        shutil.rmtree(folder)


def test_a_folder_that_cannot_be_made_is_told(tmp_path):
    (tmp_path / "file").touch()
    with pytest.raises(StoreError, match="cannot make the folder"), opened(tmp_path / "file" / "run", STUDY):
        pass


def test_changed_bits_and_swapped_pages_are_found_or_harmless():
    counts = torture(STUDY, bits=6, pages=2, times=1, seed=random.SystemRandom().randrange(2**31))
    assert sum(counts.values()) >= 8 + 5 * 3  # every table has a key, a value and a sum at least
    assert not [came for came in counts if came.isupper()]
    assert counts["found"] > 0


BIGGER = {
    "samples": {**SMALL, "samples": [64, 512, 2048, 4096], "scenes": SMALL["scenes"][:1]},
    "replicates": {**SMALL, "replicates": 13, "scenes": SMALL["scenes"][:1]},
    "scenes": {**SMALL, "scenes": SMALL["scenes"][:2]},
    "words": {**SMALL, "title": "another", "scenes": [{**SMALL["scenes"][0], "question": "Which?"}]},
}


@pytest.mark.parametrize("table", BIGGER.values(), ids=BIGGER)
def test_a_study_that_asks_for_more_keeps_what_it_has(tmp_path, table, finished):
    finished(tmp_path / "run")
    bigger, numbers = study_from(table), []

    def counted(text, folder, batch, reference):
        numbers.append(batch.number)
        return run_batch(text, folder, batch, reference)

    extended = drawn(bigger, tmp_path / "run", draw=counted)
    assert extended["digest"] == drawn(bigger, tmp_path / "afresh")["digest"]
    kept, all_of_it = len(batches_of(cells_of(STUDY))), len(batches_of(cells_of(bigger)))
    partial = len(batches_of(cells_of(STUDY)).stretches) if table is BIGGER["replicates"] else 0
    assert all_of_it - kept <= len(numbers) <= all_of_it - kept + partial


def test_a_study_that_asks_for_less_is_refused(tmp_path):
    drawn(study_from(BIGGER["replicates"]), tmp_path)
    with pytest.raises(StoreError, match=r"replicates: 13 has become 8"):
        drawn(STUDY, tmp_path)


def test_a_batch_of_something_else_is_found_under_the_right_key(tmp_path, finished):
    finished(tmp_path / "one")
    other = study_from({**SMALL, "scenes": SMALL["scenes"][:1], "seed": 9})
    drawn(other, tmp_path / "two")
    connection = sqlite3.connect(tmp_path / "one" / FILE)
    connection.execute("attach ? as two", (str(tmp_path / "two" / FILE),))
    connection.execute("replace into batches select * from two.batches where id = (select max(id) from two.batches)")
    connection.commit()
    connection.close()
    with pytest.raises(StoreError, match="is not what was written"):
        drawn(STUDY, tmp_path / "one")


def test_a_batch_that_nobody_asked_for_is_damage(tmp_path, finished):
    finished(tmp_path)
    tampered(tmp_path / FILE, "update batches set id = 77 * (1 << 40) where id = (select max(id) from batches)")
    with pytest.raises(StoreError, match="no study asked for"):
        drawn(STUDY, tmp_path)


def test_a_batch_that_is_gone_is_drawn_again(tmp_path, undisturbed, finished):
    finished(tmp_path)
    tampered(tmp_path / FILE, "delete from batches where id = (select max(id) from batches)")
    assert drawn(STUDY, tmp_path)["digest"] == undisturbed


@pytest.mark.parametrize(
    "how", [os.unlink, lambda path: path.rename(path.with_name("elsewhere"))], ids=["gone", "moved"]
)
def test_a_store_that_loses_its_name_is_told(tmp_path, how):
    with opened(tmp_path, STUDY) as store:
        store.require_there()
        how(tmp_path / FILE)
        with pytest.raises(StoreError, match="moved or removed while the study ran"):
            store.add([])


@pytest.mark.parametrize("size", [0, 1, 99])
def test_a_store_cut_to_nothing_beside_results_is_damage(tmp_path, size):
    (tmp_path / FILE).touch()  # as a process leaves it that was killed while it made the store
    with opened(tmp_path, STUDY):
        pass
    os.truncate(tmp_path / FILE, size)
    (tmp_path / "results.json").write_text("{}")
    words = f"is damaged: it has {size} bytes, though there are results; add --salvage"
    with pytest.raises(StoreError, match=words), opened(tmp_path, STUDY):
        pass
    with opened(tmp_path, STUDY, salvage=True) as store:
        assert store.done() == set()


def test_a_store_that_is_no_file_is_told(tmp_path):
    (tmp_path / FILE).symlink_to(os.devnull)
    with pytest.raises(StoreError, match=r"sqlite is no file; remove it"), opened(tmp_path, STUDY):
        pass


def test_what_would_undo_a_store_is_damage(tmp_path):
    with opened(tmp_path, STUDY):
        pass
    tampered(tmp_path / FILE, "create trigger t before insert on batches begin select raise(ignore); end")
    with pytest.raises(StoreError, match="it holds triggers or views"), opened(tmp_path, STUDY):
        pass
