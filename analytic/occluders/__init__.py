"""What the oracle knows of each kind of occluder, one module a kind, found by name. Functions of a module:

    from_point      (occluder, origin, d, light, margin) -> the interval of each ray that it hides from a point, NaN if none
    from_direction  (occluder, origin, d, travel, margin) -> the same in parallel light

Distances are counted from the origin of the ray; `margin` (n,) is how much larger the occluder is taken.
"""
