"""How long does a page take to make and to open, and how large is it?

    python benchmarks/report.py [--cases 500] [--batches 1000000]

The cases are a few of the catalogue's, run once and copied under new names; one in ten is a broken twin, with all its figures.
The batches are drawn once and stored many times over. Opening is timed by Chromium itself, from the start of navigation to the
end of the load event, where it is installed (Debian's packages chromium and chromium-driver).
"""

from __future__ import annotations

import argparse
import importlib.util
import shutil
import tempfile
import time
from pathlib import Path
from typing import Any

from fogproof.checks import jsonable
from fogproof.reports import write_report
from fogproof.verify import record, run, select

KINDS = [
    "directions/rayleigh",
    "directions/murky/tilted",
    "cosines/hazy",
    "free-path/thin",
    "fog/analog",
    "airlight/mixed",
]


def cases(count: int) -> dict[str, Any]:
    """Return the record of a run of so many cases, a tenth of them rejected."""
    chosen = select(KINDS)
    results = list(run(chosen, seed=1, alpha=1e-6, workers=2, twins=True))
    one = record(results, seed=1, alpha=1e-6, command="fogproof verify", started="2026-01-31T12:00:00Z", seconds=1.0)
    wrong = {case.name: jsonable(case.run(1e-9, 1, twin=True).to_dict()) for case in chosen}
    many = []
    for number in range(count):
        copied = one["cases"][number % len(chosen)]
        name = f"copy-{number // len(chosen)}/{copied['name']}"
        changes = {"status": "rejected", "verdict": wrong[copied["name"]]} if number % 10 == 9 else {}
        many.append({**copied, "name": name, **changes})
    return {**one, "cases": many, "exit_code": 1}


def opened(page: Path) -> float:
    """Return how many seconds Chromium takes to open a page, the middle of five; not a number if it is not installed."""
    if not (importlib.util.find_spec("selenium") and shutil.which("chromium") and shutil.which("chromedriver")):
        return float("nan")
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = shutil.which("chromium")
    for switch in ("headless", "no-sandbox", "disable-gpu", "disable-dev-shm-usage", "window-size=1200,900"):
        options.add_argument(f"--{switch}")
    driver = webdriver.Chrome(options=options, service=webdriver.ChromeService(shutil.which("chromedriver")))
    took = []
    try:
        for _ in range(5):
            driver.get("about:blank")
            driver.get(page.as_uri())
            script = "const it = performance.getEntriesByType('navigation')[0]; return it.loadEventEnd - it.startTime"
            took.append(driver.execute_script(script) / 1e3)
    finally:
        driver.quit()
    return sorted(took)[2]


def timed(what: str, one: dict[str, Any], folder: Path, seconds: float = 0.0) -> None:
    """Make a page and print what it takes; `seconds` were needed before."""
    started, processor = time.perf_counter(), time.process_time()
    page = write_report(one, folder)
    made = time.perf_counter() - started + seconds
    processor = time.process_time() - processor
    figures = list((folder / "figures").iterdir())
    megabytes = sum(path.stat().st_size for path in figures) / 1e6
    size = page.stat().st_size / 1e6
    print(f"{what}: made in {made:.1f} s ({processor:.1f} s of processor time for the page), {size:.1f} MB")
    print(f"    opens in {opened(page):.2f} s; {len(figures)} files of figures, {megabytes:.1f} MB")


def study(count: int, folder: Path) -> None:
    """Store batches of a study, then time what makes the record and the page of them."""
    from fogproof.study.batches import BatchResult, draw_batch
    from fogproof.study.cells import batches_of, cells_of, prepare
    from fogproof.study.files import read_study
    from fogproof.study.record import Circumstances, make_record
    from fogproof.study.store import opened as store_of

    text = f"""
        title = "many batches"
        samples = [1024, 2048]
        batch = 1024
        sobol = false
        replicates = {count // 9}
        [[scenes]]
        name = "gradient"
        quantity = "transmittance"
        medium = {{ kind = "exponential", sigma_0 = 1, rate = [0, 0, -1] }}
        ray = {{ origin = [0, 0, 0], direction = [0, 0, 1], length = 2 }}
        estimators = ["analog", "delta", "ratio"]
    """
    folder.mkdir(parents=True)
    (folder / "study.toml").write_text(text)
    asked = read_study(folder / "study.toml")
    cells = cells_of(asked)
    batches = batches_of(cells)
    with store_of(folder, asked) as store:
        prepare(cells)
        drawn = {}
        for batch in batches:
            key = batch.cell, batch.count, batch.index % 50
            if key not in drawn:
                drawn[key] = draw_batch(cells[batch.cell], batch, float(cells[batch.cell].reference.value))
        for first in range(0, len(batches), 10_000):
            part = batches[first : first + 10_000]
            results = [(batch.index, drawn[batch.cell, batch.count, batch.index % 50]) for batch in part]
            store.add([BatchResult(i, r.moments, r.tail, r.cost, r.wall, r.cpu) for i, r in results])
        started = time.perf_counter()
        run_of = Circumstances("fogproof study", "2026-01-31T12:00:00Z", 1.0, "threads", 2)
        one = make_record(asked, cells, batches, store, run_of)
        seconds = time.perf_counter() - started
    print(f"{len(batches)} batches: record made of the store in {seconds:.1f} s")
    timed("their page, record included", one, folder, seconds)


def main() -> None:
    """Time both."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=500)
    parser.add_argument("--batches", type=int, default=1_000_000)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        timed(f"{arguments.cases} cases", cases(arguments.cases), Path(folder) / "cases")
        study(arguments.batches, Path(folder) / "study")


if __name__ == "__main__":
    main()
