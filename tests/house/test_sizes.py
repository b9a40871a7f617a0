"""One algorithm a file, one step a function: what is longer than others is listed with its reason."""

import ast
from pathlib import Path

ROOT = Path(__file__).parents[2]
MOST = 300
LONGER = {
    "src/fogproof/renderers/render_with_cycles.py": "runs inside Blender's own interpreter, which sees this one file alone",
}


def sources():
    for folder in ("src/fogproof", "analytic", "estimators", "reports", "tools", "benchmarks", "examples"):
        for path in (ROOT / folder).rglob("*.py"):
            yield path.resolve().relative_to(ROOT).as_posix(), path


def test_no_source_file_is_too_long():
    lines = {name: len(path.read_text().splitlines()) for name, path in sources()}
    assert len(lines) > 600
    assert {name: count for name, count in lines.items() if count > MOST and name not in LONGER} == {}
    assert {name for name in LONGER if lines.get(name, 0) <= MOST} == set(), "listed, and not longer"


LINES = 70
"""Of a function, without its docstring."""
LONG = {
    "trace": "one loop that follows a path to its end: in parts it would hand a dozen numbers from one to the next",
    "trace_in_colour": "the same in colour",
    "cases": "a list of records",
    "bugs": "a list of records",
}


def test_no_function_is_too_long():
    long = {}
    for name, path in sources():
        if name.startswith(("tools", "benchmarks", "examples", "src/fogproof/renderers")):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.FunctionDef):
                told = node.body[0] if ast.get_docstring(node) else None
                lines = node.end_lineno - node.lineno + 1 - (told.end_lineno - told.lineno + 1 if told else 0)
                if lines > LINES:
                    long.setdefault(node.name, []).append(f"{name}: {lines}")
    assert {function: where for function, where in long.items() if function not in LONG} == {}
    assert set(long) == set(LONG), "listed, and not longer"
