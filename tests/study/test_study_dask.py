"""A real Dask cluster draws the same bits as one thread, a worker that is killed in mid-study costs nothing, and a lost cluster
ends in a sentence from which the study can go on."""

import os
import signal

import pytest
from study_fixtures import SMALL, drawn, study_from, toml

pytest.importorskip("distributed")

from fogproof.study import read_study, run_study
from fogproof.study.cells import cells_of
from fogproof.study.plan import batches_of
from fogproof.study.run import draw_missing
from fogproof.study.store import opened
from fogproof.workers import executors
from fogproof.workers.executors import ClusterError, open_workers

STUDY = study_from(SMALL)


def test_a_cluster_gives_the_same_bits_though_a_worker_is_killed(tmp_path, cluster):
    address, (_, victim, _) = cluster
    undisturbed = drawn(STUDY, tmp_path / "threads")["digest"]
    cells, batches = cells_of(STUDY), batches_of(cells_of(STUDY))
    told = []

    def advance(batch, result):
        told.append(batch.number)
        if len(told) == len(batches) // 3:
            os.kill(victim.pid, signal.SIGKILL)

    with opened(tmp_path / "cluster", STUDY) as store:
        with open_workers(f"dask://{address}", None) as pool:
            assert pool.slots == 2
            draw_missing(STUDY, cells, batches, store, pool, advance)
        assert victim.wait() == -signal.SIGKILL
        assert store.failures() == []
        assert sorted(told) == list(range(len(batches)))
    file = tmp_path / "study.toml"
    file.write_text(toml(SMALL))
    assert drawn(STUDY, tmp_path / "cluster")["digest"] == undisturbed
    # The same through the front door, by the worker that is left, file and all.
    record = run_study(read_study(file), tmp_path / "again", executor=f"dask://{address}")
    assert record["executor"] == f"dask://{address}"
    assert record["digest"] == run_study(read_study(file), tmp_path / "here")["digest"]


def test_a_lost_cluster_keeps_what_is_there(tmp_path, cluster):
    address, processes = cluster
    cells, batches = cells_of(STUDY), batches_of(cells_of(STUDY))
    told = []

    def advance(batch, result):
        told.append(batch.number)
        if len(told) == len(batches) // 2:
            for process in processes:
                process.kill()

    with (
        opened(tmp_path, STUDY) as store,
        pytest.raises(ClusterError, match="the cluster was lost; what was drawn is kept"),
        open_workers(f"dask://{address}", None) as pool,
    ):
        draw_missing(STUDY, cells, batches, store, pool, advance)
    with opened(tmp_path, STUDY) as store:
        assert len(batches) // 2 <= len(store.done()) < len(batches)
    assert drawn(STUDY, tmp_path)["batches"]["done"] == len(batches)


def test_where_no_scheduler_answers(monkeypatch):
    monkeypatch.setattr(executors, "PATIENCE", 0.5)
    with (
        pytest.raises(ClusterError, match=r"no Dask scheduler answers at 127\.0\.0\.1:9"),
        open_workers("dask://127.0.0.1:9", None),
    ):
        pass
