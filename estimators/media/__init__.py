"""What trackers and samplers need of each kind of medium, one module a kind; found by name, see `fogproof.scene.kinds`.

A module gives what it can of

    kernel_data(medium)                        plain data for compiled loops, whose type has a static method `extinction`
    extinction(medium, x, w)                   the same as an array function, (k, channels) [1/m]; needed only without kernel data
    along(medium, ray)                         the extinction along one ray with its optical depth, see `free_paths.extinction`
    depth(medium, ray, t)                      optical depth to the distances t, (n, channels)
    depth_towards(medium, x, w, way)           optical depth of many ways and what they cost, for shadow rays
    bounds(medium, origin, direction, length)  least and greatest extinction along each ray [1/m]
    greatest(medium, shape)                    bound of the extinction in a shape [1/m]
    feature_size(medium, ray)                  the smallest length over which it changes along a ray [m]; without it, `along` or
                                               `depth` nothing integrates along a camera ray, as single scattering asks
    walk(medium, ...)                          through its cells, see `tracking.regular`

What it does not give comes from tracking under a majorant, from quadrature, or is refused by name.
"""

ROOM = "fogproof.estimators.media"
