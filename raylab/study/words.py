"""Numbers and their errors in words."""

from __future__ import annotations

import math
import os
import platform
from pathlib import Path

from raylab.stats.convergence import Slope
from raylab.stats.intervals import Estimate
from raylab.study.look import MINUS


def readable(value: float, digits: int = 3) -> str:
    """A number to `digits` digits; whole from 100 to a million with thin spaces: "0.123", "16 200", "1.2e+07"."""
    rounded = float(f"{value:.{digits}g}")
    if 100.0 <= abs(rounded) < 1e6:
        return f"{rounded:,.0f}".replace(",", "\u202f")
    return f"{rounded:.{digits}g}"


def with_error(value: float, error: float) -> str:
    """Value and error to the second digit of the error, as "0.3954 ± 0.0021"; the value alone if it is unknown."""
    if not (math.isfinite(error) and error > 0.0):
        return f"{value:.5g}"
    places = max(0, 1 - math.floor(math.log10(error)))
    return f"{value:.{places}f}\u00a0±\u00a0{error:.{places}f}"


def number(estimate: Estimate) -> str:
    """For example "1.23e-05 (1.1e-05 to 1.4e-05)", or that it is below the reference's own error."""
    doubt = " ?" if estimate.doubts else ""
    if estimate.value == 0.0 and estimate.doubts:
        return f"below the reference's own error (< {readable(estimate.high, 2)})"
    if estimate.doubts and math.isinf(estimate.high):
        return f"{readable(estimate.value)} (interval not trusted)"
    return f"{readable(estimate.value)} ({readable(estimate.low, 2)} to {readable(estimate.high, 2)}){doubt}"


def slope(fitted: Slope | None) -> str:
    """For example "-1.00 (-1.04 to -0.96)", with true minus signs."""
    if fitted is None:
        return "unknown"
    text = f"{fitted.value:.2f} ({fitted.low:.2f} to {fitted.high:.2f})" + (" ?" if fitted.doubts else "")
    return text.replace("-", MINUS)


def machine() -> str:
    """The processor's name and number of cores, as far as the system tells."""
    name = platform.processor() or platform.machine()
    info = Path("/proc/cpuinfo")
    if info.is_file():
        lines = info.read_text(encoding="utf-8", errors="replace").splitlines()
        name = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), name)
    return f"{name}, {os.cpu_count()} cores, {platform.system()}"
