"""Whatever a stopped command writes says that it is unfinished, in the same words."""

import csv
import json
import os
import shlex
import sys

import numpy as np
import pytest
from report_records import typical

from fogproof.bench.record import page as bench_page
from fogproof.bench.record import run_record
from fogproof.checks.json_values import jsonable
from fogproof.checks.statistics.known import Known
from fogproof.cli import main
from fogproof.contracts import Reference
from fogproof.reports.gallery import pictures
from fogproof.reports.pages.stability import headline
from fogproof.reports.records.runs import parse_record, write_csv
from fogproof.reports.records.stability import parse_stability
from fogproof.stability.record import run_record as stability_record
from fogproof.study.aggregate import Level
from fogproof.study.between_replicates import between_replicates
from fogproof.study.judgement import _against_theory
from fogproof.zoo.comparison import page as zoo_page

SCENE = "scenes/images/sun.toml"
STOPPING = f"{shlex.quote(sys.executable)} -c 'import os, time; os.kill({{pid}}, 15); time.sleep(60)' {{scene}} {{out}}"


@pytest.mark.parametrize("command", ["render", "relations"])
def test_a_stopped_renderer_leaves_an_unfinished_page(command, tmp_path, capsys):
    renderer = STOPPING.replace("{pid}", str(os.getpid()))
    with pytest.raises(SystemExit) as end:
        main([command, SCENE, "--with", renderer, "-o", str(tmp_path)])
    assert end.value.code == 143
    record = json.loads((tmp_path / "results.json").read_text())
    assert record["state"] == "interrupted"
    assert record["title"].startswith("Unfinished: 0 of ")
    assert f"<title>{record['title']} " in (tmp_path / "index.html").read_text()
    assert "stopped after 0 of " in capsys.readouterr().err


def test_a_finished_renderer_leaves_a_finished_page(tmp_path):
    with pytest.raises(SystemExit):
        main(["render", SCENE, "--with", "false {scene} {out}", "-o", str(tmp_path)])
    record = json.loads((tmp_path / "results.json").read_text())
    assert (record["state"], record["title"]) == ("finished", "")
    assert "Unfinished" not in (tmp_path / "index.html").read_text()


def test_a_bench_that_measured_nothing_met_no_goal():
    record = run_record([], "2026-01-01", 1.0, ["airlight", "tracking"], 130)
    assert (record["state"], record["title"]) == ("interrupted", "Unfinished: 0 of 2")
    text = bench_page(record, [])
    assert text.startswith("# Unfinished: 0 of 2 benchmarks\n")
    assert "No goal was judged." in text
    assert "Every goal" not in text


def test_a_zoo_that_ran_nothing_says_nothing_of_survivors():
    text = zoo_page([], 1000, 1e-6, {}, 79)
    assert text.startswith("# Unfinished: 0 of 79 bugs were run\n")
    assert "## What survived\n\nNothing yet. Unfinished: 0 of 79." in text


def test_a_table_of_an_unfinished_run_names_what_was_not_run(tmp_path):
    told = jsonable(typical(2))
    path = write_csv(
        parse_record({**told, "state": "interrupted", "asked": ["=late", told["cases"][0]["name"]]}), tmp_path
    )
    rows = list(csv.DictReader(path.read_text().splitlines()))
    assert [row["status"] for row in rows] == [*(case["status"] for case in told["cases"]), "not run"]
    assert (rows[-1]["name"], rows[-1]["outcome"]) == ("'=late", "")


@pytest.mark.parametrize("replicates", [1, 2])
def test_a_study_stopped_after_few_replicates_is_judged(replicates):
    rng = np.random.default_rng(1)
    x = rng.normal(size=(replicates, 100))
    rows = np.array(
        [
            [100, row.mean(), *(np.sum((row - row.mean()) ** k) for k in (2, 3, 4)), row.min(), row.max(), 1, 1, 0]
            for row in x
        ]
    )
    exact = Reference(np.float64(1.0), np.float64(0.0), "", "")
    level = Level(
        100, rows, 48, rows[0], np.zeros(0), float("nan"), np.zeros(0), float("nan"), replicates, 0.0, np.empty((0, 4))
    )
    between = between_replicates([level], 1e-6)
    (variance,) = _against_theory([level], exact, 1e-6, Known(), 0.0, 0.0, between)
    assert variance.check == "variance"
    assert (between.calls, between.finding is None) == ("independent", replicates == 1)


def test_a_stopped_stability_run_is_unfinished():
    record = stability_record([], command="", started="", seconds=1.0, points=8, asked=5, stopped=143)
    assert (record["state"], record["title"]) == ("interrupted", "Unfinished: 0 of 5")
    assert headline(parse_stability(record))[0].startswith("Unfinished: 0 of 5 formulas were measured")


def test_a_stopped_gallery_keeps_what_was_drawn(monkeypatch, tmp_path):
    draw = pictures.render_plot

    def stopping(drawing, name):
        if name == "fog":
            os.kill(os.getpid(), 15)
        return draw(drawing, name)

    monkeypatch.setattr(pictures, "render_plot", stopping)
    with pytest.raises(SystemExit) as end:
        main(["gallery", "fog", "phase-polar", "-o", str(tmp_path)])
    assert end.value.code == 143
    record = json.loads((tmp_path / "gallery.json").read_text())
    assert (record["state"], record["title"]) == ("interrupted", "Unfinished: 1 of 2")
    assert [one["name"] for one in record["pictures"]] == ["phase-polar"]
    assert "<title>Unfinished: 1 of 2 pictures" in (tmp_path / "gallery.html").read_text()
