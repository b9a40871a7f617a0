"""How often do the checks reject what is right? p-values of every kind of check under the null, and whole verdicts.

    python tools/calibrate.py [--verdicts 100000] [--seeds 330 33 1] [--workers 2] [--page docs/calibration.md]

Of each kind of check, at least `--verdicts` p-values of right subjects are counted at or below 1e-3: every subject is judged a few
thousand times, and those of the rarest kind go on. No kind may exceed the upper
end of its 99.9 % band, taken over all kinds together; exact kinds may not fall below the lower end either. Then right samplers are
checked whole at alpha = 1e-6, with `--seeds` seeds at 10^5, 10^6 and 10^8 samples: none may be rejected, and none inconclusive that
`calibrate_subjects.OPEN` does not name. What is done is written down as it ends: who starts again goes on.
"""

from __future__ import annotations

import argparse
import itertools
import json
import platform
import sys
import time
from collections import Counter, defaultdict
from collections.abc import Iterable
from concurrent.futures import FIRST_COMPLETED, ProcessPoolExecutor, wait
from dataclasses import fields, replace
from pathlib import Path

import calibrate_estimators
import numpy as np
import planted
from calibrate_subjects import OPEN, RIGHT, SUBJECTS, estimator_findings
from calibrate_tally import LEVEL, Tally, outside, page

from fogproof.checks import SamplerCheck, check_sampler, fresh_seed
from fogproof.checks.prepared import Prepared


def _reseeded(prepared: Prepared, seed: int) -> Prepared:
    """Return the same cells with other points of the known law to mix samples with."""
    mixture = prepared.counter.mixture
    if mixture is None:
        return prepared
    return replace(prepared, counter=replace(prepared.counter, mixture=replace(mixture, seed=seed)))


def sampler_tally(name: str, verdicts: int, samples: int, seed: int) -> Tally:
    """Judge a right sampler many times, all on the cells of one pilot."""
    check = SamplerCheck.of(SUBJECTS[name](), None, samples, LEVEL, seed)
    tally = Tally()
    for i in range(verdicts):
        again = SamplerCheck(_reseeded(check.prepared, seed + 1 + i), check.looks, LEVEL, seed + 1 + i, check.started)
        tally.add(again.run().findings)
    return tally


def estimator_tally(verdicts: int, samples: int, seed: int) -> Tally:
    """Judge right estimators many times."""
    tally = Tally()
    for i in range(verdicts):
        tally.add(estimator_findings(samples, seed + i))
    return tally


def whole_verdicts(name: str, seeds: int, samples: int, seed: int) -> Counter[str]:
    """Check a right sampler with many seeds at the usual alpha; return how often each outcome came up."""
    subject = RIGHT[name]()
    given = {field.name: getattr(subject, field.name) for field in fields(subject) if field.name != "pilot"}
    outcomes: Counter[str] = Counter()
    for i in range(seeds):
        verdict = check_sampler(**given, samples=samples, seed=seed + i)
        outcomes[verdict.outcome] += 1
        if verdict.outcome == "rejected":
            print(f"{name}: {verdict}", file=sys.stderr, flush=True)
    return outcomes


def allowed(name: str) -> set[str]:
    """Return what a whole verdict on a right sampler may be."""
    return {"not rejected", "inconclusive"} if name in OPEN else {"not rejected"}


_PART = 1000  # verdicts of one task
_LEAST = 3  # tasks of each subject
_ESTIMATORS = "estimators"
Job = tuple[
    str, str, int, int, int
]  # p-values or whole verdicts, of what, at how many samples, how many, number of the part


def whole_jobs(seeds: Iterable[int]) -> list[Job]:
    """Return the whole verdicts there are to make, in parts."""
    wanted = [(name, n, count) for n, count in zip((10**5, 10**6, 10**8), seeds, strict=True) for name in RIGHT]
    return [
        ("whole", name, n, size, part)
        for name, n, count in wanted
        for part, size in enumerate([_PART] * (count // _PART) + [count % _PART] * (count % _PART > 0))
    ]


def scarcest(rows: Iterable[dict], started: Counter[str], verdicts: int) -> str | None:
    """Return of which subject to make p-values next: of the kind there are fewest of, where that takes least time.

    started  parts of each subject that are done or being done; None is returned once there are `verdicts` p-values of every kind
    """
    few = [name for name in (_ESTIMATORS, *SUBJECTS) if started[name] < _LEAST]
    if few:
        return min(few, key=lambda name: started[name])
    done: Counter[str] = Counter()
    seconds: Counter[str] = Counter()
    counted: dict[str, Counter[str]] = defaultdict(Counter)
    for row in rows:
        name = row["job"][1]
        done[name] += 1
        seconds[name] += row["seconds"]
        counted[name].update(row["counted"])
    total: Counter[str] = Counter()
    for name, kinds in counted.items():
        for kind, count in kinds.items():
            total[kind] += count * started[name] / done[name]
    if not total or min(total.values()) >= verdicts:
        return None
    kind = min(total, key=lambda kind: total[kind])
    return max(counted, key=lambda name: counted[name][kind] / seconds[name])


def done(job: Job, seed: int) -> dict:
    """Do one part; return its row of the log."""
    kind, name, samples, size, _ = job
    began = time.process_time()
    if kind == "whole":
        return {"job": job, "outcomes": whole_verdicts(name, size, samples, seed)}
    tally = estimator_tally(size, samples, seed) if name == _ESTIMATORS else sampler_tally(name, size, samples, seed)
    return {"job": job, "seconds": time.process_time() - began, **vars(tally)}


def rows_of(verdicts: int, samples: int, seeds: Iterable[int], log: Path, workers: int) -> list[dict]:
    """Do what the log has not got yet, each part with a fresh seed; return the rows of what was asked."""
    log.parent.mkdir(parents=True, exist_ok=True)
    rows = {tuple(row["job"]): row for row in map(json.loads, log.read_text().splitlines())} if log.exists() else {}
    mine = {job: row for job, row in rows.items() if job[0] == "p" and job[2:4] == (samples, _PART)}
    started = Counter(job[1] for job in mine)
    wholes = whole_jobs(seeds)
    waiting = iter([job for job in wholes if job not in rows])

    def following() -> Job | None:
        name = scarcest(mine.values(), started, verdicts)
        if name is None:
            return next(waiting, None)
        part = next(part for part in itertools.count() if ("p", name, samples, _PART, part) not in taken)
        started[name] += 1
        return "p", name, samples, _PART, part

    taken, running = set(mine), {}
    with ProcessPoolExecutor(workers) as pool, log.open("a") as file:
        while True:
            while len(running) < workers and (job := following()):
                taken.add(job)
                running[pool.submit(done, job, fresh_seed() >> 2)] = job
            if not running:
                break
            for future in wait(running, return_when=FIRST_COMPLETED).done:
                job, row = running.pop(future), future.result()
                (mine if job[0] == "p" else rows)[job] = row
                print(json.dumps(row), file=file, flush=True)
                print(f"\r{sum(started.values())} parts of p-values; now {job[1]}", end="", file=sys.stderr, flush=True)
    return [*mine.values(), *(rows[job] for job in wholes)]


def gathered(rows: Iterable[dict]) -> tuple[Tally, dict[tuple[str, int], Counter[str]]]:
    """Put the parts together: p-values of all subjects, outcomes of each subject at each number of samples."""
    tally, wholes = Tally(), {}
    for row in rows:
        kind, name, samples, _, _ = row["job"]
        if kind == "whole":
            wholes.setdefault((name, samples), Counter()).update(row["outcomes"])
        else:
            tally = tally.merged(Tally(Counter(row["counted"]), Counter(row["small"]), row["exact"], row["values"]))
    return tally, wholes


def main() -> None:
    """Write the page; exit 1 if a kind of check is outside its band or a right sampler did not pass."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--verdicts", type=int, default=100_000, help="p-values of each kind")
    parser.add_argument("--samples", type=int, default=4000, help="of one of these verdicts")
    parser.add_argument("--seeds", type=int, nargs=3, default=(330, 33, 1), help="at 10^5, 10^6 and 10^8 samples")
    parser.add_argument("--trials", type=int, default=1000, help="errors planted of each kind")
    parser.add_argument("--estimators", type=int, default=2000, help="whole verdicts on each estimator")
    parser.add_argument(
        "--log", type=Path, default=Path("build/calibration.jsonl"), help="parts done; those are not done again"
    )
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--page", type=Path, default=Path("docs/calibration.md"))
    arguments = parser.parse_args()
    rows = rows_of(arguments.verdicts, arguments.samples, arguments.seeds, arguments.log, arguments.workers)
    tally, wholes = gathered(rows)
    settings = (
        f"{sum(tally.counted.values())} p-values, of verdicts of {arguments.samples} samples on {len(SUBJECTS)} samplers and"
        f" five estimators; NumPy {np.__version__}, Python {platform.python_version()}."
    )
    resolutions, true = planted.section(arguments.trials, 30_000, fresh_seed() >> 2)
    estimators, kept = calibrate_estimators.section(arguments.estimators, arguments.samples, fresh_seed() >> 2)
    text = f"{page(tally, wholes, settings)}\n{resolutions}\n{estimators}"
    arguments.page.parent.mkdir(parents=True, exist_ok=True)
    arguments.page.write_text(text)
    print(text)
    failed = [name for (name, _), outcomes in wholes.items() if set(outcomes) - allowed(name)]
    sys.exit(1 if failed or outside(tally) or not (kept and true) else 0)


if __name__ == "__main__":
    main()
