"""Ways are run in turn and compared round by round; the front holds what nothing beats; goals are told met from not met."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner

from fogproof.bench import Benchmark, Goal, Way, all_benchmarks, select
from fogproof.bench.figure import TimeErrorPlane, drawable
from fogproof.bench.measuring import WayTime, measure, missing, table
from fogproof.bench.record import changes, history, page, run_record, write_record
from fogproof.cli.commands import cli
from fogproof.errors import InvalidInputError
from fogproof.reports import prepare_folder
from fogproof.reports.gallery.plots import render_plot


def ticking(ways):
    """A benchmark of ways that take exactly so many seconds of a clock that they move themselves."""
    now, order = [0.0], []

    def way(name, seconds, error, factor):
        def run():
            order.append(name)
            now[0] += seconds
            return error

        return Way(run, 2.0, None if error is None else lambda e: e, factor, lambda: now[0])

    made = {name: way(name, *rest) for name, rest in ways.items()}
    goals = {"slow": Goal(">=", 3.0), "exact": Goal("<=", 1.0)}
    return Benchmark("ticks", "Ticks", "tick", "fast", lambda: made, goals), order


WAYS = {"fast": (1.0, 1e-3, 1.0), "slow": (4.0, 1e-2, 1.0), "exact": (2.0, 0.0, 3.0), "plain": (1.0, None, 1.0)}


def test_ratios_errors_fronts_and_goals():
    benchmark, order = ticking(WAYS)
    rows = {row.way: row for row in measure(benchmark, 0.0)}
    assert {name: row.ratio for name, row in rows.items()} == {"fast": 1, "slow": 4, "exact": 6, "plain": 1}
    assert rows["exact"].median == rows["exact"].fastest == 3.0  # 2 s for two units, times the variance 3
    assert {name for name, row in rows.items() if row.front} == {"fast", "exact"}
    assert (rows["slow"].met, rows["exact"].met, rows["fast"].met) == (True, False, None)
    names = list(WAYS)
    assert order == [*names, *names * rows["fast"].rounds]  # once to begin with, then in turn


def test_the_record_keeps_its_history_and_says_what_has_changed(tmp_path):
    benchmark, _ = ticking(WAYS)
    rows = measure(benchmark, 0.0)
    record = run_record(rows, "2026-01-01", 1.0)
    write_record(record, rows, [benchmark], tmp_path)
    write_record(record, rows, [benchmark], tmp_path)
    (path,) = tmp_path.glob("*.jsonl")
    whole = path.read_bytes()
    assert history(tmp_path) == ([json.loads(line) for line in whole.splitlines()], 0)
    first, second = whole.splitlines()
    for lost in (b"\0" * 40, b"\0" * 40 + b"\n"):  # a machine lost its power
        path.write_bytes(whole + lost)
        assert len(history(tmp_path)[0]) == 2
    for bad in (
        b"my notes",
        b"[]",
        first[:-9],
        first.replace(b'"ways"', b'"way"'),
        first.replace(b'"low"', b'"lo"', 1),
    ):
        path.write_bytes(bad + b"\n" + second + b"\n")
        assert history(tmp_path) == ([json.loads(second)], 1)
    path.write_bytes(b"my notes\n")
    with pytest.raises(InvalidInputError, match="holds no record of"):
        history(tmp_path)
    path.write_bytes(whole)
    prepare_folder(tmp_path, ("bench.json", "bench.md"))  # it is seen to be ours
    assert {way["way"] for way in json.loads((tmp_path / "bench.json").read_text())["ways"]} == set(WAYS)
    assert "Goals not met: ticks, exact." in (tmp_path / "bench.md").read_text()
    assert (tmp_path / "figures" / "speed-ticks.svg").stat().st_size > 1000
    assert changes(rows, record) == []
    slower = [replace(row, ratio=2 * row.ratio, low=2 * row.low, high=2 * row.high) for row in rows]
    assert "ticks, slow: 4 -> 8" in changes(slower, record)
    assert "| ticks | slow | 4 |" in page(record, rows)


def test_the_figure_names_the_front_in_words():
    rows = tuple(measure(ticking(WAYS)[0], 0.0))
    assert drawable(rows)
    assert not drawable(rows[:1])
    assert "than fast, exact." in render_plot(TimeErrorPlane("Ticks", rows), "ticks").words


def test_names_are_single_bases_exist_and_wrong_names_are_refused():
    benchmarks = all_benchmarks()
    assert len({b.name for b in benchmarks}) == len(benchmarks) > 10
    assert {b.name for b in select(["airlight", "check-*"])} >= {"airlight", "check-line", "check-labels"}
    with pytest.raises(InvalidInputError, match="no benchmark is called"):
        select(["airlihgt"])


@pytest.mark.parametrize("name", ["samplers", "directions", "transmittance-estimators", "airlight-estimators"])
def test_goals_and_bases_are_of_ways(name):
    (benchmark,) = select([name])
    if missing(benchmark):
        pytest.skip(f"{benchmark.needs} is not installed")
    ways = benchmark.ways()
    assert benchmark.base in ways
    assert set(benchmark.goals) <= set(ways)


def test_the_record_tells_which_vectors_numpy_has():
    """Logarithms take four times as long without AVX-512: a ratio to uniforms says nothing without them."""
    rows = measure(ticking(WAYS)[0], 0.0)
    record = run_record(rows, "2026-01-01", 1.0)
    vectors = record["machine"]["vectors"]
    found = np.show_config(mode="dicts")["SIMD Extensions"]["found"]
    assert vectors == (found[-1] if found else "baseline")
    assert f"with vectors of {vectors}. " in page(record, rows)


@pytest.mark.parametrize("name", ["samplers", "directions"])
def test_the_documentation_has_every_sampler_without_avx_512(name):
    page = (Path(__file__).resolve().parents[2] / "docs" / "speed-without-avx512.md").read_text(encoding="utf-8")
    (benchmark,) = select([name])
    assert all(f"| {name} | {way} |" in page for way in benchmark.ways())


def test_the_command_writes_what_it_measured(tmp_path):
    arguments = ["bench", "samplers", "--seconds", "0", "-o", str(tmp_path), "--json"]
    ran = CliRunner().invoke(cli, arguments, standalone_mode=False)
    assert ran.return_value == 0, ran.output
    ways = json.loads(ran.stdout)["ways"]
    assert all(isinstance(WayTime(**way), WayTime) for way in ways)
    assert ways[0]["ratio"] == 1
    assert table([WayTime(**ways[1])]).count("\n") == 2
