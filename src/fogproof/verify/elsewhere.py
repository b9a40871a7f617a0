"""Cases of very many samples: drawn by processes or a cluster, and kept, so that a run goes on where it was."""

from __future__ import annotations

import hashlib
import json
import multiprocessing
import os
import re
from collections.abc import Iterable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from fogproof.catalogue import Case
from fogproof.catalogue.cases import SamplerCase
from fogproof.checks import Verdict, fresh_seed
from fogproof.checks.sampler_parts import SamplerCheck
from fogproof.checks.streams import BATCH
from fogproof.distributed import check_distributed, require_kept
from fogproof.errors import InvalidInputError
from fogproof.input_files import open_regular
from fogproof.verify.selection import whole
from fogproof.whole_files import write_file
from fogproof.workers.executors import open_workers

LEAST = 64 * BATCH
"""Samples of a case from which on others draw for it: fewer are there before a worker has started."""

SEED = "seed.json"
_SCHEMA = "fogproof seed 1"


@dataclass(frozen=True)
class Elsewhere:
    """Who draws for samplers of many samples.

    executor  "threads", "processes" or "dask://host:port"
    workers   threads or processes
    keep      folder in which what was drawn is kept, None for nowhere
    """

    executor: str
    workers: int
    keep: str | None = None

    def seed(self, seed: int | None) -> int | None:
        """Return the seed of the run whose samples are kept: the one that is there, or one that is put there."""
        if self.keep is None:
            return seed
        path = Path(self.keep) / SEED
        if not os.path.lexists(path):
            seed = fresh_seed() if seed is None else seed
            write_file(path, json.dumps({"schema": _SCHEMA, "seed": seed}) + "\n")
            return seed
        kept = _read_seed(path)
        if seed not in (None, kept):
            fix = f"leave --seed out, say --seed {kept}, or choose another folder"
            raise InvalidInputError(f"{self.keep} keeps samples of seed {kept}, not {seed}; {fix}", "--seed")
        return kept

    def require(self, cases: Iterable[Case]) -> None:
        """Refuse, before anything is drawn, a cluster that does not answer, and files that keep no samples."""
        with open_workers(self.executor, 1):
            pass
        for case in cases:
            if self.draws_for(case) and self.keep is not None and os.path.lexists(path := self._file(case.name)):
                require_kept(path)

    def _file(self, name: str) -> Path:
        return Path(self.keep or "") / _file_of(name)

    def draws_for(self, case: Case) -> bool:
        """Return whether a case is worth it; what an estimator draws is judged as it comes, in one process."""
        return isinstance(case, SamplerCase) and case.samples >= LEAST

    def verdict(self, case: Case, alpha: float, seed: int) -> Verdict:
        """Check a sampler in this process, and have others draw for it."""
        # multiprocessing lets a daemon start no processes, as it would leave them behind: ours end with whoever started them.
        multiprocessing.current_process()._config["daemon"] = False  # type: ignore[attr-defined]
        make = partial(_check_of, os.getcwd() if case.origin else "", case.origin, case.name, alpha, seed)
        keep = None if self.keep is None else self._file(case.name)
        return check_distributed(make, self.executor, workers=self.workers, keep=keep)


def _check_of(folder: str, origin: str, name: str, alpha: float, seed: int) -> SamplerCheck:
    case = case_of(folder, origin, name)
    assert isinstance(case, SamplerCase)
    return case.check(alpha, seed)


def case_of(folder: str, origin: str, name: str) -> Case:
    """Return the case of a name from its origin; a folder is where a relative one begins."""
    if folder:
        os.chdir(folder)  # the server of processes began somewhere else, maybe
    (case,) = (case for case in whole(origin) if case.name == name)
    return case


def _file_of(name: str) -> str:
    """Return a file's name for a case's: what can be read of it, and a digest of all."""
    digest = hashlib.blake2b(name.encode("utf-8", "surrogatepass"), digest_size=4).hexdigest()
    return f"{re.sub(r'[^0-9A-Za-z.-]+', '-', name)[:80]}-{digest}.json"


def _read_seed(path: Path) -> int:
    try:
        with open_regular(path, "the seed") as file:
            kept = json.loads(file.read(1 << 16))
        seed = kept["seed"]
        if kept["schema"] == _SCHEMA and type(seed) is int and seed >= 0:
            return seed
    except (ValueError, KeyError, TypeError, RecursionError):
        pass
    raise InvalidInputError(f"{path} is no seed of a run; choose another folder to keep samples in", str(path))
