"""Fresh processes for other people's code and for workers: forked by one server, which nothing of theirs can reach.

multiprocessing's server of processes is started here, for it would otherwise share more with us than it should. It gets a session
of its own, so that a signal to our process group, as a scheduler or a closed terminal sends it, asks us alone. It loads modules
from where they are installed, not a `random.py` that lies beside a file of cases. Its socket lies where a path is short enough for
one. The watcher of `children` takes the socket's folder away, and ends what the server forked, however we end. Other people's code
may take it away before, as a fixture does that empties TMPDIR: then there is another server, in another folder.
"""

from __future__ import annotations

import atexit
import contextlib
import multiprocessing
import multiprocessing.forkserver
import multiprocessing.resource_tracker
import os
import secrets
import shutil
import signal
import sys
import tempfile
import threading
from collections.abc import Iterator
from typing import Any

from fogproof import children
from fogproof.foreign import installed_path

PRELOAD = "FOGPROOF_PRELOAD"
OURS = "fogproof"
"""What PYTHONSAFEPATH holds if it was set here."""
ENDING = 0.3
"""Seconds in which a server that has been killed is seen to be gone: until then none is started in its place."""
_LONGEST = 60
"""Characters of a folder for sockets: their paths may have a hundred or so, and their names take forty."""
_SHORT = "/tmp"
_WORD = secrets.token_hex(16)
_lock = threading.Lock()
_left: list[int] = []
"""What holds the last server that was left."""


def context(preload: list[str]) -> Any:
    """Return how to start fresh processes, never as a fork of this one, which would copy locks that other threads hold.

    preload  modules that take long to load: the server, if it is not there yet, loads them once
    """
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    made = multiprocessing.get_context("forkserver")
    with _lock, _modules(), _environment(PYTHONSAFEPATH=os.environ.get("PYTHONSAFEPATH") or OURS):
        with _environment(PYTHONWARNINGS=_quiet(os.environ.get("PYTHONWARNINGS", ""))):
            multiprocessing.resource_tracker.ensure_running()  # before it could carry the word that ends the others
        _leave_unreachable()
        _wake()
        _make_folder()
        words = f"{children.words_of(os.environ)} {_WORD}"
        with _environment(**{PRELOAD: ",".join(preload), children.WORDS: words}):
            made.set_forkserver_preload(["fogproof.server_start"])
            multiprocessing.forkserver.ensure_running()
    return made


def let_go() -> None:
    """Close what leads from a process that was forked to the server and to multiprocessing's watcher of semaphores.

    Other people's code that writes into every file it finds open would write there. If it uses multiprocessing itself, it gets
    a server and a watcher of its own.
    """
    server, watcher = multiprocessing.forkserver._forkserver, multiprocessing.resource_tracker._resource_tracker
    for opened in (getattr(server, "_forkserver_alive_fd", None), getattr(watcher, "_fd", None)):
        if opened is not None:
            with contextlib.suppress(OSError):
                os.close(opened)
    _forget(server)
    vars(watcher).update(_fd=None, _pid=None)


def end() -> None:
    """End the server and all that it forked: one that still loads what takes long would let whoever asked it wait for that."""
    if os.name == "posix":
        children.end_all((), [_WORD])


def _quiet(warnings: str) -> str:
    """Return what warnings Python shows, but for multiprocessing's watcher of semaphores, which tells of those it removes.

    Whoever is killed leaves some; that they are removed is nothing to be told.
    """
    return ",".join(filter(None, (warnings, "ignore:resource_tracker")))


def folder() -> str:
    """Return the folder of the sockets, "" before there is one."""
    return str(_settings().get("tempdir") or "")


def _settings() -> dict[str, Any]:
    settings: dict[str, Any] = multiprocessing.current_process()._config  # type: ignore[attr-defined]
    return settings


def _make_folder() -> None:
    """Make the folder in which multiprocessing puts sockets, where their paths are short. It is removed after us, or by us."""
    if os.path.isdir(folder()):
        return
    usual = tempfile.gettempdir()
    short = _SHORT if os.access(_SHORT, os.W_OK) and (len(usual) > _LONGEST or not os.path.isdir(usual)) else usual
    made = _settings()["tempdir"] = tempfile.mkdtemp(prefix=f"fogproof-{os.getpid()}-", dir=short)
    atexit.register(shutil.rmtree, made, ignore_errors=True)
    children.remove_after(made)


def _leave_unreachable() -> None:
    """Let go of a server whose socket is gone: it ends when what it forked has, and we leave the next or end."""
    server = multiprocessing.forkserver._forkserver
    address = getattr(server, "_forkserver_address", None)
    if address is None or os.path.exists(address):
        return
    with server._lock:  # type: ignore[attr-defined]
        while _left:
            os.close(_left.pop())
        _left.append(server._forkserver_alive_fd)  # type: ignore[attr-defined]  # another thread may be about to hand it on
        _forget(server)


def _wake() -> None:
    """Tell the server to go on: whoever has stopped it would have us wait for the next process without end."""
    pid = getattr(multiprocessing.forkserver._forkserver, "_forkserver_pid", None)
    if pid is not None:
        with contextlib.suppress(OSError, AttributeError):
            os.kill(pid, signal.SIGCONT)


def _forget(server: Any) -> None:
    vars(server).update(_forkserver_alive_fd=None, _forkserver_address=None, _forkserver_pid=None)


@contextlib.contextmanager
def _environment(**told: str) -> Iterator[None]:
    before = {name: os.environ.get(name) for name in told}
    os.environ.update(told)
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value


@contextlib.contextmanager
def _modules() -> Iterator[None]:
    before = list(sys.path)
    sys.path[:] = installed_path()
    try:
        yield
    finally:
        sys.path[:] = before
