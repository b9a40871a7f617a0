"""The command line. Machine-readable output goes to stdout, what is for people to stderr.

Exit codes: 0 every outcome as expected, 1 something rejected, 3 nothing rejected but something inconclusive, 2 usage or bad input;
docs/command-line.md has all of them.
"""

from fogproof.cli.commands import main

__all__ = ["main"]
