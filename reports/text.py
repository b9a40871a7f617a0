"""Names from outside, cut to size, and made into names of files and anchors."""

from __future__ import annotations

import hashlib
import re
import unicodedata

from fogproof.text import one_line


def label(text: str, limit: int = 40) -> str:
    """Return `text` on one line, safe as `visible` makes it, never empty; beyond `limit` characters its middle is left out."""
    line = one_line(text) or "(blank)"
    return line if len(line) <= limit else f"{line[: (limit - 1) // 2]}…{line[-(limit // 2) :]}"


def file_stem(*names: str) -> str:
    """Return a file name without suffix: readable, at most 80 ASCII characters, of [A-Za-z0-9._=-], never hidden.

    A digest of the exact names keeps different names apart, also where file names ignore case.
    """
    exact = "\0".join(names).encode("utf-8", "surrogatepass")
    return f"{_readable('.'.join(names)) or 'case'}-{hashlib.blake2b(exact, digest_size=5).hexdigest()}"


def anchor(name: str) -> str:
    """Return the HTML id of a case: `case/` and its name if that is short and plain, else its `file_stem`."""
    return f"case/{name if re.fullmatch(r'[A-Za-z0-9._=/,+-]{1,80}', name) else file_stem(name)}"


def _readable(name: str) -> str:
    plain = unicodedata.normalize("NFKD", name[:200]).encode("ascii", "ignore").decode()
    return re.sub(r"[^A-Za-z0-9._=]+", "-", plain).strip(".-")[:64].rstrip(".-")
