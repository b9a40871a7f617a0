"""Multiple scattering with exact answers: slab, half space, ball, infinite medium, rod."""
