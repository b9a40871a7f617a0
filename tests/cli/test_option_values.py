"""What no run could use is bad usage, before anything runs: never an outcome, never a fault."""

import pytest
from fuzz_commands import Run, here

from fogproof.checks.limits import isolated
from fogproof.errors import InvalidValueError
from fogproof.oracle.limits import Limits, within
from fogproof.pipe.process import Timeouts
from fogproof.workers.executors import open_workers

RENDERED = ["scene.toml", "--with", "true {scene} {out}", "-o", "none"]
TAKES = {
    ("verify", "fog/analog/haze"): ["--alpha", "--time-limit"],
    ("check", "--exec", "cat", "--spec", "none.toml"): [
        "--alpha",
        "--resolution",
        "--timeout",
        "--start-timeout",
        "--end-timeout",
    ],
    ("compare", "none.npy", "none.toml"): ["--alpha", "--tolerance"],
    ("render", *RENDERED): ["--alpha", "--tolerance", "--time-limit"],
    ("relations", *RENDERED): ["--alpha", "--tolerance", "--time-limit"],
    ("zoo", "none"): ["--alpha"],
    ("bench", "none"): ["--seconds"],
    ("oracle", "none.json"): ["--timeout"],
    ("golden", "none"): ["--timeout"],
}
NOBODY_CAN_USE = ["nan", "inf", "-1", "1e300", "a"]


@pytest.mark.parametrize(
    ("words", "option"), [(words, option) for words, options in TAKES.items() for option in options]
)
def test_numbers_that_no_run_can_use_are_bad_usage(tmp_path, monkeypatch, words, option):
    monkeypatch.chdir(tmp_path)
    bad = [*NOBODY_CAN_USE, *(["1e-320", "1"] if option == "--alpha" else [])]
    for value in bad if option != "--resolution" else set(bad) - {"1e300"}:
        end = here(Run([*words, f"{option}={value}"]))
        assert (end.code, end.out) == (2, b""), value
        assert f"Invalid value for '{option}': must be a number in".encode() in end.err
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("address", ["nosuch", "nosuch:", ":8786", "nosuch:port", ""])
def test_an_address_without_host_or_port_is_bad_usage(address):
    with pytest.raises(InvalidValueError, match="executor must be threads, processes or dask://host:port"):  # noqa: SIM117
        with open_workers(f"dask://{address}", 1):
            pass


def test_time_limits_that_no_system_waits_for_are_refused_or_none():
    for seconds in (0.0, float("nan"), float("inf"), 1e300):
        with pytest.raises(InvalidValueError, match=r"> 0 and at most 1e\+06 \[s\]"):
            Timeouts(answer=seconds)
        with pytest.raises(InvalidValueError, match=r"> 0 and at most 1e\+06 \[s\]"):
            isolated(int, seconds)
    for seconds in (1e7, 1e300, float("inf")):
        assert within(Limits(seconds=seconds).seconds, int) == 0
