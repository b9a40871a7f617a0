"""Why an image is off: named hypotheses, each of which says what the image would be then, fitted and compared.

A module a family of causes; each gives `hypotheses(sight)`. A hypothesis is believed where it explains nearly all of the misfit,
and among those that do the simplest wins. What is said is its fit and how much it leaves.
"""

from __future__ import annotations

from fogproof.images.causes.explanation import diagnose

__all__ = ["diagnose"]
