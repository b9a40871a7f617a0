"""Signals are heard from a command's start to its end, through code in C too, and a second one breaks no writing."""

import os
import signal
import subprocess
import sys
import time

import pytest

from fogproof.cli import commands, main, signals
from fogproof.cli.signals import interruptible, stoppable
from fogproof.errors import stop_behind


@pytest.fixture(autouse=True)
def heard():
    """In the background and under nohup a process ignores some signals, and so does what it starts; here nothing is ignored."""
    usual = {signal.SIGINT: signal.default_int_handler, signal.SIGTERM: signal.SIG_DFL, signal.SIGHUP: signal.SIG_DFL}
    before = {number: signal.signal(number, handler) for number, handler in usual.items()}
    yield
    for number, handler in before.items():
        signal.signal(number, handler)


def ask(number=signal.SIGTERM):
    os.kill(os.getpid(), number)
    time.sleep(0.01)


def in_c():
    """Stop inside code in C that returns with the exception set, as Cython's callbacks do."""
    try:
        ask()
    except KeyboardInterrupt as stop:
        raise SystemError("returned a result with an exception set") from stop


def code(monkeypatch, body):
    """Return the exit code of a command line whose command runs `body`."""
    monkeypatch.setattr(commands.cli, "get_command", lambda _context, _name: commands.click.Command("x", callback=body))
    with pytest.raises(SystemExit) as end:
        main(["x"])
    return end.value.code


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_every_command_hears_signals(monkeypatch, number):
    assert code(monkeypatch, lambda: ask(number)) == 128 + number


def test_a_stop_inside_code_in_c_is_a_stop(monkeypatch):
    assert code(monkeypatch, in_c) == 143
    with stoppable(), interruptible() as stop:
        in_c()
    assert stop.code == 143


def test_other_faults_of_code_in_c_stay_faults(monkeypatch, capsys):
    def fault():
        raise SystemError("bad") from ValueError("other")

    assert code(monkeypatch, fault) == 70
    with pytest.raises(SystemError), interruptible():
        fault()


def test_what_caused_an_error_is_found_even_in_a_circle():
    first, second = ValueError(), KeyError()
    first.__context__, second.__cause__ = second, first
    assert stop_behind(first) is None
    second.__context__ = stop = KeyboardInterrupt()
    assert stop_behind(first) is stop


def test_signals_wait_while_the_page_is_written(monkeypatch):
    written = []

    def body():
        with interruptible() as stop:
            pass
        assert not stop.code
        ask()
        written.append("page")
        return 1

    assert code(monkeypatch, body) == 143
    assert written == ["page"]


def test_a_second_signal_at_once_belongs_to_the_first(monkeypatch):
    cleaned = []

    def body():
        try:
            ask(signal.SIGINT)
        finally:
            ask(signal.SIGINT)
            cleaned.append("all")

    assert code(monkeypatch, body) == 130
    assert cleaned == ["all"]


def test_a_later_signal_ends_the_process_at_once(monkeypatch):
    monkeypatch.setattr(signals, "PATIENCE", 0.0)
    child = os.fork()
    if not child:
        with stoppable():
            try:
                ask()
            except KeyboardInterrupt:
                ask()
        os._exit(0)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGTERM


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM, signal.SIGHUP])
def test_what_a_parent_has_blocked_is_heard(number):
    """Masks outlive exec; programs that are started by a thread often have one."""
    started = "import fogproof_command as c, os, time; c.prepare(); os.kill(os.getpid(), {}); time.sleep(5)"
    blocked = {
        "preexec_fn": lambda: signal.pthread_sigmask(signal.SIG_BLOCK, [number]),
        "capture_output": True,
    }
    ran = subprocess.run([sys.executable, "-c", started.format(int(number))], **blocked)
    assert (ran.returncode, ran.stderr) == (128 + number, b"fogproof: stopped\n")


def test_a_time_limit_hears_its_alarm_though_it_is_blocked():
    """In a process of one thread: any other would hear it."""
    code = """if True:
        import os, signal, time
        from fogproof.errors import TimeLimitError
        from fogproof.oracle.limits import within
        signal.signal(signal.SIGALRM, lambda number, frame: None)
        signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGALRM])
        os.kill(os.getpid(), signal.SIGALRM)  # somebody else's, which waits
        print(within(60.0, lambda: "answer"))
        try:
            within(0.05, lambda: time.sleep(3))
        except TimeLimitError:
            print("ended")
        print(signal.SIGALRM in signal.pthread_sigmask(signal.SIG_BLOCK, []))
    """
    ran = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)
    assert ran.stdout.split() == ["answer", "ended", "True"], ran.stderr


def test_a_formula_that_is_stopped_is_not_one_that_fails():
    from dataclasses import replace

    from fogproof.stability.measuring import measure
    from fogproof.stability.record import select

    def stopping(**_arguments):
        in_c()

    with stoppable(), interruptible() as stop:
        measure(replace(select(["phase"])[0], ours=stopping), 2)
    assert stop.code == 143
