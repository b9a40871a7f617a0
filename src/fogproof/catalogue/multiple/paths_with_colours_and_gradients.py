"""Path tracing where the medium has colours or changes from place to place."""

from __future__ import annotations

import numpy as np

from fogproof import analytic
from fogproof.catalogue.cases import EstimatorCase
from fogproof.catalogue.multiple.builders import (
    ABOVE,
    ASIDE,
    BLACK,
    BOX,
    SKY,
    SLAB,
    SUN,
    SUNLIGHT,
    VIEW,
    literal,
    paths_case,
    times,
)
from fogproof.estimators import (
    PathTracer,
    SpectralPathTracer,
)
from fogproof.scene import HenyeyGreenstein, LinearMedium, Medium, VoxelGrid


def cases() -> list[EstimatorCase]:
    """Return the cases of colours and gradients."""
    coloured = Medium((0.1, 0.2, 0.05), (0.4, 1.0, 2.0))
    thinning = LinearMedium(2.0, (0.0, 0.0, 1.8), 0.9)
    tau = 2.0 - 1.8 / 2
    sigma = np.random.default_rng(11).random((4, 5, 6)) * 3
    voxels = VoxelGrid(sigma, (-1, -1, -1), (1, 1, 1), "trilinear", 1.0, HenyeyGreenstein(0.5))
    return [
        paths_case(
            name="slab/colours",
            title="Slab of three colours, one path for all",
            make=lambda: SpectralPathTracer(coloured, SLAB, ABOVE, SKY, BLACK),
            reference=lambda: analytic.slab_reflectance(coloured.albedo, coloured.sigma_t, VIEW),
            oracle="slab_reflectance",
            error="the wrong channel's pdf: that of the first, whichever was drawn",
            twin=lambda: literal(medium=coloured, first_channel=True),
            source="Wilkie et al. 2014, Hero wavelength spectral sampling",
        ),
        paths_case(
            name="slab/gradient",
            title="Slab that thins out downwards, by delta and ratio tracking",
            make=lambda: PathTracer(thinning, SLAB, ABOVE, SUNLIGHT),
            reference=lambda: times(analytic.slab_brdf(0.9, tau, SUN, VIEW), SUN),
            oracle="slab_brdf",
            error="the extinction at the top is taken for that of the whole slab",
            twin=lambda: PathTracer(Medium(0.2, 1.8), SLAB, ABOVE, SUNLIGHT),
            source="Woodcock et al. 1965; Novák et al. 2014",
        ),
        paths_case(
            name="box/voxels",
            title="White furnace: a voxel grid of albedo 1",
            make=lambda: PathTracer(voxels, BOX, ASIDE, SKY),
            reference=lambda: analytic.white_furnace(voxels, ASIDE),
            oracle="white_furnace",
            error="a twentieth of the scattering is lost",
            twin=lambda: PathTracer(
                VoxelGrid(sigma, (-1, -1, -1), (1, 1, 1), "trilinear", 0.95, HenyeyGreenstein(0.5)), BOX, ASIDE, SKY
            ),
            source="Woodcock et al. 1965; Novák et al. 2014",
            samples=200_000,
        ),
    ]
