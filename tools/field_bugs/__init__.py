"""Bugs that shipped, planted: each must be rejected, and its cause named."""

from field_bugs import directions, paths, positions, streams, tables
from field_bugs.bug import Bug

BUGS: list[Bug] = [*directions.BUGS, *paths.BUGS, *positions.BUGS, *tables.BUGS, *streams.BUGS]
