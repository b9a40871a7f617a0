"""How long does a page take to make and to open, and how large is it?

    python benchmarks/report.py [--cases 500]

The cases are a few of the catalogue's, run once and copied under new names; one in ten is a broken twin, with all its figures.
A study's record holds sums, and its page takes as long for a million batches; what sums up the store before is timed by
benchmarks/study.py. Opening is timed by Chromium itself, from the start of navigation to the end of the load event, where it is
installed (Debian's packages chromium and chromium-driver).
"""

from __future__ import annotations

import argparse
import importlib.util
import shutil
import tempfile
import time
from pathlib import Path
from typing import Any

from fogproof.checks.json_values import jsonable
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


def timed(what: str, one: dict[str, Any], folder: Path) -> None:
    """Make a page and print what it takes."""
    started, processor = time.perf_counter(), time.process_time()
    page = write_report(one, folder)
    made = time.perf_counter() - started
    processor = time.process_time() - processor
    figures = list((folder / "figures").iterdir())
    megabytes = sum(path.stat().st_size for path in figures) / 1e6
    size = page.stat().st_size / 1e6
    print(f"{what}: made in {made:.1f} s ({processor:.1f} s of processor time), {size:.1f} MB")
    print(f"    opens in {opened(page):.2f} s; {len(figures)} files of figures, {megabytes:.1f} MB")


STUDY = """
title = "a study"
samples = [100, 1000, 10_000]
replicates = 16
[[scenes]]
name = "lamp"
quantity = "airlight"
medium = { sigma_a = 0.1, sigma_s = 0.4 }
ray = { origin = [0, 0, -2], direction = [0, 0, 1], length = 5 }
light = { position = [0.6, -0.8, 0.5], intensity = 3 }
estimators = ["airlight", "mis", "marched-airlight"]
[[scenes]]
name = "gradient"
quantity = "transmittance"
medium = { kind = "exponential", sigma_0 = 1, rate = [0, 0, -1] }
ray = { origin = [0, 0, 0], direction = [0, 0, 1], length = 2 }
estimators = ["analog", "delta", "ratio", "march"]
"""


def study(folder: Path) -> dict[str, Any]:
    """Return the record of a small study: it holds sums, and is as large for a million batches."""
    from fogproof.study.conduct import run_study
    from fogproof.study.files import read_study

    folder.mkdir(parents=True)
    (folder / "study.toml").write_text(STUDY)
    return run_study(read_study(folder / "study.toml"), folder)


def main() -> None:
    """Time both."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--cases", type=int, default=500)
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        timed(f"{arguments.cases} cases", cases(arguments.cases), Path(folder) / "cases")
        timed("a study of two scenes", study(Path(folder) / "study"), Path(folder) / "study")


if __name__ == "__main__":
    main()
