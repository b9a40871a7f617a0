"""Radiance along rays from the differential form of the radiative transfer equation.

    dL/dz = -sigma_t L + sigma_s L_i + sigma_a L_e,     L = L_bg at the surface, z from there to the camera

solved as an initial value problem: a way to the same numbers that knows neither tau nor an exponential.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from fogproof.analytic.arithmetic.error_free import EPS
from fogproof.analytic.declaration import RADIANCE, RAY, quantity
from fogproof.analytic.geometry.rays import channels_of
from fogproof.analytic.media.breakpoints import breakpoints
from fogproof.analytic.media.coefficients import coefficients
from fogproof.analytic.rays.radiance_by_quadrature import source_term
from fogproof.contracts import Reference
from fogproof.errors import UnsupportedError
from fogproof.scene import Ray
from fogproof.scene.arrays import ChannelArray
from fogproof.scene.media import AnyMediumField
from fogproof.validate import nonnegative_channels

LOOSE, TIGHT = 1e-10, 1e-12
"""Relative tolerances of the two runs whose difference is the error estimate."""

EVALUATIONS = 30_000
"""Most looks at the medium in one piece of one ray: an explicit solver needs about two for each optical depth."""


@quantity(
    unit=RADIANCE,
    convention="in-scattered radiance constant along the ray; a third way to ambient_fog and emitted_radiance",
    source="Chandrasekhar 1960, Radiative Transfer, section 6, eq. 47; Hairer, Norsett & Wanner 1993, section II.5",
    example={
        "medium": {"kind": "exponential", "sigma_0": 0.3, "rate": [0, 0, -0.5], "albedo": 0.9, "emission": 2},
        "ray": {**RAY, "length": 5},
        "ambient": 0.5,
        "background": 3,
    },
)
def radiance_by_ode(
    medium: AnyMediumField,
    ray: Ray,
    ambient: ChannelArray = 0.0,
    background: ChannelArray = 0.0,
    *,
    times_sigma_a: bool = True,
) -> Reference:
    """Return the radiance at the camera [W/(m^2 sr)], shape R or R + (channels,); arguments as `radiance_by_quadrature`.

    With background 1 and nothing else it is the transmittance.
    Error: estimated from two runs of the Dormand-Prince method of order 8 with tolerances 1e-10 and 1e-12, and what
    the rounding of places means at the breaks.
    Source: Chandrasekhar 1960, Radiative Transfer, section 6, eq. 47; Hairer, Norsett & Wanner 1993, section II.5.
    """
    ambient = nonnegative_channels("ambient", ambient, "W/(m^2 sr)")
    background = nonnegative_channels("background", background, "W/(m^2 sr)")
    channels = channels_of(medium, ambient=ambient, background=background)
    source, edges = source_term(ambient, times_sigma_a), breakpoints(medium, ray)
    detail = getattr(medium, "detail", None)
    rows = (1,) if channels is None else (channels,)
    start = np.broadcast_to(np.asarray(background, float), rows)
    runs, lost = np.zeros((2, len(edges), *rows)), np.zeros((len(edges), *rows))
    for i, (origin, direction) in enumerate(zip(ray.origin.reshape(-1, 3), ray.direction.reshape(-1, 3), strict=True)):

        def slope(z: float, L: np.ndarray, o: np.ndarray = origin, w: np.ndarray = direction) -> np.ndarray:
            local = coefficients(medium, o - z * w, w, rows[0] if channels else None)
            return source(local) - local.sigma_t * L

        for run, tolerance in enumerate((LOOSE, TIGHT)):
            runs[run, i], lost[i] = _march(slope, edges[i], start, tolerance, float(np.abs(origin).max()), detail)
    shape = ray.shape if channels is None else (*ray.shape, channels)
    value, error = runs[1], np.abs(runs[1] - runs[0]) + TIGHT * np.abs(runs[1]) + lost + 1e-300
    return Reference(
        value.reshape(shape), error.reshape(shape), "RTE as an ODE, Dormand-Prince 8", "Chandrasekhar 1960"
    )


def _march(
    slope: Any, edges: np.ndarray, start: np.ndarray, tolerance: float, reach: float, detail: float | None
) -> tuple[np.ndarray, np.ndarray]:
    """Integrate from the far end to the camera, from break to break: z = -t; steps no longer than the detail, if that is given.

    Return the radiance, and what the breaks cost: each is off by the rounding of a place at that distance. A medium with a detail
    may jump where nobody says so, which two runs do not tell: every step then costs the tolerance it was taken with.
    """
    from scipy.integrate import DOP853

    L, lost = start, np.zeros_like(start)
    for far, near in zip(edges[:0:-1], edges[-2::-1], strict=True):
        # A step ends strictly inside its piece, so that the solver never looks across a break.
        inset = 4 * EPS * far
        if far - near <= 4 * inset:
            continue
        # Relative tolerances alone: a transmittance of 1e-30 is to be as accurate as one of 1. The first step is given
        # because the solver's own guess divides by them, and L may begin at 0.
        span = far - near - 2 * inset
        longest = np.inf if detail is None else detail
        first = min(span / 64, longest)
        solver = DOP853(
            slope, -far + inset, L, -near - inset, rtol=tolerance, atol=1e-290, first_step=first, max_step=longest
        )
        while solver.status == "running":
            solver.step()
            if detail is not None:
                lost = lost + tolerance * np.abs(solver.y)
            if solver.nfev > EVALUATIONS:
                break
        if solver.status != "finished":
            raise UnsupportedError("the ray is too thick for the ODE solver: use radiance_by_quadrature", "ray")
        off = 2 * inset + 4 * EPS * (reach + far)
        lost = lost + off * (np.abs(slope(-far + inset, L)) + np.abs(slope(-near - inset, solver.y)))
        L = solver.y
    return L, lost
