"""Beside: a picture, its reference, and their difference in standard errors, side by side."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from raylab.study.look import COLOURS, GREY, MINUS, STYLE, TIMES

if TYPE_CHECKING:
    from raylab.study.compare import Comparison

SHOWN = 10.0  # standard errors at the ends of the colour scale
WIDE, GAP, ABOVE, BELOW, BAR = 5.2, 0.12, 1.05, 0.95, 1.9  # inches: a panel, around it, and the scale beside it


def drawn(comparison: Comparison, title: str) -> Any:
    """The figure."""
    import matplotlib
    from matplotlib.figure import Figure

    from raylab.io.image_file import encode_srgb

    h, w, _ = comparison.image.mean.shape
    high = WIDE * h / w
    full = (3.0 * (WIDE + GAP) + GAP + BAR, ABOVE + high + BELOW)
    with matplotlib.rc_context(rc=dict[Any, Any](STYLE) | {"axes.grid": False}):
        figure = Figure(figsize=full)

        def place(left: float, width: float) -> tuple[float, float, float, float]:
            return left / full[0], BELOW / full[1], width / full[0], high / full[1]

        for i, (name, mean) in enumerate(
            (("yours", comparison.image.mean), ("reference", comparison.reference.mean), ("", None))
        ):
            axes = figure.add_axes(place(GAP + i * (WIDE + GAP), WIDE), xticks=[], yticks=[], frame_on=False)
            axes.set_title(name or f"yours {MINUS} reference, in standard errors", pad=8)
            if mean is not None:
                axes.imshow(encode_srgb(mean), interpolation="nearest", extent=(0, w, h, 0), aspect="auto")
        extent = (0, comparison.z.shape[1] * comparison.side, comparison.z.shape[0] * comparison.side, 0)
        shown = axes.imshow(
            comparison.z,
            cmap=_colours(),
            vmin=-SHOWN,
            vmax=SHOWN,
            interpolation="nearest",
            extent=extent,
            aspect="auto",
        )
        axes.set(xlim=(0, w), ylim=(h, 0), xticks=[], yticks=[])
        if comparison.wrong_tiles:
            _mark(axes, comparison)
        _scale(figure, shown, figure.add_axes(place(3.0 * (WIDE + GAP) + GAP, 0.22)))
        left, top = GAP / full[0], 1.0 - 0.15 / full[1]
        figure.text(left, top, title, va="top", fontsize=19, fontweight="bold")
        tiles = f"Tiles of {comparison.side} {TIMES} {comparison.side} pixels."
        text = f"{comparison.numbers}\n{comparison.verdict} {tiles}"
        figure.text(left, (BELOW - 0.18) / full[1], text, va="top", fontsize=15, color=GREY, linespacing=1.4)
        return figure


def _scale(figure: Any, shown: Any, axes: Any) -> None:
    """What the colours mean."""
    bar = figure.colorbar(shown, cax=axes, extend="both", extendfrac=0.03, ticks=(-10, -6, -3, 0, 3, 6, 10))
    bar.ax.set_yticklabels([f"{MINUS}10 too dark", f"{MINUS}6", f"{MINUS}3", "noise", "3", "6", "10 too bright"])
    bar.outline.set_visible(False)


def _mark(axes: Any, comparison: Comparison) -> None:
    """A square around the tile that is furthest off."""
    from matplotlib.patches import Rectangle

    (column, row), side = comparison.worst, comparison.side
    corner = (column - side, row - side)
    axes.add_patch(Rectangle(corner, 2 * side, 2 * side, fill=False, edgecolor=COLOURS[6], linewidth=2.0))


def _colours() -> Any:
    """Blank for what noise does, blue below and red above."""
    from matplotlib.colors import LinearSegmentedColormap

    ends = [
        (-SHOWN, "#03264a"), (-6.0, COLOURS[0]), (-3.0, "#dbe6ee"), (0.0, "#f8f8f6"), (3.0, "#f4e4d8"),
        (6.0, COLOURS[1]), (SHOWN, "#5c2000"),
    ]  # fmt: skip
    return LinearSegmentedColormap.from_list("standard errors", [((z + SHOWN) / (2.0 * SHOWN), c) for z, c in ends])
