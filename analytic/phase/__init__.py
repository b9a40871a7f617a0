"""Phase functions: a module for each kind of `fogproof.scene.phase`, with what the oracle knows of it.

A module `<kind>.py` gives, of the kind's parameters `phase`, with SOURCE and METHOD:

    pdf(phase, mu)                  f(mu) [1/sr], and its error: the only one that every kind must have
    density(phase, x, y)            the same where (1 - mu)/2 = x and (1 + mu)/2 = y, if that keeps digits near the poles
    cdf(phase, mu)                  2 pi int_-1^mu f, and its error
    quantile(phase, xi)             the inverse, and its error
    mean_cosine(phase)              2 pi int f mu dmu, and its error
    legendre_moments(phase, count)  2 pi int f P_l dmu for l = 0 … count, and their errors
    kinks(phase)                    cosines where f is not smooth
    airlight(phase)                 4 pi f as the airlight integral sees it, `fogproof.analytic.airlight.phase`
    ball(phase, mu, analytic)       4 pi f at a complex ball of cosines
    peak(phase, mu)                 an upper bound of 4 pi f at cosines up to the ball mu
    parts(phase)                    for a weighted mean of other kinds: their weights and they; then nothing else is needed

What a kind does not give comes from its pdf by quadrature (`fallback`), with an error that counts what was missed;
only `ball` and `peak` have no stand-in: nothing is proven then.
"""
