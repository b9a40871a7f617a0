"""Every error comes back from another process as what it was."""

from __future__ import annotations

import importlib
import pickle
import pkgutil

import pytest

import fogproof
from fogproof.errors import FogproofError, InvalidValueError, NotInstalledError

MADE = {InvalidValueError: ("tau", "must be >= 0", -1.0, "give its magnitude"), NotInstalledError: ("dask", "dask")}


def every_kind() -> list[type[FogproofError]]:
    for module in pkgutil.walk_packages(fogproof.__path__, "fogproof."):
        if module.name.startswith(("fogproof.checks", "fogproof.study")) and "__main__" not in module.name:
            importlib.import_module(module.name)
    found, kinds = [FogproofError], []
    while found:
        kind = found.pop()
        kinds.append(kind)
        found += kind.__subclasses__()
    return kinds


def held(error: FogproofError) -> tuple[object, ...]:
    return str(error), error.args, error.path, error.to_dict(), vars(error)


def test_every_kind_of_error_survives_pickling() -> None:
    kinds = every_kind()
    assert len(kinds) > 10
    for kind in kinds:
        error = kind(*MADE.get(kind, ("something is wrong", "medium.sigma_t")))
        back = pickle.loads(pickle.dumps(error))
        assert type(back) is kind
        assert held(back) == held(error)


def test_an_error_moved_into_a_file_keeps_its_place() -> None:
    error = InvalidValueError("sigma_t", "must be >= 0", -1.0).inside("medium", "scene.toml")
    back = pickle.loads(pickle.dumps(error))
    assert held(back) == held(error)
    assert back.inside("media[0]", "other.toml").path == error.inside("media[0]", "other.toml").path


def test_a_value_that_cannot_be_pickled_stays_behind() -> None:
    error = InvalidValueError("field", "must return one number a point", lambda x: x)
    back = pickle.loads(pickle.dumps(error))
    assert str(back) == str(error)
    assert "lambda" in back.got
    with pytest.raises(InvalidValueError):
        raise back
