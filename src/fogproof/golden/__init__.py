"""Golden tables: reference values with error bounds and conventions, as files for test suites that run without fogproof."""

from fogproof.golden.c_header import to_c
from fogproof.golden.entries import Entry, Row, golden_entries, rows_of
from fogproof.golden.files import to_csv, to_json_document, to_npz

__all__ = ["Entry", "Row", "golden_entries", "rows_of", "to_c", "to_csv", "to_json_document", "to_npz"]
