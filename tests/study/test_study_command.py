"""`fogproof study` runs, resumes, compares, and says in words and numbers what it found; its record is what its schema says."""

import csv
import json
import re
import subprocess
import sys
from pathlib import Path
from typing import get_args

import jsonschema
import numpy as np
import pytest
from study_fixtures import BALL, LIT, RAY, kinds, toml

from fogproof.cli.study_command import _name
from fogproof.reports.records.studies import parse_study
from fogproof.study.reaching import How, Reach
from fogproof.study.speed import Times

ROOT = Path(__file__).resolve().parents[2]
TABLE = {
    "title": "a small one",
    "samples": [64, 512, 4096],
    "replicates": 8,
    "scenes": [
        {**LIT, "estimators": kinds("airlight", {"kind": "airlight", "placing": "uniform"}, "marched-airlight")},
        {"name": "fog", "quantity": "fog", "medium": {"sigma_a": 0.1, "sigma_s": 0.4}, "ray": RAY, "ambient": 1.0,
         "estimators": kinds("analog-fog", "certain-collision")},
        {"name": "beam", "quantity": "transmittance", "medium": {"sigma_a": 0.1, "sigma_s": 0.4}, "ray": RAY,
         "estimators": kinds("analog", {"kind": "march", "rule": "right"})},
        {**BALL, "estimators": kinds("path-tracing", {"kind": "path-tracing", "light_sampling": "bsdf"})},
    ],
}  # fmt: skip


def fogproof(*arguments):
    return subprocess.run(
        [sys.executable, "-c", "from fogproof.cli import main; main()", *map(str, arguments)],
        capture_output=True, text=True, timeout=1800,
    )  # fmt: skip


@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    folder = tmp_path_factory.mktemp("study")
    (folder / "study.toml").write_text(toml(TABLE))
    return folder, fogproof("study", folder / "study.toml", "-o", folder / "run")


def test_it_says_what_is_best(ran):
    folder, out = ran
    assert out.returncode == 0, out.stderr
    assert "Which is best beside a lamp?\n  lit\n    " in out.stderr
    assert re.search(" is (soonest: 1 % in |first: 1 % in .*, not to be told from )", out.stderr)
    assert "is biased by construction" in out.stderr
    rows = [line.split()[0] for line in out.stdout.splitlines() if line.startswith("  ")]
    assert rows.count("estimator") == 4
    assert "airlight" in rows
    assert sorted(p.name for p in (folder / "run").iterdir()) == [
        *("figures", "index.html", "junit.xml", "results.csv", "results.json", "study.sqlite")
    ]
    assert f"page: {folder / 'run' / 'index.html'}" in out.stderr
    assert _name({"name": "mine:A", "kind": "mine:A", "label": "Mine"}) == "mine:A “Mine”"
    assert _name({"name": "delta", "kind": "delta", "label": "Delta tracking"}) == "delta"
    assert "for 64, 512, 4096" not in out.stdout  # powers of two are taken as they are


def test_the_record_is_what_the_schema_says(ran, tmp_path):
    folder, _ = ran
    schema = json.loads((ROOT / "schemas" / "study-1.json").read_text())
    jsonschema.Draft202012Validator.check_schema(schema)
    check = jsonschema.Draft202012Validator(schema)
    record = json.loads((folder / "run" / "results.json").read_text())
    check.validate(record)
    again = fogproof("study", folder / "study.toml", "-o", folder / "run", "--against", folder / "run", "--json")
    compared = json.loads(again.stdout)
    check.validate(compared)
    assert compared["history"]["same_draws"]
    assert compared["digest"] == record["digest"]
    assert again.returncode == 0
    record["scenes"][0]["estimators"][0]["speed"]["surprise"] = 1
    assert not check.is_valid(record)


@pytest.mark.parametrize("how", get_args(How))
def test_the_schema_knows_every_way_to_an_error(ran, how):
    record = json.loads((ran[0] / "run" / "results.json").read_text())
    check = jsonschema.Draft202012Validator(json.loads((ROOT / "schemas" / "study-1.json").read_text()))
    record["scenes"][0]["estimators"][0]["speed"]["targets"][0]["how"] = how
    told = next(row["all"] for scene in record["scenes"] for row in scene["answer"]["soonest"] if row["all"])
    if Reach(0.01, how, "", None, Times(np.ones(2))).reached:
        told["how"] = how
    check.validate(record)
    parse_study(record)


def test_every_count_has_a_row(ran):
    folder, _ = ran
    record = json.loads((folder / "run" / "results.json").read_text())
    with (folder / "run" / "results.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    counts = [c for s in record["scenes"] for e in s["estimators"] for c in e["counts"]]
    assert [float(row["rmse"]) for row in rows] == [c["rmse"] for c in counts]
    assert {row["scene"] for row in rows} == {"lit", "fog", "beam", "ball"}


def test_a_march_through_what_does_not_vary_is_exact(ran):
    folder, _ = ran
    record = json.loads((folder / "run" / "results.json").read_text())
    march = record["scenes"][2]["estimators"][-1]
    assert march["kind"] == "march"
    assert march["outcome"] == "not rejected"
    assert all(t["how"] == "less-than" for t in march["speed"]["targets"])
    assert "is exact here" in record["scenes"][2]["answer"]["text"]
    lit = next(e for e in record["scenes"][0]["estimators"] if e["kind"] == "marched-airlight")
    assert lit["status"] == "known"
    assert lit["order"]["low"] <= 2 <= lit["order"]["high"]
    assert lit["order"]["high"] - lit["order"]["low"] < 0.2


FAULTS = {
    "no file": (["none.toml", "-o", "x"], "cannot read the study file"),
    "no folder": (["study.toml"], "Missing option '-o'"),
    "no executor": (
        ["study.toml", "-o", "x", "--executor", "abacus"],
        "must be threads, processes or dask://host:port",
    ),
    "no earlier run": (["study.toml", "-o", "run", "--against", "none"], "none: No such file or directory"),
    "no study's record": (["study.toml", "-o", "run", "--against", "other.json"], "is not the record of a study"),
}


@pytest.mark.parametrize(("arguments", "words"), FAULTS.values(), ids=FAULTS)
def test_faults_end_in_a_sentence_and_exit_2(ran, arguments, words):
    folder, _ = ran
    (folder / "other.json").write_text(json.dumps({"schema": "fogproof/results/1", "kind": "verify"}))
    places = ("none.toml", "study.toml", "x", "run", "none", "other.json")
    out = fogproof("study", *(folder / word if word in places else word for word in arguments))
    assert out.returncode == 2
    assert words in out.stderr
    assert "Traceback" not in out.stderr
    assert out.stdout == ""


def test_it_becomes_worse(ran, tmp_path):
    """An earlier record in which an estimator was less noisy makes this run one that has become noisier."""
    folder, _ = ran
    earlier = json.loads((folder / "run" / "results.json").read_text())
    variance = earlier["scenes"][0]["estimators"][0]["variance"]
    variance.update({k: variance[k] / 2 for k in ("measured", "low", "high")})
    earlier["scenes"][0]["estimators"][0]["moments"]["m2"] /= 2
    (tmp_path / "results.json").write_text(json.dumps(earlier))
    out = fogproof("study", folder / "study.toml", "-o", folder / "run", "--against", tmp_path)
    assert out.returncode == 1
    assert "against the earlier run: noisier: lit / airlight" in out.stderr
    shown = fogproof("report", folder / "run", "--against", tmp_path)  # one comparison, whoever asks
    assert shown.returncode == 1
    page = (folder / "run" / "comparison.html").read_text()
    assert "Noisier: lit / airlight" in page
    assert "1 case came out worse" in page
    assert "Noisier: lit / airlight" in (folder / "run" / "index.html").read_text()
