"""The oracle for programs in any language: JSON requests in, reference values with error bounds out.

A request is an object with the key `quantity` and the arguments of that function of `fogproof.analytic`:

    {"quantity": "airlight_integral", "sigma_t": 0.5, "h": 1, "a": -2, "b": "inf", "phase": {"kind": "rayleigh"}}

Numbers may be nested lists, which broadcast. Infinite numbers, which JSON lacks, are the strings "inf" and "-inf".
"""

from fogproof.oracle.answers import PROTOCOL, answer, answer_text
from fogproof.oracle.json_schema import schema
from fogproof.oracle.limits import Limits
from fogproof.oracle.service import serve

__all__ = ["PROTOCOL", "Limits", "answer", "answer_text", "schema", "serve"]
