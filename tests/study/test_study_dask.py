"""A real Dask cluster draws the same bits as one thread, a worker that is killed in mid-study costs nothing, and a lost cluster
ends in a sentence from which the study can go on."""

import json
import os
import signal
import subprocess
import sys
import time

import pytest
from study_fixtures import SMALL, drawn, study_from, toml

pytest.importorskip("distributed")

from fogproof.study import executors, read_study, run_study
from fogproof.study.cells import cells_of
from fogproof.study.executors import ClusterError, open_workers
from fogproof.study.plan import batches_of
from fogproof.study.run import draw_missing
from fogproof.study.store import opened

STUDY = study_from(SMALL)
PATIENCE = 1800  # seconds, for a machine that has other things to do


def started(*arguments):
    command = [sys.executable, "-m", "dask", *map(str, arguments)]
    return subprocess.Popen(command, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)


def waited_for(condition):
    deadline = time.monotonic() + PATIENCE
    while not (found := condition()):
        assert time.monotonic() < deadline, "the cluster did not come up"
        time.sleep(0.05)
    return found


@pytest.fixture(scope="module")
def cluster(tmp_path_factory):
    """Start a scheduler and two workers on loopback; return its address and all three processes."""
    folder = tmp_path_factory.mktemp("dask")
    file = folder / "scheduler.json"
    host = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard", "--scheduler-file", file)
    processes = [started("scheduler", *host)]
    try:

        def address():
            try:
                return json.loads(file.read_text())["address"].removeprefix("tcp://")
            except (OSError, ValueError):
                return None

        found = waited_for(address)
        for name in ("one", "two"):
            local = ("--local-directory", folder / name, "--name", name)
            alone = ("--nthreads", "1", "--no-nanny", "--no-dashboard", "--host", "127.0.0.1")
            processes.append(started("worker", f"tcp://{found}", *alone, *local))
        from distributed import Client

        with Client(f"tcp://{found}", set_as_default=False) as client:
            client.wait_for_workers(2, timeout=PATIENCE)
        yield found, processes
    finally:
        for process in processes:
            process.kill()
        for process in processes:
            process.wait()


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
