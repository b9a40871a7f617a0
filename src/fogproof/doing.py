"""What is being done now: long work says so, and whoever wants to show it listens."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Listener = Callable[[str], None]
_LISTENER: ContextVar[Listener | None] = ContextVar("listener", default=None)


def doing(what: str) -> None:
    """Tell whoever listens what is being done; nobody does unless a command says so."""
    listener = _LISTENER.get()
    if listener is not None:
        listener(what)


@contextmanager
def heard_by(listener: Listener) -> Iterator[None]:
    """Let a function hear what is being done."""
    token = _LISTENER.set(listener)
    try:
        yield
    finally:
        _LISTENER.reset(token)


@contextmanager
def on_behalf_of(whom: str) -> Iterator[None]:
    """Put whom all is done for before what is said meanwhile."""
    listener = _LISTENER.get()
    if listener is None:
        yield
        return
    tell = listener
    with heard_by(lambda what: tell(f"{whom}: {what}")):
        yield
