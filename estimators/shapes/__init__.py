"""What the estimators know of each kind of shape that holds a medium, one module a kind, found by name. Functions of a module:

    through    (shape, x, w) -> distances (n,) at which lines from x (3, n) along w (3, n) enter and leave it
    region     (shape) -> the shape for path tracing kernels
    farthest   (shape, direction) -> points (k, 3) among which is the one farthest along a direction (3,), None if there is none
    entrances  (shape, rng, n) -> points uniform on its boundary and the normals out of it there, (n, 3) each

Only `through` has to be there. What another lacks is refused by name.
"""
