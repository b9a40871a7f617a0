"""Convergence studies: speed against error, in pieces that survive interruptions and run anywhere with the same bits.

`read_study` reads what is measured, `run_study` measures it in a folder, resuming what is there, and returns the record.
"""

from fogproof.study.conduct import run_study
from fogproof.study.files import Study, StudyScene, read_study
from fogproof.study.store_faults import StoreError

__all__ = ["StoreError", "Study", "StudyScene", "read_study", "run_study"]
