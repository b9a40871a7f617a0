"""What the estimators know of each kind of light, one module a kind, found by name. Functions of a module:

    illumination  (light, ray) -> what a light with one direction a point sends to the points of a ray, see `Illumination`
    towards       (light, x) -> unit vectors (3, n) from points x (3, n) to such a light
    sample        (light, x, u) -> a direction to a light with extent from each point, from uniforms u (n, 2), see `Sampled`
    focus         (light) -> the point about which equiangular sampling is done; lights from infinitely far have none
    breadth       (light) -> how far from there that makes no difference [m], 0 for a point
    met           (light, origin, direction) -> the distance at which a ray meets an opaque light [m]
    lamp          (light) -> the light for path tracing kernels

A module gives `illumination` and `towards`, or `sample`; the others where there is something to give.
"""
