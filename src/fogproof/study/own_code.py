"""The modules that a study file names: found beside it or among the installed packages, read, and known by their sources."""

from __future__ import annotations

import ast
import contextlib
import hashlib
import importlib
import importlib.util
import re
import sys
import threading
from pathlib import Path
from types import ModuleType
from typing import Any

from fogproof.errors import InvalidInputError
from fogproof.foreign import EndedProcessError, import_from, loading

NAME = re.compile(r"([^\W\d]\w*(?:\.[^\W\d]\w*)*):([^\W\d]\w*)")
"""module:Name."""
_LOADING = threading.RLock()
_loaded: dict[str, tuple[str, str]] = {}


def digest_of(module: str, folder: str) -> str:
    """Return the digest of a module's sources and of all that it imports from the same place, or say that there is none."""
    root, within = _root_of(module, folder)
    digest = hashlib.sha256()
    for name, path in sorted(_sources(module, root, within).items()):
        digest.update(f"{name}\0{hashlib.sha256(path.read_bytes()).hexdigest()}\0".encode())
    return digest.hexdigest()


def loaded(module: str, folder: str) -> ModuleType:
    """Return the module, imported anew if another one of its name, or an older state of it, is there."""
    root, within = _root_of(module, folder)
    with _LOADING:
        state = (str(root), digest_of(module, folder))
        if not within and _loaded.get(module) != state:
            for name in _sources(module, root, within):
                sys.modules.pop(name, None)
        if not within:
            import_from(str(root))
        importlib.invalidate_caches()
        try:
            with loading(), contextlib.redirect_stdout(sys.stderr):
                found = importlib.import_module(module)
        except SyntaxError as error:
            where = Path(error.filename or module).name
            raise InvalidInputError(f"{where}, line {error.lineno}: {error.msg}", module) from None
        except EndedProcessError as error:
            raise InvalidInputError(f"cannot import {module}: {error}", module) from None
        except Exception as error:
            raise InvalidInputError(f"cannot import {module}: {type(error).__name__}: {error}", module) from None
        _loaded[module] = state
        return found


def _root_of(module: str, folder: str) -> tuple[Path, str]:
    """Return where imports begin, and the one package that is followed there, "" for all."""
    root, top = Path(folder), module.partition(".")[0]
    if _file(root, module) is not None:
        return root.resolve(), ""
    try:
        spec = importlib.util.find_spec(top)
    except (ImportError, ValueError):
        spec = None
    if spec is None or not spec.origin or not Path(spec.origin).is_file():
        raise InvalidInputError(f"there is no module {module} in {folder or '.'}, nor installed", module)
    origin = Path(spec.origin)
    root = origin.parent.parent if origin.stem == "__init__" else origin.parent
    if _file(root, module) is None:
        raise InvalidInputError(f"the package {top} has no module {module}", module)
    return root, top


def _sources(module: str, root: Path, within: str) -> dict[str, Path]:
    """Return module -> file, of the module, the packages it lies in, and of all that those import from the same place."""
    found: dict[str, Path] = {}
    waiting = [module]
    while waiting:
        name = waiting.pop()
        path = None if name in found or (within and name.partition(".")[0] != within) else _file(root, name)
        if path is None:
            continue
        found[name] = path
        waiting += [name.rpartition(".")[0]] if "." in name else []
        if path.suffix == ".py":
            waiting += _imports(path, name if path.stem == "__init__" else name.rpartition(".")[0])
    return found


def _file(root: Path, module: str) -> Path | None:
    stem = root.joinpath(*module.split("."))
    choices = [stem.with_name(stem.name + ".py"), stem / "__init__.py", *sorted(stem.parent.glob(f"{stem.name}.*.so"))]
    return next((path for path in choices if path.is_file()), None)


def _imports(path: Path, package: str) -> list[str]:
    """Return what a source file imports, as absolute names; of `from a import b` both a and a.b."""
    try:
        tree: Any = ast.parse(path.read_bytes())
    except (SyntaxError, ValueError):  # the import says so
        return []
    names: list[str] = []
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            names += [alias.name for alias in node.names]
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            names += [base, *(f"{base}.{alias.name}" for alias in node.names)]
    return [name for name in names if name]
