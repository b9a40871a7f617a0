"""What kind of error is it? Named hypotheses are tried on samples; the likeliest is told, with how much it leaves unexplained."""

from fogproof.checks.diagnosis.causes import CAUSES, likely_cause
from fogproof.checks.diagnosis.diagnose import diagnosed

__all__ = ["CAUSES", "diagnosed", "likely_cause"]
