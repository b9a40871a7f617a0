"""How random walks meet each kind of ground, one module a kind, found by name. Functions of a module:

reflect(ground, mu0, u)  directions into which it sends light that came down at cosines mu0 (n,), from uniforms u (n, 3):
                         their cosines mu (n,), azimuths to the way down [rad] (n,) and weights in [0, 1] (n,)
value(ground, mu0, mu, azimuth)  its BRDF [1/sr]
"""

ROOM = "fogproof.estimators.grounds"
