"""Cases against their references: choosing them, running them, and the record of the run."""

from fogproof.verify.records import ALPHA, SCHEMA, environment, record, reproduce
from fogproof.verify.results import Result, TwinResult, code_of, exit_code, status_of
from fogproof.verify.running import case_seed, run, run_case
from fogproof.verify.selection import select, shares

__all__ = [
    "ALPHA",
    "SCHEMA",
    "Result",
    "TwinResult",
    "case_seed",
    "code_of",
    "environment",
    "exit_code",
    "record",
    "reproduce",
    "run",
    "run_case",
    "select",
    "shares",
    "status_of",
]
