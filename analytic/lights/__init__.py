"""What the oracle knows of each kind of light, one module a kind, found by name. Functions of a module:

    single_scattering  (medium, ray, light, *, shape, occluders, method, exact) -> a `Result` from a closed form or a proven rule,
                       or None where that does not apply
    beam               (light, ray, exact) -> a light without extent along rays, see `airlight.beam`
    incident           (light, x, nodes) -> a rule over the directions in which light with extent arrives, see `airlight.incident`
    extent             (light, ray) -> where the rays end at the light and where it changes along them, see `airlight.incident`

A module gives `beam`, or `incident`; then quadrature serves every medium and shape. The other two are optional.
"""
