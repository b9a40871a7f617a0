"""Whether the mark xfail expects a rejection that it would hide."""

from __future__ import annotations

from typing import Any

import pytest


def expected(item: pytest.Item, call: pytest.CallInfo[Any]) -> bool:
    """Whether a failure that pytest has taken for that of a mark xfail is the rejection, or the mark expects one as well.

    `pytest.xfail()` comes where a rejection was caught; so does an exception that no rejection led to.
    """
    if call.excinfo is None or call.excinfo.errisinstance(pytest.xfail.Exception):
        return False
    from fogproof.checks import InconclusiveError, RejectedError

    ways = (RejectedError, InconclusiveError)
    error: BaseException | None = call.excinfo.value
    while error is not None:
        if isinstance(error, ways):
            return True
        error = error.__cause__ or error.__context__
    return any(_covers(mark.kwargs.get("raises"), ways) for mark in item.iter_markers("xfail"))


def _covers(raises: Any, ways: tuple[type[BaseException], ...]) -> bool:
    if raises is None:
        return True
    kinds = tuple(kind for kind in (raises if isinstance(raises, tuple) else (raises,)) if isinstance(kind, type))
    return all(issubclass(way, kinds) for way in ways)
