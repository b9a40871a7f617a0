"""What the oracle knows of each kind of shape that holds a medium, one module a kind, found by name. Functions of a module:

    faces           (shape) -> normals (k, 3) and offsets (k,) of a polyhedron: x is inside where every normal . x <= offset
    through         (shape, origin, direction, margin) -> where lines enter and leave, see `convex_shapes.through`
    size            (shape) -> the largest coordinate that the shape is given by
    mean_chord      (shape) -> 4 V/S [m]
    parallel_light  (shape, ray, travel, sigma, start, end, owner, enter) -> see `lights.directional`
    environment     (shape, phase, origin, d, sigma, start, end, fine) -> see `lights.environment`

A module gives `faces` or `through`. Without the others lights are integrated by quadrature, and 4 V/S is refused.
"""
