"""A cause on a line is a law that can be integrated: the samples are held to it without points of a known law beside them.

Those make every density comparable, and cost most of the information; one that explains nearly all may still be another law than
the samples', and the check itself would say so.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fogproof.checks.claim import claimed
from fogproof.checks.density.charts import chart_of
from fogproof.checks.density.rounding import Rounded
from fogproof.checks.diagnosis.contrast import Contrast, Density
from fogproof.checks.statistics.smooth import COMPONENTS, smooth
from fogproof.checks.subject import Subject

_CHANCE = 1e-4  # a p-value: a cause is worth less than a verdict
_PILOT = 4096  # samples that place the quadrature


def left_on_a_line(subject: Subject, contrast: Contrast, density: Density) -> float:
    """Return the log-likelihood that smooth corrections of a density add, if that is no chance; 0 elsewhere than on a line.

    density  of the samples x of the contrast, up to a constant

    Half the statistic of Neyman's smooth test (1937), less its mean.
    """
    x, none = contrast.x, contrast.x[:0]
    chart = chart_of(subject.domain, x[:_PILOT], None)
    if chart is None or len(chart.axes) > 1 or subject.precision == "float32" or not contrast.whole:
        return 0.0
    law = replace(subject, pdf=density)
    claim = claimed(law, chart, x[:_PILOT], len(x), Rounded(none, [], None, subject.roundoff))
    if claim.doubt:
        return 0.0
    marginal = claim.grid.marginals[0]
    counts = np.bincount(marginal.lookup(chart.count(x)[0]), minlength=len(marginal.mass))
    found = smooth("a named law", marginal, counts, _CHANCE)
    return 0.5 * (found.statistic - COMPONENTS) if found.outcome == "rejected" and found.statistic else 0.0
