"""Text from outside made safe to show and to name files by: names, messages and output may hold anything."""

from __future__ import annotations

import hashlib
import re
import unicodedata

_CONTROL_PICTURES = {code: 0x2400 + code for code in range(0x20) if chr(code) not in "\t\n"} | {0x7F: 0x2421}


def visible(text: str) -> str:
    """Return `text` with what no document may hold made visible: the result is valid in HTML 5, XML 1.0 and UTF-8.

    Control characters become their pictures (U+2400...), bidirectional overrides (which reorder the text around them),
    lone surrogates and non-characters become U+FFFD. Everything else, right-to-left scripts and emoji included, stays.
    """
    return "".join(_visible(c) for c in text) if not text.isascii() else text.translate(_CONTROL_PICTURES)


def label(text: str, limit: int = 40) -> str:
    """Return `text` on one line, safe as `visible` makes it, never empty; beyond `limit` characters its middle is left out."""
    line = " ".join(visible(text).split()) or "(blank)"
    return line if len(line) <= limit else f"{line[: (limit - 1) // 2]}…{line[-(limit // 2) :]}"


def _visible(character: str) -> str:
    code = ord(character)
    if code in _CONTROL_PICTURES:
        return chr(_CONTROL_PICTURES[code])
    hidden = 0x80 <= code <= 0x9F or 0x202A <= code <= 0x202E or 0x2066 <= code <= 0x2069
    impossible = 0xD800 <= code <= 0xDFFF or 0xFDD0 <= code <= 0xFDEF or code & 0xFFFE == 0xFFFE
    return "\N{REPLACEMENT CHARACTER}" if hidden or impossible else character


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
