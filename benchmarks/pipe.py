"""What the pipe costs: 10^7 Henyey-Greenstein samples of the C++ example judged over a pipe, and judged in-process.

Both runs judge the same C++ functions of the same uniforms; in-process they are called through ctypes. The share of the pipe is
1 - in-process / over the pipe of the processor times of all processes, the verdict included, of interleaved runs.

    python benchmarks/pipe.py [SAMPLES] [RUNS]
"""

from __future__ import annotations

import ctypes
import resource
import statistics
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from fogproof import Draw, UnitSphere, check_sampler
from fogproof.input_files import read_toml
from fogproof.pipe.check import Settings, check_program
from fogproof.pipe.spec import spec_of
from fogproof.pipe.truth import truth_of

EXAMPLE = Path(__file__).resolve().parents[1] / "examples" / "pipe"
# The example's own sampler behind two C functions over arrays.
WRAPPER = """
#define main unused_main
#include "hg.cpp"
static const HenyeyGreenstein hg{fogproof::Parameters("")};
extern "C" void sample(std::size_t n, const double* u, double* rows) {
    for (std::size_t i = 0; i < n; ++i) hg.sample(u + 2 * i, rows + 4 * i);
}
extern "C" void density(std::size_t n, const double* x, double* pdf) {
    for (std::size_t i = 0; i < n; ++i) pdf[i] = hg.pdf(x + 3 * i);
}
"""


def processor_time() -> float:
    """Return the seconds that this process and its ended children have computed, in user and system."""
    used = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(each.ru_utime + each.ru_stime for each in used)


def pointer(array: np.ndarray) -> ctypes.c_void_p:
    """Return where the numbers of an array stand."""
    return ctypes.c_void_p(array.ctypes.data)


def main(samples: int = 10_000_000, runs: int = 3) -> None:
    """Print the times of each pair of runs and the median share of the pipe."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "wrapper.cpp").write_text(WRAPPER)
        flags = ["c++", "-O2", "-std=c++17", f"-I{EXAMPLE / 'cpp'}"]
        subprocess.run([*flags, EXAMPLE / "cpp" / "hg.cpp", "-o", folder / "hg"], check=True)
        subprocess.run([*flags, "-shared", "-fPIC", folder / "wrapper.cpp", "-o", folder / "hg.so"], check=True)
        cpp = ctypes.CDLL(str(folder / "hg.so"))

        def sample(u: np.ndarray) -> Draw:
            rows = np.empty((len(u), 4))
            cpp.sample(ctypes.c_size_t(len(u)), pointer(np.ascontiguousarray(u)), pointer(rows))
            return Draw(rows[:, :3], rows[:, 3])

        def pdf(x: np.ndarray) -> np.ndarray:
            x, p = np.ascontiguousarray(x), np.empty(len(x))
            cpp.density(ctypes.c_size_t(len(x)), pointer(x), pointer(p))
            return p

        spec = EXAMPLE / "hg.toml"
        truth = truth_of(spec_of(read_toml(spec, "the spec file"), str(spec)), "float64")
        options = {"axis": truth.axis, "mean_cosine": truth.mean_cosine, "reference": truth.density}
        shares = []
        for seed in range(runs):
            started = processor_time()
            piped = check_program(str(folder / "hg"), spec, Settings(samples=samples, seed=seed)).verdict
            middle = processor_time()
            inside = check_sampler(sample, pdf, UnitSphere(), dimensions=2, samples=samples, seed=seed, **options)
            over, within = middle - started, processor_time() - middle
            assert piped.samples == inside.samples == samples
            assert piped.outcome == inside.outcome == "not rejected"
            shares.append(1 - within / over)
            print(f"over the pipe {over:.2f} s, in-process {within:.2f} s: the pipe's share is {shares[-1]:.1%}")
    print(f"median share of the pipe over {runs} runs of {samples} samples: {statistics.median(shares):.1%}")


if __name__ == "__main__":
    main(*map(int, sys.argv[1:]))
