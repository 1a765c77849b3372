# SPDX-License-Identifier: BSD-3-Clause
from typing import Any, Callable, Sequence

def report(
    out: str, data: Sequence[str], scene: str | None, options: dict[str, Any], progress: Callable[[int, int], Any] | None, /
) -> tuple[str, bool, str]: ...
