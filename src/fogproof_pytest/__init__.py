"""The pytest plugin of fogproof: a fixture `fogproof` whose checks share one false-alarm probability for the whole session.

    def test_my_sampler(fogproof):
        fogproof.check_sampler(my.sample, my.pdf, fogproof.UnitSphere(), dimensions=2)

The test fails if the verdict is rejected, and if it is inconclusive unless it has the mark `fogproof(inconclusive="pass")`.
Nothing but pytest is imported here: fogproof itself is loaded by the first test that asks for the fixture.
PYTEST_DONT_REWRITE: there are no assertions here, and `entry_point` has this package loaded before pytest could look at it.
"""

from __future__ import annotations

import atexit
import math
import os
import secrets
import sys
from collections import deque
from collections.abc import Callable, Generator, Iterator
from functools import partial
from pathlib import Path
from typing import Any

import pytest

from fogproof_pytest import crashes
from fogproof_pytest.expected import expected

ALPHA = 1e-6
"""False-alarm probability of a session, unless told otherwise."""

_SEED, _ALPHA, _WEIGHTS = pytest.StashKey[int](), pytest.StashKey[float](), pytest.StashKey[float]()
_NEWS, _LATE = pytest.StashKey[deque[tuple[Any, ...]]](), pytest.StashKey[list[Any]]()
"""What checks have found and no report has told yet; and what came after the last report. See `checks`."""
_CRASHED = pytest.StashKey[list[Any]]()
"""Reports of tests in which a worker of xdist ended."""
_SESSION = pytest.StashKey[pytest.Session]()
_FAILED, _USAGE, _NOTHING = 1, 4, 5  # pytest.ExitCode
_MARKER = (
    "fogproof(weight=1, calls=None, inconclusive='fail'): this test's share of the session's false-alarm probability relative to "
    "other tests; how many checks share it equally (None: the k-th gets 1/(k (k + 1)) of it); whether an inconclusive verdict "
    "fails or passes"
)


def pytest_addoption(parser: pytest.Parser) -> None:
    """Declare the options."""
    group = parser.getgroup("fogproof", "verification of samplers and estimators")
    group.addoption("--fogproof-seed", type=int, metavar="N", help="seed of every check; a fresh one by default")
    group.addoption(
        "--fogproof-alpha",
        type=float,
        default=ALPHA,
        metavar="P",
        help="false-alarm probability of the session (%(default)g)",
    )
    group.addoption("--fogproof-report", metavar="DIR", help="write all verdicts as a page, figures and results.json")


def pytest_configure(config: pytest.Config) -> None:
    """Draw the session's seed; workers of xdist are told it."""
    config.addinivalue_line("markers", _MARKER)
    alpha, seed = config.getoption("--fogproof-alpha"), config.getoption("--fogproof-seed")
    if not 0 < alpha < 1:
        raise pytest.UsageError(f"--fogproof-alpha must lie in (0, 1), got {alpha}")
    if seed is not None and seed < 0:
        raise pytest.UsageError(f"--fogproof-seed must be a whole number >= 0, got {seed}")
    told = getattr(config, "workerinput", {}).get("fogproof_seed")
    config.stash[_SEED] = told if told is not None else secrets.randbits(62) if seed is None else seed
    config.stash[_ALPHA] = alpha
    config.stash[_NEWS], config.stash[_LATE], config.stash[_CRASHED] = deque(), [], []
    crashes.open_own(config)
    atexit.register(_after_all, config.stash[_NEWS])
    config.add_cleanup(partial(_require_failed, config))  # after whatever tests and their fixtures have asked for
    folder = config.getoption("--fogproof-report")
    if folder == "":
        raise pytest.UsageError("--fogproof-report must name a folder, got '': is a variable of the shell not set?")
    if folder and not hasattr(config, "workerinput"):  # better learnt now than when all tests have run
        from fogproof.errors import InvalidInputError
        from fogproof.reports.files import prepare_folder

        try:
            prepare_folder(Path(folder))
        except InvalidInputError as error:
            raise pytest.UsageError(f"--fogproof-report: {error}") from None


def pytest_sessionstart(session: pytest.Session) -> None:
    """Begin the record: one of an interrupted session, until it has come to its end."""
    config = session.config
    folder = config.getoption("--fogproof-report")
    if folder and not hasattr(config, "workerinput"):
        from fogproof.errors import InvalidInputError
        from fogproof_pytest.kept import begin

        try:
            begin(folder, config.stash[_SEED], config.stash[_ALPHA], " ".join(config.invocation_params.args))
        except InvalidInputError as error:
            raise pytest.UsageError(f"--fogproof-report: {error}") from None


@pytest.hookimpl(optionalhook=True)
def pytest_configure_node(node: Any) -> None:
    """Tell a worker of xdist the seed, and where to write down what it finds."""
    node.workerinput["fogproof_seed"] = node.config.stash[_SEED]
    crashes.begin(node)


def pytest_report_header(config: pytest.Config) -> str:
    """Say the seed, so that a failure can be repeated."""
    return (
        f"fogproof: --fogproof-seed={config.stash[_SEED]}, false-alarm probability {config.stash[_ALPHA]:g} a session"
    )


@pytest.hookimpl(wrapper=True, tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> Iterator[None]:
    """Add up the weights before any test is deselected: a share does not depend on -k, -x, -m, or the number of workers."""
    config.stash[_WEIGHTS] = sum(_marked(item).get("weight", 1.0) for item in items if _asks(item))
    return (yield)


def _asks(item: pytest.Item) -> bool:
    return "fogproof" in getattr(item, "fixturenames", ())


def _marked(item: pytest.Item) -> dict[str, Any]:
    """Return what the marks of a test say, those of its class and module included; the nearest counts."""
    said: dict[str, Any] = {}
    for marker in item.iter_markers("fogproof"):
        if marker.args:
            raise pytest.UsageError(f"{item.nodeid}: give the marker fogproof names, such as weight={marker.args[0]!r}")
        said = {**marker.kwargs, **said}
    known = {"weight", "calls", "inconclusive"}
    if unknown := set(said) - known:
        raise pytest.UsageError(f"{item.nodeid}: the marker fogproof knows {sorted(known)}, got {sorted(unknown)}")
    weight, calls, inconclusive = said.get("weight", 1.0), said.get("calls"), said.get("inconclusive", "fail")
    if isinstance(weight, bool) or not isinstance(weight, int | float) or not 0 < weight < math.inf:
        raise pytest.UsageError(f"{item.nodeid}: weight must be a finite number > 0, got {weight!r}")
    if calls is not None and (isinstance(calls, bool) or not isinstance(calls, int) or calls < 1):
        raise pytest.UsageError(f"{item.nodeid}: calls must be a whole number >= 1, got {calls!r}")
    if inconclusive not in ("fail", "pass"):
        raise pytest.UsageError(f"{item.nodeid}: inconclusive must be 'fail' or 'pass', got {inconclusive!r}")
    return said


@pytest.fixture
def fogproof(request: pytest.FixtureRequest) -> Iterator[Any]:
    """The checks of fogproof inside the session's false-alarm probability, and everything else that `fogproof` has."""
    from fogproof_pytest.checks import Checks

    item, config = request.node, request.config
    if not _asks(item):  # its share was not counted when the shares were made
        fix = "name the fixture among the test's arguments, or in @pytest.mark.usefixtures('fogproof')"
        pytest.fail(f"the false-alarm probability was shared out without {item.name}: {fix}", pytrace=False)
    said = _marked(item)
    share = config.stash[_ALPHA] * said.get("weight", 1.0) / config.stash[_WEIGHTS]
    passes = said.get("inconclusive", "fail") == "pass"
    keep = _keeper(config)
    checks = Checks(item.nodeid, share, config.stash[_SEED], said.get("calls"), passes, config.stash[_NEWS], keep)
    yield checks
    if running := checks._end():
        pytest.fail(
            f"{running} still runs where {item.name} ends: join the thread that it was called in", pytrace=False
        )


def _keeper(config: pytest.Config) -> Callable[[str, dict[str, Any] | None, str, str], None]:
    """Return what keeps a verdict, whatever becomes of the session: in the folder of the report, and where a crash is heard of."""
    folder, write_down = config.getoption("--fogproof-report"), crashes.keeper(config)
    worker = getattr(config, "workerinput", {}).get("workerid", "")

    def keep(test: str, verdict: dict[str, Any] | None, why: str, process: str) -> None:
        write_down(test, verdict, why)
        if folder and verdict:
            from fogproof_pytest import kept

            kept.keep(folder, test, verdict, config.stash[_SEED], ", ".join(filter(None, (worker, process))))

    return keep


def _drained(news: deque[tuple[Any, ...]]) -> list[tuple[Any, ...]]:
    found = []
    while news:
        found.append(news.popleft())
    return found


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item, call: pytest.CallInfo[None]) -> Generator[None, Any, Any]:
    """Attach the new verdicts to the report, as plain data that xdist can send, and in a word to junit.

    Those of a fixture are in the report of the setup or of the teardown. What was rejected fails the test, whoever has caught the
    exception: a thread, whose exceptions end nothing but itself, or an `except`.
    """
    report = yield
    if found := _drained(item.config.stash[_NEWS]):
        report.fogproof = found
        own = [verdict for test, _, verdict, _ in found if test == item.nodeid and verdict]
        if own:
            words = "; ".join(f"{v['check']}: {v['outcome']}, alpha {v['alpha']:.2g}" for v in own)
            item.user_properties.append(("fogproof", words))
        lost = [why for *_, why in found if why]
        if lost and not report.failed and not (hasattr(report, "wasxfail") and expected(item, call)):
            vars(report).pop("wasxfail", None)
            fix = "if that is what you expect, call the package itself (import fogproof), and look at the verdict"
            report.outcome = "failed"
            report.longrepr = f"{'; '.join(lost)}, though the exception has not ended the test; {fix}"
    return report


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    """Hear what came after the last report of a worker of xdist."""
    node.config.stash[_LATE] += getattr(node, "workeroutput", {}).get("fogproof", [])


@pytest.hookimpl(optionalhook=True)
def pytest_handlecrashitem(crashitem: str, report: Any) -> None:
    """Attach to the report of a test that has ended its worker of xdist what it had found, whether or not it is run again."""
    report.fogproof = crashes.found(report.node, crashitem)
    report.node.config.stash[_CRASHED].append(report)


def _after_all(news: deque[tuple[Any, ...]]) -> None:
    """Fail the process for what a thread found when the session had been told: Python has waited for it."""
    if lost := [why for *_, why in _drained(news) if why]:
        print(f"fogproof: after the session had ended, so that the process fails: {'; '.join(lost)}", file=sys.stderr)
        sys.stdout.flush()
        sys.stderr.flush()
        os._exit(_FAILED)


def pytest_sessionfinish(session: pytest.Session) -> None:
    """Fail the session for what came after the last report, which could fail nothing else."""
    config = session.config
    late = config.stash[_LATE]
    late += _drained(config.stash[_NEWS])
    if hasattr(config, "workeroutput"):
        config.workeroutput["fogproof"] = late
    config.stash[_SESSION] = session
    _require_failed(config)


def _require_failed(config: pytest.Config) -> None:
    """Fail a session in which a verdict has failed something, whoever has called it good."""
    session = config.stash.get(_SESSION, None)
    if session is None or session.exitstatus not in (0, _NOTHING):
        return
    if any(why for *_, why in config.stash[_LATE]) or _tried_again(config) or _failed(config):
        session.exitstatus = _FAILED


def _reports(config: pytest.Config, *kinds: str) -> list[Any]:
    """Return the reports of some kinds that the terminal has counted, or of all."""
    counted = getattr(config.pluginmanager.get_plugin("terminalreporter"), "stats", {})
    return [report for kind, reports in counted.items() if not kinds or kind in kinds for report in reports]


def _tried_again(config: pytest.Config) -> list[str]:
    """Return what a test that was run again had been rejected for: under one seed the same try has one answer."""
    return [why for report in _reports(config, "rerun") for *_, why in getattr(report, "fogproof", ()) if why]


def _failed(config: pytest.Config) -> bool:
    """Whether a verdict has failed a test; the session fails with it, though `pytest.exit(returncode=0)` may have ended it."""
    return any(why for report in _reports(config, "failed", "error") for *_, why in getattr(report, "fogproof", ()))


def pytest_terminal_summary(terminalreporter: Any, exitstatus: int, config: pytest.Config) -> None:
    """Say what was judged, what of the false-alarm probability was spent, and what could not have been missed."""
    if hasattr(config, "workerinput"):  # of xdist, whose reports the session has
        return
    late: list[Any] = config.stash[_LATE]
    told: dict[tuple[str, int], dict[str, Any]] = {}
    news = [one for report in _reports(config) for one in getattr(report, "fogproof", ())]
    for test, number, verdict, _ in [*news, *late]:
        before = told.get((test, number))
        if verdict and (before is None or before["outcome"] != "rejected"):  # another try takes no rejection back
            told[test, number] = verdict
    folder = config.getoption("--fogproof-report")
    lost = [why for *_, why in late if why]
    crashed = [report.nodeid for report in config.stash[_CRASHED] if report.failed]  # and were not run again
    if not told and not folder and not lost:
        return
    from fogproof.errors import FogproofError
    from fogproof_pytest.summary import summary, written

    terminalreporter.section("fogproof")
    for line in summary(told, config.stash[_ALPHA], config.stash[_SEED]):
        terminalreporter.write_line(line)
    if lost:
        terminalreporter.write_line(
            f"after the last test had been reported, so that the session fails: {'; '.join(lost)}"
        )
        exitstatus = exitstatus or _FAILED
    if again := _tried_again(config):
        terminalreporter.write_line(
            f"rejected, and run again; the seed is the same, so that chance is no excuse: {'; '.join(again)}"
        )
        exitstatus = exitstatus or _FAILED
    if folder:
        settings = (config.stash[_SEED], config.stash[_ALPHA], int(exitstatus), " ".join(config.invocation_params.args))
        try:
            terminalreporter.write_line(f"report: {written(told, crashed, folder, *settings)}")
        except (FogproofError, OSError) as error:
            terminalreporter.write_line(f"--fogproof-report: {error}")
            config.stash[_SESSION].exitstatus = (
                exitstatus or _USAGE
            )  # as where it could not have been written from the start
