# SPDX-License-Identifier: BSD-3-Clause
"""Results as tables: pandas, xarray, CSV."""

from __future__ import annotations

import os
from typing import Any, Mapping

import numpy as np


class Table:
    """What has columns of numbers that belong together, row by row."""

    def _columns(self) -> dict[str, Any]:
        """Columns by names with units, as the command line has them."""
        raise NotImplementedError

    def _head(self) -> Mapping[str, str]:
        """What stands above them in a file."""
        return {}

    def to_dataframe(self) -> Any:
        """A `pandas.DataFrame`, its columns named as those of the command line, with units."""
        try:
            import pandas
        except ImportError:
            raise ImportError("to_dataframe() needs pandas; to_csv() does not") from None
        return pandas.DataFrame({name: np.asarray(column) for name, column in self._columns().items()})

    def to_xarray(self) -> Any:
        """An `xarray.Dataset` over the first column."""
        try:
            import xarray
        except ImportError:
            raise ImportError("to_xarray() needs xarray; to_dataframe() needs pandas, to_csv() neither") from None
        columns = self._columns()
        axis = next(iter(columns))
        variables = {name: (axis, np.asarray(column)) for name, column in columns.items() if name != axis}
        return xarray.Dataset(variables, coords={axis: np.asarray(columns[axis])}, attrs=dict(self._head()))

    def to_csv(self, path: str | os.PathLike[str]) -> None:
        """Writes a file as the command line does, digits enough to read the same numbers back."""
        from . import __version__

        columns = {name: np.asarray(column).tolist() for name, column in self._columns().items()}
        lines = [f"# {key}: {' '.join(str(value).split())}" for key, value in {"fracfit": __version__, **self._head()}.items()]
        lines.append(",".join(columns))
        lines.extend(",".join(map(_cell, row)) for row in zip(*columns.values()))
        with open(path, "w", encoding="utf-8") as file:
            file.write("\n".join(lines) + "\n")


def _cell(value: Any) -> str:
    if isinstance(value, bool):
        return str(int(value))
    if isinstance(value, float):
        return repr(value)
    if value is None:
        return "nan"
    said = str(value)
    return '"' + said.replace('"', '""') + '"' if any(each in said for each in ',"\n') else said


def column_unit(unit: str) -> str:
    """What a unit is called behind the name of a column: "m/N" is m_per_n."""
    return "".join(("_" + ("per_" if i else "") + part.strip().lower()) for i, part in enumerate(unit.split("/"))) if unit else ""
