"""Check a sampler written in C++: compile it, wrap two functions, ask for a verdict.

python examples/check_sampler_cpp.py [compiler flags, such as -DFLIPPED]
"""

import ctypes
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import fogproof

source = Path(__file__).with_name("sampler.cpp")
with tempfile.TemporaryDirectory() as folder:
    library = Path(folder) / "sampler.so"
    subprocess.run(["c++", "-O2", "-shared", "-fPIC", *sys.argv[1:], source, "-o", library], check=True)
    cpp = ctypes.CDLL(str(library))  # stays loaded when its file is gone


def call(function, n, *arrays):
    """Call a C function with a count and pointers to arrays of doubles."""
    pointers = [a.ctypes.data_as(ctypes.POINTER(ctypes.c_double)) for a in arrays]
    function(ctypes.c_size_t(n), *pointers)


def sample(u):
    """Map uniforms (n, 2) to directions (n, 3) and the density that the sampler claims."""
    u, x, pdf = np.ascontiguousarray(u), np.empty((len(u), 3)), np.empty(len(u))
    call(cpp.sample, len(u), u, x, pdf)
    return fogproof.Draw(x, pdf)


def pdf(x):
    """Return the density of directions x (n, 3) per steradian."""
    x, p = np.ascontiguousarray(x), np.empty(len(x))
    call(cpp.density, len(x), x, p)
    return p


verdict = fogproof.check_sampler(sample, pdf, fogproof.UnitSphere(), dimensions=2, axis=(0, 0, 1), mean_cosine=0.8)
print(verdict)
verdict.raise_unless_passed()
