"""How often do the checks reject what is right? p-values of every kind of check under the null, and whole verdicts.

    python tools/calibrate.py [--verdicts 100000] [--seeds 1000 100 3] [--workers 2] [--page docs/calibration.md]

Of each kind of check, at least `--verdicts` p-values of right subjects are counted at or below 1e-3. No kind may exceed the upper
end of its 99.9 % band, taken over all kinds together; exact kinds may not fall below the lower end either. Then right samplers are
checked whole at alpha = 1e-6, with `--seeds` seeds at 10^5, 10^6 and 10^8 samples: none may be rejected or inconclusive.
"""

from __future__ import annotations

import argparse
import platform
import sys
from collections import Counter
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from pathlib import Path

import calibrate_estimators
import numpy as np
import planted
from calibrate_subjects import RIGHT, SHARES, SUBJECTS, estimator_findings
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
    outcomes: Counter[str] = Counter()
    for i in range(seeds):
        verdict = check_sampler(
            subject.sample,
            subject.pdf,
            subject.domain,
            dimensions=subject.dimensions,
            atoms=subject.atoms,
            samples=samples,
            seed=seed + i,
        )
        outcomes[verdict.outcome] += 1
        if verdict.outcome != "not rejected":
            print(f"{name}: {verdict}", file=sys.stderr, flush=True)
    return outcomes


_PART = 1000  # verdicts of one task


def p_values(verdicts: int, samples: int, seed: int, pool: ProcessPoolExecutor) -> Tally:
    """Collect p-values, at least `verdicts` of every kind of check."""
    streams = np.random.SeedSequence(seed)
    jobs = [pool.submit(estimator_tally, size, samples, _seed(streams)) for size in _parts(verdicts)]
    for name in SUBJECTS:
        wanted = int(np.ceil(SHARES.get(name, 0.34) * verdicts))
        jobs += [pool.submit(sampler_tally, name, size, samples, _seed(streams)) for size in _parts(wanted)]
    total = Tally()
    for done, job in enumerate(jobs):
        total = total.merged(job.result())
        print(f"\r{done + 1}/{len(jobs)}", end="", file=sys.stderr, flush=True)
    print(file=sys.stderr)
    return total


def _parts(verdicts: int) -> list[int]:
    return [_PART] * (verdicts // _PART) + [verdicts % _PART] * (verdicts % _PART > 0)


def _seed(streams: np.random.SeedSequence) -> int:
    return int(streams.spawn(1)[0].generate_state(1, np.uint64)[0] >> np.uint64(2))


def main() -> None:
    """Write the page; exit 1 if a kind of check is outside its band or a right sampler did not pass."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--verdicts", type=int, default=100_000, help="p-values of each kind")
    parser.add_argument("--samples", type=int, default=4000, help="of one of these verdicts")
    parser.add_argument("--seeds", type=int, nargs=3, default=(1000, 100, 3), help="at 10^5, 10^6 and 10^8 samples")
    parser.add_argument("--trials", type=int, default=1000, help="errors planted of each kind")
    parser.add_argument("--estimators", type=int, default=2000, help="whole verdicts on each estimator")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--page", type=Path, default=Path("docs/calibration.md"))
    arguments = parser.parse_args()
    seed = fresh_seed()
    streams = np.random.SeedSequence(seed).spawn(1)[0]
    with ProcessPoolExecutor(arguments.workers) as pool:
        tally = p_values(arguments.verdicts, arguments.samples, seed, pool)
        jobs = {
            (name, samples): pool.submit(whole_verdicts, name, seeds, samples, _seed(streams))
            for samples, seeds in zip((10**5, 10**6, 10**8), arguments.seeds, strict=True)
            for name in RIGHT
            if seeds
        }
        wholes = {key: job.result() for key, job in jobs.items()}
    settings = (
        f"Verdicts of {arguments.samples} samples on {len(SUBJECTS)} samplers and five estimators; seed {seed};"
        f" NumPy {np.__version__}, Python {platform.python_version()}."
    )
    resolutions, true = planted.section(arguments.trials, 30_000, _seed(streams))
    estimators, kept = calibrate_estimators.section(arguments.estimators, arguments.samples, _seed(streams))
    text = f"{page(tally, wholes, settings)}\n{resolutions}\n{estimators}"
    arguments.page.parent.mkdir(parents=True, exist_ok=True)
    arguments.page.write_text(text)
    print(text)
    failed = [key for key, outcomes in wholes.items() if set(outcomes) - {"not rejected"}]
    sys.exit(1 if failed or outside(tally) or not (kept and true) else 0)


if __name__ == "__main__":
    main()
