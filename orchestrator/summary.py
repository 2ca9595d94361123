"""How data shows itself in a terminal and in a notebook: a line, or a small table."""

from __future__ import annotations

from html import escape

Rows = dict[str, str]
"""What is said of a thing, by heading."""


class Summarised:
    """Data with a `_summary`, whose first entry is what it is."""

    def _summary(self) -> Rows:
        raise NotImplementedError

    def __repr__(self) -> str:
        (what, first), *rest = self._summary().items()
        return f"<{what}: {'; '.join([first, *(f'{k} {v}' for k, v in rest)])}>"

    def _repr_html_(self) -> str:
        (what, first), *rest = self._summary().items()
        rows = "".join(
            f"<tr><th style='text-align:left'>{escape(k)}</th>"
            f"<td style='text-align:left'>{escape(v)}</td></tr>"
            for k, v in rest
        )
        return f"<b>{escape(what)}</b> {escape(first)}<table>{rows}</table>"
