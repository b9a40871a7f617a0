"""The laws of scipy.stats: their quantile functions as samplers, their densities as claims."""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from fogproof.catalogue.cases import SamplerCase
from fogproof.catalogue.outsiders.subjects import Outsider, case
from fogproof.domains import Discrete, Domain, HalfLine, Interval, RealLine

CONTINUOUS: dict[str, tuple[tuple[float, ...], ...]] = {
    "alpha": ((3.57,),), "anglit": ((),), "arcsine": ((),), "beta": ((2.31, 0.627), (0.5, 0.5), (0.1, 0.1), (40, 3)),
    "betaprime": ((5, 6),), "bradford": ((0.299,),), "burr": ((10.5, 4.3),), "burr12": ((10, 4),), "cauchy": ((),),
    "chi": ((78,),), "chi2": ((55,), (0.5,)), "cosine": ((),), "crystalball": ((2.0, 3.0),), "dgamma": ((1.1,), (0.4,)),
    "dweibull": ((2.07,), (0.6,)), "erlang": ((10,),), "expon": ((),), "exponpow": ((2.697,),), "exponweib": ((2.89, 1.95),),
    "f": ((29, 18), (1, 1)), "fatiguelife": ((29,),), "fisk": ((3.08,), (0.3,)), "gamma": ((1.99,), (0.1,), (0.01,)),
    "genextreme": ((-0.1,), (0.5,)), "gengamma": ((4.41, 3.11),), "genhalflogistic": ((0.77,),), "genlogistic": ((0.41,),),
    "gennorm": ((1.3,), (0.3,)), "genpareto": ((0.1,), (5.0,), (-0.5,)), "gibrat": ((),), "gompertz": ((0.947,),),
    "gumbel_l": ((),), "gumbel_r": ((),), "halfcauchy": ((),), "halfgennorm": ((0.675,),), "halflogistic": ((),),
    "halfnorm": ((),), "hypsecant": ((),), "invgamma": ((4.06,), (0.2,)), "invweibull": ((10.6,), (0.3,)),
    "jf_skew_t": ((8, 4),), "johnsonsb": ((4.31, 3.18),), "johnsonsu": ((2.55, 2.25),), "kappa3": ((1.0,),),
    "laplace": ((),), "laplace_asymmetric": ((2.0,),), "levy": ((),), "levy_l": ((),), "loggamma": ((0.414,),),
    "logistic": ((),), "loglaplace": ((3.25,), (0.3,)), "lognorm": ((0.954,), (5.0,)), "loguniform": ((0.01, 1.25),),
    "lomax": ((1.88,), (0.2,)), "maxwell": ((),), "mielke": ((10.4, 4.6),), "moyal": ((),), "nakagami": ((4.97,), (0.1,)),
    "norm": ((),), "pareto": ((2.62,), (0.1,), (0.3,), (0.5,)), "powerlaw": ((1.66,), (0.05,)),
    "powerlognorm": ((2.14, 0.446),), "powernorm": ((4.45,),), "rayleigh": ((),), "rdist": ((1.6,),), "rice": ((0.775,),),
    "semicircular": ((),), "skewcauchy": ((0.5,),), "t": ((2.74,), (0.3,), (0.5,)), "trapezoid": ((0.2, 0.8),),
    "triang": ((0.158,),), "truncexpon": ((4.69,),), "truncnorm": ((-0.1, 2.0),), "truncpareto": ((2.0, 5.3),),
    "truncweibull_min": ((2.5, 0.25, 1.75),), "tukeylambda": ((3.13,),), "uniform": ((),), "weibull_max": ((2.87,),),
    "weibull_min": ((1.79,), (0.2,)), "wrapcauchy": ((0.031,),),
}  # fmt: skip
"""Names of scipy.stats and the parameters of each case; laws whose quantiles take more than 10 microseconds are left out."""

DISCRETE: dict[str, tuple[float, ...]] = {
    "poisson": (17.3,),
    "geom": (0.03,),
    "nbinom": (5, 0.1),
    "logser": (0.9,),
    "planck": (0.51,),
    "binom": (40, 0.3),
    "zipfian": (1.25, 1000),
    "boltzmann": (1.4, 19),
}

DEFAULT = {"cauchy", "pareto/0.3", "gamma/0.1", "poisson/17.3"}
"""Those that run without being asked for by name."""


_POLE = "a pole so strong that rounding gathers samples on it: what the pdf is there cannot be told"


def domain_of(law: Any) -> Domain:
    """Return the domain of a frozen continuous law."""
    low, high = (float(end) for end in law.support())
    if math.isfinite(low):
        return Interval(low, high) if math.isfinite(high) else HalfLine(low)
    return RealLine()


def _inner(u: np.ndarray) -> np.ndarray:
    """Return uniforms moved to the middle of their steps, so that no quantile is at an infinite end."""
    return np.asarray(u[:, 0] * (1 - 2.0**-50) + 2.0**-51)


def _quietly(f: Callable[[np.ndarray], np.ndarray], x: np.ndarray) -> np.ndarray:
    with np.errstate(all="ignore"):
        return np.asarray(f(x))


def continuous(name: str, parameters: tuple[float, ...]) -> Outsider:
    """Return one continuous law as an outsider; what it returns beyond an end of its support by rounding is put there."""
    from scipy import stats

    law = getattr(stats, name)(*parameters)
    low, high = law.support()
    sample = lambda u: np.clip(_quietly(law.ppf, _inner(u)), low, high)  # noqa: E731
    return Outsider(sample, partial(_quietly, law.pdf), domain_of(law), 1)


def discrete(name: str, parameters: tuple[float, ...]) -> Outsider:
    """Return one law of whole numbers as an outsider."""
    from scipy import stats

    law = getattr(stats, name)(*parameters)
    high = law.support()[1]
    domain = Discrete(int(high) + 1 if math.isfinite(high) else math.inf)
    return Outsider(lambda u: _quietly(law.ppf, _inner(u)), partial(_quietly, law.pmf), domain, 1)


POLES = {"beta/0.1-0.1", "gamma/0.01"}
"""Laws with poles so strong that rounding gathers samples on them."""


def cases() -> list[SamplerCase]:
    """Return one case a law and set of parameters."""
    found = []
    named: list[tuple[str, tuple[float, ...], Callable[[str, tuple[float, ...]], Outsider]]] = [
        (name, parameters, continuous) for name, several in CONTINUOUS.items() for parameters in several
    ]
    named += [(name, parameters, discrete) for name, parameters in DISCRETE.items()]
    for name, parameters, make in named:
        numbers = "-".join(f"{p:g}" for p in parameters)
        label = f"{name}/{numbers}" if parameters else name
        title = f"scipy.stats.{name}({', '.join(f'{p:g}' for p in parameters)})"
        make_it = partial(make, name, parameters)
        more = {"expected": "inconclusive", "reason": _POLE} if label in POLES else {}
        found.append(case(f"laws/{label}", title, make_it, "scipy.stats", label not in DEFAULT, **more))
    return found
