"""What single scattering is told as."""

from __future__ import annotations

import numpy as np

Result = tuple[np.ndarray, np.ndarray, str, str]
"""Radiance (n, channels) along flattened rays, its error, method and source."""
