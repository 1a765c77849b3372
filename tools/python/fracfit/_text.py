# SPDX-License-Identifier: BSD-3-Clause
"""Texts and tables of results."""

from __future__ import annotations

import math
from typing import Any, Iterable, Sequence


def short(value: Any) -> str:
    """A number with five digits."""
    if isinstance(value, complex):
        return f"{value.real:.5g}{value.imag:+.5g}j"
    if isinstance(value, float):
        return "-" if math.isnan(value) else f"{value:.5g}"
    return str(value)


def escaped(text: str) -> str:
    return text.replace("&", "&amp;").replace("<", "&lt;").replace(">", "&gt;")


def html_table(head: Sequence[str], rows: Iterable[Sequence[Any]], caption: str = "") -> str:
    """A table for a notebook; the caption is a paragraph of its own, which a narrow table does not break."""
    parts = [f"<p><strong>{escaped(caption)}</strong></p>" if caption else "", "<table>"]
    if any(head):
        parts.append("<tr>" + "".join(f"<th>{escaped(name)}</th>" for name in head) + "</tr>")
    for row in rows:
        parts.append("<tr>" + "".join(f"<td>{escaped(short(cell))}</td>" for cell in row) + "</tr>")
    parts.append("</table>")
    return "".join(parts)


class Progress:
    """A bar on standard error, for a call with ``progress=True``."""

    def __init__(self, label: str) -> None:
        self._label = label

    def __call__(self, done: int, total: int) -> None:
        import sys

        end = "\n" if done >= total else ""
        print(f"\r{self._label}: {done} of {total} ({100 * done // max(total, 1)} %)", end=end, file=sys.stderr, flush=True)


def reporter(progress: Any, label: str) -> Any:
    """What the compiled part calls: nothing, the caller's function, or a bar on a terminal."""
    if progress is None or progress is False:
        return None
    if progress is True:
        import sys

        return Progress(label) if sys.stderr.isatty() else None
    if not callable(progress):
        raise ValueError("progress is neither True, False, None nor a function of (done, total)")
    return progress
