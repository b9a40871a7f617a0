"""The chart of what passes could not have missed names every case in full, as far as there is room."""

import pytest

from fogproof.reports.charts import names
from fogproof.reports.charts.pictures import render
from fogproof.reports.charts.resolutions import Resolutions


def drawn(*given, kind="bias"):
    return render(Resolutions(tuple((name, kind, 1e-3 * (k + 1)) for k, name in enumerate(given))), "a")


@pytest.mark.parametrize(
    ("given", "shown", "folder"),
    [
        (("bsdf/rough/ggx/15", "bsdf/rough/beckmann/15"), ("ggx/15", "beckmann/15"), "bsdf/rough/"),
        (("bsdf/rough/15", "bsdf/roughly/15"), ("rough/15", "roughly/15"), "bsdf/"),
        (("a/b", "a/b"), ("b", "b"), "a/"),
        (("a/b/c",), ("a/b/c",), ""),
        (("one", "other"), ("one", "other"), ""),
    ],
)
def test_what_all_names_share_stands_in_the_caption(given, shown, folder):
    figure = drawn(*given)
    assert all(f">{name}<" in figure.on_page for name in shown)
    assert ("All names begin with" in figure.words) == bool(folder)
    assert f"All names begin with {folder}" in figure.words or not folder


def test_names_of_forty_letters_are_not_cut():
    name = "roughconductor/beckmann/alpha=0.4/whole/50"
    assert f">{name}<" in drawn(name, "x").on_page


def test_names_wider_than_half_the_chart_lose_their_middle():
    page = drawn("w" * 200, "x").on_page
    assert "w…w" in page
    assert "w" * 100 not in page


def test_a_name_of_any_length_is_cut_by_a_few_measurements(monkeypatch):
    widths = []
    monkeypatch.setattr(names, "text_width", lambda text, size: widths.append(len(text)) or 6.0 * len(text))
    assert names.cut("n" * 100_000 + "end", 240.0) == "n" * 19 + "…" + "n" * 17 + "end"
    assert max(widths) <= 240
    assert len(widths) <= 240


@pytest.mark.parametrize(
    ("last", "said"), [(1.0001e-3, "errors above 0.001 (bias)"), (2e-3, "errors above 0.001 to 0.002 (")]
)
def test_a_range_that_is_one_number_is_said_as_one(last, said):
    passes = (("a", "bias", 1e-3), ("b", "bias", last))
    assert said in render(Resolutions(passes), "a").words
