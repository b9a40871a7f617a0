"""What the documentation's site has beside docs/: README, CONTRIBUTING and the like, the API, the oracle by quantity.

mkdocs calls the functions below (see `hooks` in mkdocs.yml). Nothing is written twice: pages come from the files at the root, and
from what the functions declare beside themselves.
"""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

ROOT = Path(__file__).resolve().parents[1]
PAGES = {
    "index.md": "README.md",
    "contributing.md": "CONTRIBUTING.md",
    "architecture.md": "ARCHITECTURE.md",
    "changes.md": "CHANGELOG.md",
}
"""Pages of the site that are files at the root."""
BESIDE = ("examples", "schemas", "src/fogproof/study/methods", "analytic/declaration.py")
"""Files that pages link to, which the site therefore has."""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the pages that docs/ does not have, and the files that pages link to."""
    known = {file.src_uri for file in files}
    for page, source in PAGES.items():
        text = (ROOT / source).read_text(encoding="utf-8")
        files.append(File.generated(config, page, content=_inside(text)))
    files.append(File.generated(config, "api.md", content=api()))
    files.append(File.generated(config, "quantities.md", content=by_quantity()))
    for place in BESIDE:
        found = [ROOT / place] if (ROOT / place).is_file() else sorted((ROOT / place).rglob("*"))
        for path in found:
            name = path.relative_to(ROOT).as_posix()
            if path.is_file() and "__pycache__" not in name and name not in known:
                files.append(File.generated(config, name, abs_src_path=str(path)))
    return files


def on_page_markdown(markdown: str, page: Any, config: MkDocsConfig, files: Files) -> str:
    """Return a page whose links to files outside docs/ lead to their copies in the site."""
    there = {file.src_uri for file in files}

    def moved(link: re.Match[str]) -> str:
        name = link[1]
        pages = {source: page for page, source in PAGES.items()}
        if name in pages:
            return f"]({pages[name]}"
        if name in there:
            return f"]({name}"
        inside = sorted(file for file in there if file.startswith(f"{name.rstrip('/')}/"))
        return f"]({inside[0]}" if inside else link[0]

    return re.sub(r"\]\(\.\./([^)#\s]+)", moved, markdown)


def _inside(text: str) -> str:
    """Return the text of a file at the root as that of a page in docs/."""

    def moved(link: re.Match[str]) -> str:
        target = link[1]
        if target.startswith("docs/"):
            return f"]({target.removeprefix('docs/')}"
        return link[0] if "://" in target else f"](../{target}"

    return re.sub(r"\]\(([^)#\s]+)", moved, text)


def api() -> str:
    """Return the page of every public name of `fogproof`, under the module that makes it."""
    import fogproof

    kinds: dict[str, list[str]] = {}
    for name in fogproof.__all__:
        thing = getattr(fogproof, name)
        module = getattr(thing, "__module__", "")
        if not module.startswith("fogproof") or not hasattr(thing, "__qualname__"):
            continue
        kinds.setdefault(_title(name, module), []).append(f"::: {module}.{thing.__qualname__}")
    parts = [
        "# API",
        "Every public name of `fogproof`. Functions of the oracle stand under [the oracle by quantity](quantities.md).",
    ]
    for title in sorted(kinds):
        parts += [f"## {title}", *kinds[title]]
    return "\n\n".join(parts) + "\n"


def _title(name: str, module: str) -> str:
    room = module.split(".")[1]
    if name.startswith(("check_", "compare_")):
        return "Checks"
    titles = {
        "checks": "Verdicts",
        "domains": "Domains",
        "scene": "Scenes",
        "contracts": "Contracts",
        "errors": "Errors",
    }
    return titles.get(room, "Runs and tools")


def by_quantity() -> str:
    """Return the page of every quantity of the oracle: formula and bound from its docstring, unit, convention, source, example."""
    from fogproof import analytic
    from fogproof.quantities import quantities

    parts = [
        "# The oracle by quantity",
        "Every function of `fogproof.analytic` that answers by name, with its formula and error bound, and a question as"
        " [`fogproof oracle`](oracle.md) takes it. In Python, call the function of the same name. A test asks every example.",
    ]
    for quantity in quantities().values():
        function = getattr(analytic, quantity.name)
        parts += [
            f"## {quantity.name}",
            f"::: {function.__module__}.{quantity.name}\n    options:\n      show_root_heading: true\n      heading_level: 3",
            f"Unit: {quantity.unit}. {quantity.convention}.\n\nSource: {quantity.source}.",
            "```json\n" + json.dumps({"quantity": quantity.name, **quantity.example}) + "\n```",
        ]
    return "\n\n".join(parts) + "\n"
