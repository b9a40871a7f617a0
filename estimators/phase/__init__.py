"""Phase functions to draw from: a module for each kind of `fogproof.scene.phase`, with its sampler and its value.

A module `<kind>.py` gives, of the kind's parameters `phase` and in the precision of their arrays:

    polar(phase, xi)                      (n,) uniforms in [0, 1) -> `Polar`: every kind must have it, and
    density(phase, versine, coversine)    (n,) 1 - mu and 1 + mu -> (n,) [1/sr]
    cosines(phase, xi, out)               (n,) uniforms -> the forward cosines mu alone, written to `out`
    table(phase)                          the phase function `polar` has the density of, where that is not `phase` itself
    lobe(phase)                           what compiled kernels draw from, `fogproof.estimators.kernels.path_data`
    parts(phase)                          for a weighted mean of other kinds: their weights and they; then nothing else is needed

`polar` and `cosines` invert the cdf of mu, where they do not choose between two lobes first. Without `cosines` they come
from `polar`; without `lobe` kernels draw from a table of the density, `tabulated_lobe`.
"""
