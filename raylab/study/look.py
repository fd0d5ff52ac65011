"""How the project's figures and pages look: large type, colours that colour-blind eyes tell apart, direct labels."""

from __future__ import annotations

import base64
import io
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

# Okabe and Ito 2008, "Color universal design", in the order in which they are best told apart; their yellow is too
# pale for lines.
COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
LINES = {"independent": "-", "stratified": (0, (5, 1.5)), "latin": (0, (4, 1.2, 1.2, 1.2)), "sobol": (0, (1.2, 1.2))}
MARKERS = {"independent": "o", "stratified": "s", "latin": "^", "sobol": "D"}
GREY = "#6b6b6b"
MINUS, TIMES = "\N{MINUS SIGN}", "\N{MULTIPLICATION SIGN}"
STYLE: dict[str, Any] = {
    "font.size": 17,
    "axes.titlesize": 19,
    "axes.titlelocation": "left",
    "axes.titlepad": 14,
    "axes.labelsize": 18,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.edgecolor": GREY,
    "axes.grid": True,
    "axes.grid.which": "both",
    "axes.axisbelow": True,
    "grid.color": "#e4e4e4",
    "grid.linewidth": 0.8,
    "xtick.labelsize": 15,
    "ytick.labelsize": 15,
    "lines.linewidth": 3.0,
    "lines.markersize": 8.0,
    "legend.frameon": False,
    "svg.hashsalt": "raylab",
    "savefig.facecolor": "white",
}


@contextmanager
def figure(width: float = 13.0, height: float = 7.3) -> Iterator[tuple[Any, Any]]:
    """A figure and its axes in the project's style, drawn without a screen."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(rc=dict[Any, Any](STYLE)):
        drawn = Figure(figsize=(width, height), layout="constrained")
        yield drawn, drawn.add_subplot()


def svg(drawn: Any) -> bytes:
    """The figure as SVG, the same bytes each time."""
    buffer = io.BytesIO()
    drawn.savefig(buffer, format="svg", metadata={"Date": None})
    return buffer.getvalue()


def png(drawn: Any) -> bytes:
    """The figure as PNG, large enough for a projector."""
    buffer = io.BytesIO()
    drawn.savefig(buffer, format="png", dpi=150)
    return buffer.getvalue()


def data_uri(content: bytes, kind: str) -> str:
    """`content` inside an address, so that a page needs no other file; kind is "png" or "svg+xml"."""
    return f"data:image/{kind};base64,{base64.b64encode(content).decode('ascii')}"


def label_lines(axes: Any, ends: Sequence[tuple[float, float, str, str]]) -> None:
    """Write (x, y, text, colour) at the right edge, each as near to its line's end as the others allow."""
    axes.figure.draw_without_rendering()
    box, size = axes.get_window_extent(), 16.0
    gap = 1.35 * size * axes.figure.dpi / 72.0 / box.height
    order = sorted(ends, key=lambda end: end[1])
    heights = [(axes.transData.transform((x, y))[1] - box.y0) / box.height for x, y, _, _ in order]
    for (x, y, text, colour), height in zip(order, spread(np.array(heights), gap), strict=True):
        axes.annotate(
            text, (x, y), (1.03, height), textcoords="axes fraction", xycoords="data", color=colour, fontsize=size,
            va="center", annotation_clip=False,
            arrowprops={"arrowstyle": "-", "color": colour, "linewidth": 0.8, "alpha": 0.5, "shrinkA": 2, "shrinkB": 6},
        )  # fmt: skip


def spread(wanted: npt.NDArray[np.float64], gap: float) -> npt.NDArray[np.float64]:
    """Increasing positions at least `gap` apart, with the least squared distance from the sorted `wanted`.

    Positions minus k gap must not decrease: a monotone regression.
    """
    from scipy.optimize import isotonic_regression

    steps = gap * np.arange(len(wanted))
    return np.asarray(isotonic_regression(wanted - steps).x + steps)


def reference_line(axes: Any, slope: float, start: tuple[float, float], end: float, above: bool) -> None:
    """A thin dashed power law from the point `start` to x = `end`, with its exponent written above or below it."""
    y = start[1] * (end / start[0]) ** slope
    axes.plot([start[0], end], [start[1], y], color=GREY, linewidth=1.4, linestyle=(0, (6, 4)), zorder=1)
    text = f"slope {MINUS}" + ("1/2" if slope == -0.5 else f"{-slope:g}")
    at = start[0] * (end / start[0]) ** 0.75 if above else end
    axes.annotate(
        text, (at, start[1] * (at / start[0]) ** slope), (4, 4) if above else (-12, -1), textcoords="offset points",
        color=GREY, fontsize=15, ha="left" if above else "right", va="bottom" if above else "top",
    )  # fmt: skip


def plain_ticks(axis: Any) -> None:
    """Label a logarithmic axis of few decades with plain numbers, at 1, 2 and 5 of each decade."""
    from matplotlib.ticker import LogLocator, NullFormatter, StrMethodFormatter

    low, high = axis.get_view_interval()
    axis.set_minor_formatter(NullFormatter())
    if high < 200.0 * low:
        axis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axis.set_major_formatter(StrMethodFormatter("{x:g}"))
