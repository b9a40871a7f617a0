"""The statistics of a study are the same bits whoever draws it, in whatever order, and however often it is killed."""

import os
import random
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from study_fixtures import HOW, LIT, SMALL, drawn, estimator, kinds, study_from, toml

from fogproof.study import aggregate, read_study, run_study
from fogproof.study.batches import run_batch
from fogproof.study.cells import cells_of
from fogproof.study.plan import batches_of
from fogproof.study.record import make_record
from fogproof.study.run import ATTEMPTS, draw_missing
from fogproof.study.store import FILE, opened
from fogproof.workers.executors import open_workers

STUDY = study_from(SMALL)
COMMAND = [sys.executable, "-c", "from fogproof.cli import main; main()", "study"]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    return drawn(STUDY, tmp_path_factory.mktemp("whole"), workers=1)["digest"]


def test_threads_give_the_same_bits(tmp_path, undisturbed):
    assert drawn(STUDY, tmp_path, workers=5)["digest"] == undisturbed


def test_the_order_of_batches_does_not_matter(tmp_path, undisturbed):
    cells, batches = cells_of(STUDY), batches_of(cells_of(STUDY))
    shuffled = random.sample(batches, len(batches))
    with opened(tmp_path, STUDY) as store:
        with open_workers("threads", 2) as pool:
            draw_missing(STUDY, cells, shuffled, store, pool)
        assert make_record(STUDY, cells, batches, store, HOW)["digest"] == undisturbed


def test_processes_give_the_same_bits_and_survive_a_death(tmp_path, undisturbed):
    """One batch kills the worker that draws it, the first time; another one always does."""
    once, always = 20, 33
    study, cells, batches = STUDY, cells_of(STUDY), batches_of(cells_of(STUDY))
    with opened(tmp_path / "run", study) as store, open_workers("processes", 1) as pool:
        told = []
        draw_missing(
            study, cells, batches, store, pool, lambda batch, result: told.append((batch.number, result is None)),
            _deadly(once, always, tmp_path),
        )  # fmt: skip
        assert (always, True) in told
        assert [f[:2] for f in store.failures()] == [(always, ATTEMPTS)]
        assert "died" in store.failures()[0][2]
        record = make_record(study, cells, batches, store, HOW)
        assert record["exit_code"] == 1
        assert record["batches"] == {"planned": len(batches), "done": len(batches) - 1, "failed": 1}
        victim = cells[batches[always].cell]
        e = next(
            e
            for s in record["scenes"]
            for e in s["estimators"]
            if s["name"] == victim.scene.name and e["name"] == victim.name
        )
        assert e["outcome"] == "inconclusive"
        draw_missing(study, cells, batches, store, pool)  # the next run tries it again
        assert store.failures() == []
        assert make_record(study, cells, batches, store, HOW)["digest"] == undisturbed


class _deadly:  # noqa: N801 - a function that can be pickled
    def __init__(self, once, always, folder):
        self.once, self.always, self.marker = once, always, str(folder / "dead")

    def __call__(self, text, folder, batch, reference):
        if batch.number == self.always or (batch.number == self.once and not os.path.exists(self.marker)):
            open(self.marker, "w").close()
            os.kill(os.getpid(), signal.SIGKILL)
        return run_batch(text, folder, batch, reference)


def test_a_poisoned_batch_costs_no_other(tmp_path, undisturbed):
    def poisoned(text, folder, batch, reference):
        if batch.number == 7:
            raise RuntimeError("no good")
        return run_batch(text, folder, batch, reference)

    record = drawn(STUDY, tmp_path, draw=poisoned)
    assert [(f["batch"], f["attempts"], f["error"]) for f in record["failures"]] == [
        (7, ATTEMPTS, "RuntimeError: no good")
    ]
    assert record["batches"]["done"] == record["batches"]["planned"] - 1
    assert drawn(STUDY, tmp_path)["digest"] == undisturbed


def test_a_worker_that_fails_once_is_asked_again(tmp_path, undisturbed):
    failed = set()

    def moody(text, folder, batch, reference):
        if batch.number % 5 == 0 and batch.number not in failed:
            failed.add(batch.number)
            raise OSError("not now")
        return run_batch(text, folder, batch, reference)

    record = drawn(STUDY, tmp_path, draw=moody)
    assert len(failed) > 10
    assert record["failures"] == []
    assert record["digest"] == undisturbed


def interrupted_after(n):
    """Return what raises KeyboardInterrupt when n batches have been told of."""
    told = []

    def advance(batch, result):
        told.append(batch.number)
        if len(told) == n:
            raise KeyboardInterrupt

    return advance


def test_an_interrupt_keeps_what_is_under_way(tmp_path, undisturbed):
    cells, batches = cells_of(STUDY), batches_of(cells_of(STUDY))
    done = 0
    for n in (1, 17, 60):
        with opened(tmp_path, STUDY) as store, open_workers("threads", 2) as pool:
            with pytest.raises(KeyboardInterrupt):
                draw_missing(STUDY, cells, batches, store, pool, interrupted_after(n))
            assert len(store.done()) >= done + n
            done = len(store.done())
    assert done < len(batches)
    assert drawn(STUDY, tmp_path)["digest"] == undisturbed


def test_a_batch_under_way_at_an_interrupt_is_kept(tmp_path):
    """The first one waits for the interrupt, which comes when another is done: it is finished then, and stored."""
    cells, batches = cells_of(STUDY), batches_of(cells_of(STUDY))
    stopping, slow = threading.Event(), []

    def draw(text, folder, batch, reference):
        if not slow:
            slow.append(batch.number)
            assert stopping.wait(60)
        return run_batch(text, folder, batch, reference)

    def advance(*_):
        stopping.set()
        raise KeyboardInterrupt

    with opened(tmp_path, STUDY) as store, open_workers("threads", 2) as pool:
        with pytest.raises(KeyboardInterrupt):
            draw_missing(STUDY, cells, batches, store, pool, advance, draw=draw)
        assert slow[0] in store.done()


KILLER = """
import os, signal, sys
from fogproof.study import aggregate, read_study, run_study
from fogproof.study.stored_batches import Store
left = [int(sys.argv[3])]
add = Store.add
def deadly(self, results):
    results = list(results)
    def dying():
        for result in results:
            left[0] -= 1
            if left[0] == 0:
                os.kill(os.getpid(), signal.SIGKILL)  # in the middle of a transaction
            yield result
    add(self, dying())
Store.add = deadly
run_study(read_study(sys.argv[1]), sys.argv[2])
"""


def test_killed_in_the_middle_of_a_transaction(tmp_path, undisturbed):
    """No batch that was stored before is lost, and the end is the same."""
    file, run = tmp_path / "study.toml", tmp_path / "run"
    file.write_text(toml(SMALL))
    study = read_study(file)
    kept = 0
    for _ in range(3):
        moment = random.randint(3, 40)
        print("killed at batch", moment)
        out = subprocess.run([sys.executable, "-c", KILLER, str(file), str(run), str(moment)], timeout=1800)
        assert out.returncode == -signal.SIGKILL
        with opened(run, study) as store:
            now = len(store.done())
        # Batches arrive in handfuls, one transaction each: at most the last handful is lost.
        assert kept <= now <= kept + moment
        kept = now
    assert kept > 0
    assert run_study(study, run)["digest"] == undisturbed


LONG = {**SMALL, "samples": [1000, 10_000_000], "scenes": [{**LIT, "estimators": kinds("airlight")}], "batch": 10_000}


def test_ctrl_c_ends_cleanly_and_says_how_to_go_on(tmp_path):
    file, run = tmp_path / "study.toml", tmp_path / "run"
    file.write_text(toml(LONG))
    process = subprocess.Popen(
        [*COMMAND, str(file), "-o", str(run)],
        stderr=subprocess.PIPE,
        text=True,
        preexec_fn=lambda: signal.signal(signal.SIGINT, signal.SIG_DFL),
    )
    log = run / f"{FILE}-wal"
    while process.poll() is None and not (log.exists() and log.stat().st_size > 200_000):
        time.sleep(0.02)
    process.send_signal(signal.SIGINT)
    _, said = process.communicate(timeout=1800)
    assert process.returncode == 130, said
    stopped, page = said.splitlines()
    assert "what was drawn is kept, go on with: fogproof study" in stopped
    assert page.startswith("page: ")
    with opened(run, read_study(file)) as store:
        assert len(store.done()) > 20
        assert not list(store.failures())


def test_a_finished_study_only_counts(tmp_path, undisturbed):
    drawn(STUDY, tmp_path)

    def never(*_):
        raise AssertionError("nothing is missing")

    assert drawn(STUDY, tmp_path, draw=never)["digest"] == undisturbed


def test_batches_are_drawn_again_alike():
    cells = cells_of(STUDY)
    for batch in list(batches_of(cells))[::9]:
        reference = float(cells[batch.cell].reference.value)
        one, two = (run_batch(STUDY.text, STUDY.folder, batch, reference) for _ in range(2))
        assert np.array_equal(one.moments, two.moments)
        assert np.array_equal(one.tail, two.tail)


def test_the_largest_deviations_are_all_there_down_to_the_least_that_is_kept(tmp_path, monkeypatch):
    """A batch keeps its largest only: below the smallest of those, some of another batch's may be missing."""
    monkeypatch.setattr(aggregate, "_AT_ONCE", 2)  # batches that are read together, 10 000 elsewhere
    drawn(STUDY, tmp_path)
    cells, batches = cells_of(STUDY), batches_of(cells_of(STUDY))
    with opened(tmp_path, STUDY) as store:
        rows = list(store.rows())
        levels = aggregate.levels_of(iter(rows), cells, batches)
    seen = 0
    for stretch in batches.stretches:
        level = levels[stretch.cell].pop(0)
        own = [np.frombuffer(row[2]) for row in rows if 0 <= row[0] - stretch.begin < level.batches]
        own = [tail for tail in own if len(tail)]
        if len(own) > 1 and len(level.tail):
            least = max(tail[0] for tail in own)
            every = np.sort(np.concatenate(own))
            assert np.array_equal(level.tail, every[every >= least])
            seen += every[0] < least
    assert seen


def test_the_cost_of_a_realisation_is_no_mean_over_batches(tmp_path):
    """The last batch is smaller than the others."""
    study = study_from({**SMALL, "replicates": 9})
    drawn(study, tmp_path)
    cells, batches = cells_of(study), batches_of(cells_of(study))
    with opened(tmp_path, study) as store:
        rows = [(*row[:3], float(row[0] % 7), *row[4:]) for row in store.rows()]
    levels, unlike = aggregate.levels_of(iter(rows), cells, batches), 0
    for stretch in batches.stretches:
        level = levels[stretch.cell].pop(0)
        own = [batches[row[0]] for row in rows if 0 <= row[0] - stretch.begin < level.batches]
        n = np.array([batch.replicates * batch.samples for batch in own])
        assert level.cost == pytest.approx(np.average([batch.number % 7 for batch in own], weights=n), rel=1e-12)
        unlike += len(set(n)) > 1
    assert unlike


def test_an_estimator_that_always_fails_costs_the_others_nothing(tmp_path):
    cells = cells_of(STUDY)

    def poisoned(text, folder, batch, reference):
        if cells[batch.cell].name == "mis":
            raise ZeroDivisionError("always")
        return run_batch(text, folder, batch, reference)

    record = drawn(STUDY, tmp_path, draw=poisoned)
    failed, twin, good = (estimator(record, name) for name in ("mis", "mis + sobol", "airlight"))
    assert {f["estimator"] for f in record["failures"]} == {"mis"}
    assert failed["speed"] is None
    assert failed["outcome"] == twin["outcome"] == "inconclusive"
    assert good["outcome"] == "not rejected"
    assert record["answers"][0]["best"] in ("airlight", "airlight + sobol", "marched-airlight")
    assert "mis" in record["scenes"][0]["answer"]["unranked"]
    assert record["exit_code"] == 1
