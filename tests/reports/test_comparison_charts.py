"""The pictures of a comparison: who became slower stands first, and no name lies over a mark or another name."""

import re

import numpy as np
import pytest
from report_records import Page, study

from fogproof.reports import write_comparison
from fogproof.reports.charts.before_after import BeforeAfter
from fogproof.reports.charts.pictures import render
from fogproof.reports.charts.sheet_png import text_width
from fogproof.reports.charts.time_changes import TimeChanges


def words_of(svg):
    """Return the name, left end and baseline of every text of size 12."""
    found = re.findall(r'<text x="([\d.]+)" y="([\d.]+)"[^>]*font-size="12"[^>]*>([^<]+)<', svg)
    return [(name, float(x), float(y)) for x, y, name in found]


def test_those_that_changed_come_first_and_are_told_apart():
    n = 30
    ratio = np.exp(0.05 * np.sin(np.arange(n)))
    ratio[17] = 0.4
    drawing = TimeChanges(
        tuple(f"haze / n{k}" for k in range(n)),
        tuple(ratio),
        tuple(ratio / 1.2),
        tuple(ratio * 1.2),
        (False,) * 17 + (True,) + (False,) * 12,
    )
    picture = render(drawing, "times", drawing.size)
    names = [name for name, _, _ in sorted(words_of(picture.svg), key=lambda row: row[2])]
    assert names[0] == "haze / n17"
    assert len(names) == 16
    assert "Times of 30 estimators, after over before: 0.4 to " in picture.words
    assert "; 1 changed beyond noise. Shown are 16." in picture.words


def test_an_endless_interval_leaves_the_picture_and_stretches_nothing():
    drawing = TimeChanges(("a", "b"), (1.0, 2.0), (1e-300, 1.5), (1e300, 3.0), (False, True))
    svg = render(drawing, "times", drawing.size).svg
    assert all(abs(float(x)) < 2000 for x in re.findall(r"[MHL](-?[\d.]+)", svg))


@pytest.mark.parametrize("seed", range(20))
def test_no_name_lies_over_a_mark_or_another_name(seed):
    rng = np.random.default_rng(seed)
    before = np.exp(0.3 * rng.normal(size=15))
    after = before * np.exp(1.5 * rng.normal(size=15))
    picture = render(
        BeforeAfter("Time [s]", tuple(f"theme/case-{k}" for k in range(15)), tuple(before), tuple(after)),
        "c",
        (560, 440),
    )
    (path,) = re.findall(r'<path d="((?:M[\d.]+ [\d.]+h0){15})"', picture.svg)
    marks = [(float(x), float(y)) for x, y in re.findall(r"M([\d.]+) ([\d.]+)h0", path)]
    boxes = [(x, y - 10, x + text_width(name, 12), y + 2) for name, x, y in words_of(picture.svg)]
    for k, (left, top, right, bottom) in enumerate(boxes):
        assert not any(left < x < right and top < y < bottom for x, y in marks)
        assert not any(left < c and a < right and top < d and b < bottom for a, b, c, d in boxes[k + 1 :])


def test_a_comparison_shows_its_picture_first(tmp_path):
    before, after = study(started="2026-01-30"), study()
    page = Page(write_comparison(before, after, tmp_path))
    first = page.html.index('role="img"')
    assert first < page.html.index('<h2 id="todo">')
    assert (
        "Times of 2 estimators, after over before: 2 to 2; 1 changed beyond noise; 1 more perhaps." in page.html[first:]
    )
