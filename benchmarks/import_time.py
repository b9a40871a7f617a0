"""How long `import fogproof` takes, as a ratio to `import numpy`, in interleaved fresh processes.

python benchmarks/import_time.py
"""

from __future__ import annotations

import statistics
import subprocess
import sys
import time


def seconds(code: str) -> float:
    """Return the wall time of a fresh interpreter that runs `code`, less its start."""
    script = f"import time; t = time.perf_counter(); {code}; print(time.perf_counter() - t)"
    return float(subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout)


def main() -> None:
    """Print the median ratio of interleaved pairs and its quartiles."""
    ratios = []
    started = time.perf_counter()
    for _ in range(25):
        numpy = seconds("import numpy")
        ratios.append(seconds("import fogproof") / numpy)
    low, middle, high = statistics.quantiles(ratios, n=4)
    print(f"import fogproof / import numpy: {middle:.2f} (quartiles {low:.2f} and {high:.2f}, 25 interleaved pairs,")
    print(f"{time.perf_counter() - started:.0f} s)")


if __name__ == "__main__":
    main()
