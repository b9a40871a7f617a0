"""Right subjects: every sampler and estimator of the catalogue that needs no other program. A check that rejects one is wrong."""

from __future__ import annotations

from dataclasses import replace

from fogproof.catalogue import EstimatorCase, all_cases
from fogproof.zoo.bug import Bug


def bugs() -> list[Bug]:
    """Return them, as bugs without an error."""
    found = []
    for case in all_cases():
        if case.expected == "rejected" or case.needs:
            continue
        most = case.samples if isinstance(case, EstimatorCase) else 0
        name = f"right/{case.name}"
        found.append(Bug(name, case.title, case.name, (), replace(case, name=name, twin=None), most=most))
    return found
