"""Invariant: `fogproof stability` writes rows, JSON, CSV and a page of what it measured, and a page beside it tells of it."""

import csv
import json

import pytest
from click.testing import CliRunner
from report_records import Page

from fogproof.cli.commands import cli
from fogproof.errors import InvalidInputError
from fogproof.reports import prepare_folder, write_stability
from fogproof.reports.records.stability import parse_stability, stability_beside
from fogproof.stability import measuring


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    folder = tmp_path_factory.mktemp("stability")
    told = CliRunner().invoke(
        cli, ["stability", "--short", "free_path/distance", "phase/rayleigh", "-o", str(folder)], standalone_mode=False
    )
    assert told.return_value == 0, told.output
    return folder, told


def test_rows_are_told(run):
    _, told = run
    assert "free_path/distance" in told.stdout
    assert "-log(1 - xi)/sigma_t" in told.stdout
    assert "0 bounds broken" in told.stderr


def test_files_agree(run):
    folder, _ = run
    record = json.loads((folder / "stability.json").read_text())
    rows = list(csv.DictReader((folder / "stability.csv").read_text().splitlines()))
    assert record["schema"] == "fogproof/stability/1"
    assert [row["formula"] for row in rows] == [row["formula"] for row in record["measured"]]
    assert {row["truth"] for row in rows} == {row["truth"] for row in record["measured"]}
    parsed = parse_stability(record)
    assert parsed.measured == stability_beside(folder)[0].measured
    assert not parsed.broken


def test_page_shows_maps_and_stands_alone(run):
    folder, _ = run
    page = Page(folder / "stability.html")
    assert "No bound of" in page.html
    prepare_folder(folder, ("stability.html", "stability.json", "stability.csv"))  # it is seen to be ours
    assert "http://" not in page.html.replace("http://www.w3.org", "")
    maps = [it for it in page.all("div") if it.get("role") == "img"]
    assert maps
    assert all("bits" in it["aria-label"] for it in maps)
    assert len(list((folder / "figures").glob("*.svg"))) == len(list((folder / "figures").glob("*.png"))) == len(maps)


def test_the_page_of_a_run_beside_it_has_a_section(run):
    folder, _ = run
    told = CliRunner().invoke(cli, ["verify", "fog/analog/haze", "--report", str(folder)], standalone_mode=False)
    assert told.return_value == 0, told.output
    assert 'id="stability"' in (folder / "index.html").read_text()


def test_a_broken_record_is_refused_by_name(run, tmp_path):
    folder, _ = run
    record = json.loads((folder / "stability.json").read_text())
    with pytest.raises(InvalidInputError, match="measured"):
        write_stability({**record, "measured": [{}]}, tmp_path)
    (tmp_path / "stability.json").write_text("{")
    found, why = stability_beside(tmp_path)
    assert (found, "not JSON" in why) == (None, True)
    assert stability_beside(tmp_path / "nowhere") == (None, "")


def test_a_page_of_somebody_else_is_not_replaced(tmp_path):
    (tmp_path / "stability.html").write_text("mine")
    told = CliRunner().invoke(cli, ["stability", "free_path/distance", "-o", str(tmp_path)], standalone_mode=False)
    assert isinstance(told.exception, InvalidInputError)
    assert (tmp_path / "stability.html").read_text() == "mine"


def test_what_was_reached_is_kept_when_it_is_stopped(tmp_path, monkeypatch, interruptible):
    found = measuring.measure

    def measure(formula, points):
        if formula.name != "free_path/density":
            raise KeyboardInterrupt
        return found(formula, 3)

    monkeypatch.setattr(measuring, "measure", measure)
    told = CliRunner().invoke(cli, ["stability", "free_path", "-o", str(tmp_path)], standalone_mode=False)
    assert told.return_value == 130, told.output
    assert "stopped after 1 of" in told.stderr
    assert {row.formula for row in stability_beside(tmp_path)[0].measured} == {"free_path/density"}
