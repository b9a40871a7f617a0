"""Every test draws the same numbers whenever and beside whatever it runs, so that a red test is red for everybody.

The operating system's entropy is replaced by a stream that the test's own name starts; `pytest --fresh` leaves it as
it is, for looking whether a test passes by luck. Programs that a test starts draw their own seeds either way.

Property-based tests take as long as the machine needs: how slow an example is says nothing about whether it is right.
One that fails is made simpler for half a minute, not for the five that Hypothesis would take: a failure must be told soon.
"""

import contextlib
import random
import signal

import numpy as np
import pytest
from dask_cluster import cluster  # noqa: F401  # a fixture
from hypothesis import HealthCheck, settings
from hypothesis.internal.conjecture import engine

engine.MAX_SHRINKING_SECONDS = 30
for _name, _same in (("same", True), ("fresh", False)):
    settings.register_profile(_name, deadline=None, suppress_health_check=[HealthCheck.too_slow], derandomize=_same)


def pytest_addoption(parser):
    parser.addoption("--fresh", action="store_true", help="fogproof's own tests: draw every seed anew")


def pytest_configure(config):
    settings.load_profile("fresh" if config.getoption("fresh") else "same")


def pytest_report_header(config):
    return "seeds: " + ("fresh" if config.getoption("fresh") else "the same in every run; --fresh draws new ones")


@contextlib.contextmanager
def _entropy(config, name):
    """Let NumPy's fresh seeds and the module `random` follow from `name`."""
    if config.getoption("fresh"):
        yield
        return
    stream, bits, state = random.Random(name), np.random.bit_generator.randbits, random.getstate()
    np.random.bit_generator.randbits = stream.getrandbits
    random.seed(name)
    try:
        yield
    finally:
        np.random.bit_generator.randbits = bits
        random.setstate(state)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_make_collect_report(collector):
    # Some modules draw a seed when they are imported.
    with _entropy(collector.config, collector.nodeid):
        return (yield)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_runtest_protocol(item, nextitem):
    with _entropy(item.config, item.nodeid):
        return (yield)


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_fixture_setup(fixturedef, request):
    # What several tests share must not depend on which of them comes first.
    name = f"{fixturedef.baseid}::{fixturedef.argname}" + f"[{getattr(request, 'param_index', 0)}]"
    shared = fixturedef.scope != "function"
    with _entropy(request.config, name) if shared else contextlib.nullcontext():
        return (yield)


@pytest.fixture
def interruptible():
    """Let Ctrl-C be heard: where tests run in the background, a shell may have had it ignored."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
