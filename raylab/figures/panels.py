"""What figures are made of. All pictures are linear RGB, (h, w, 3).

row(path, [Panel("16 samples", image.mean, "RMSE 0.02", zoom=(40, 20, 24)), ...], columns=3, scale=3)
    labelled pictures beside each other, each pixel `scale` pixels wide, with a note below and a zoomed square
error_map(image.mean, reference.mean)           a picture of |difference|, logarithmic, relative to the mean
scene("soft_shadows", width=120, height=80)     a reference scene; arguments are its parameters
picture(scene, "area", spp=16)                  raylab.render, interrupted for good by Ctrl-C
with plot(path) as axes: ...                    one plot in the project's style, saved at the end
with plots(path, 1, 2) as (left, right): ...    several
power_laws(axes, [Line("midpoints", n, error), ...], slopes=[-0.5, -1])
    log-log lines with their fitted slope at the right edge, and dashed lines of given slope
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

import raylab
from raylab.errors import UserError
from raylab.image import Image
from raylab.io.image_file import decode_srgb, encode_srgb
from raylab.scene import Scene
from raylab.study.look import COLOURS, GREY, MARKERS, MINUS, STYLE, label_lines, reference_line

Array = npt.NDArray[np.float64]
DPI = 100
LEAST, MOST = 1e-3, 1.0  # ends of the colour scale of an error map, relative to the mean of the reference


# --- pictures ---


@dataclass(frozen=True, eq=False)
class Panel:
    """A picture with a title above and a note below; `zoom` (column, row, size) is shown magnified in a corner."""

    title: str
    pixels: Array
    note: str = ""
    zoom: tuple[int, int, int] | None = None


def scene(name: str, **parameters: Any) -> Scene:
    """A scene of the folder reference_scenes, here or beside the package."""
    for root in (Path(), Path(raylab.__file__).parents[1]):
        path = root / "reference_scenes" / name / "scene.xml"
        if path.is_file():
            return raylab.load(path, parameters)
    raise UserError(f'the figure needs the folder "reference_scenes/{name}", which is not here')


def picture(scene: Scene, shade: str | Callable[..., Any] = "direct", **options: Any) -> Image:
    """raylab.render(scene, shade, **options); Ctrl-C ends it without a picture."""
    image = raylab.render(scene, shade, **options)
    if not image.complete:
        raise KeyboardInterrupt
    return image


def look_at(origin: npt.ArrayLike, target: npt.ArrayLike) -> Array:
    """The (4, 4) matrix of a camera at `origin` that looks at `target`, +z up."""
    origin = np.asarray(origin, np.float64)
    forward = np.asarray(target, np.float64) - origin
    forward /= np.linalg.norm(forward)
    left = np.cross((0.0, 0.0, 1.0), forward)
    left /= np.linalg.norm(left)
    matrix = np.eye(4)
    matrix[:3, :] = np.stack([left, np.cross(forward, left), forward, origin], axis=1)
    return matrix


def error_map(pixels: Array, reference: Array) -> Array:
    """|picture - reference| of each pixel, mean over channels, in a logarithmic colour scale from LEAST to MOST."""
    relative = np.nanmean(np.abs(pixels - reference), axis=-1) / np.mean(reference)
    with np.errstate(divide="ignore"):
        place = np.log(relative / LEAST) / np.log(MOST / LEAST)
    return colours(np.clip(place, 0.0, 1.0))


def colours(place: npt.ArrayLike) -> Array:
    """Linear RGB (..., 3) for places 0 .. 1 on a scale from dark to light that colour-blind eyes see too."""
    import matplotlib

    return decode_srgb(np.asarray(matplotlib.colormaps["inferno"](np.asarray(place)), np.float64)[..., :3])


def row(path: Path, panels: Sequence[Panel], columns: int = 0, scale: int = 2) -> None:
    """Write labelled pictures as a grid, `columns` in a line (default: all); titles and notes wrap at its width."""
    import matplotlib
    from matplotlib.figure import Figure

    panels = [replace(p, title=_wrapped(p, p.title, 16, scale), note=_wrapped(p, p.note, 14, scale)) for p in panels]
    columns = columns or len(panels)
    lines = -(-len(panels) // columns)
    width, height = (max(p.pixels.shape[axis] for p in panels) * scale for axis in (1, 0))
    gap = 16
    above = 8 + 26 * max(1 + p.title.count("\n") for p in panels)
    below = 6 + 30 * max(1 + p.note.count("\n") if p.note else 0 for p in panels)
    full = np.array([columns * (width + gap) + gap, lines * (above + height + below)], float)
    with matplotlib.rc_context(rc=dict[Any, Any](STYLE)):
        drawn = Figure(figsize=tuple(full / DPI), dpi=DPI)
        for i, panel in enumerate(panels):
            left = gap + (i % columns) * (width + gap)
            top = (i // columns) * (above + height + below) + above
            _panel(drawn, panel, left, top, scale, full)
        _save(drawn, path)


def _wrapped(panel: Panel, text: str, points: int, scale: int) -> str:
    """The text with line breaks between words, so that no line is wider than the picture."""
    from matplotlib.textpath import TextPath

    def width(line: str) -> float:
        return TextPath((0, 0), line, size=points).get_extents().width * DPI / 72.0

    lines: list[str] = []
    for given in text.split("\n"):
        lines.append("")
        for word in given.split(" "):
            longer = f"{lines[-1]} {word}".strip()
            if lines[-1] and width(longer) > scale * panel.pixels.shape[1]:
                lines.append(word)
            else:
                lines[-1] = longer
    return "\n".join(lines)


def _panel(drawn: Any, panel: Panel, left: int, top: int, scale: int, full: Array) -> None:
    high, wide = (scale * n for n in panel.pixels.shape[:2])

    def axes(x: float, y: float, w: float, h: float) -> Any:
        place = (x / full[0], 1.0 - (y + h) / full[1], w / full[0], h / full[1])
        made = drawn.add_axes(place, xticks=[], yticks=[])
        for spine in made.spines.values():
            spine.set_visible(False)
        return made

    shown = axes(left, top, wide, high)
    shown.imshow(encode_srgb(panel.pixels), interpolation="nearest", aspect="auto")
    shown.set_title(panel.title, pad=6, fontsize=16)
    if panel.note:
        shown.text(0.0, -8.0 / high, panel.note, transform=shown.transAxes, va="top", fontsize=14, color=GREY)
    if panel.zoom:
        x, y, size = panel.zoom
        side = round(0.42 * min(high, wide))
        inset = axes(left + wide - side - 4, top + high - side - 4, side, side)
        cut = encode_srgb(panel.pixels)[y : y + size, x : x + size]
        inset.imshow(cut, interpolation="nearest", aspect="auto")
        from matplotlib.patches import Rectangle

        for part, box in ((shown, (x - 0.5, y - 0.5)), (inset, (-0.5, -0.5))):
            part.add_patch(Rectangle(box, size, size, fill=False, edgecolor=COLOURS[4], linewidth=2.5, clip_on=False))


# --- plots ---


@dataclass(frozen=True, eq=False)
class Line:
    """Points of one line of a log-log plot; `fitted` writes the slope of least squares behind the label.

    The fit leaves out points with x below `fit_from`, where the power law has not begun.
    """

    label: str
    x: npt.ArrayLike
    y: npt.ArrayLike
    fitted: bool = True
    fit_from: float = 0.0


def slope(x: npt.ArrayLike, y: npt.ArrayLike) -> float:
    """The exponent of the power law through the points: least squares in log-log."""
    return float(np.polyfit(np.log(np.asarray(x, float)), np.log(np.asarray(y, float)), 1)[0])


@contextmanager
def plot(path: Path, width: float = 11.0, height: float = 6.2) -> Iterator[Any]:
    """One pair of axes, saved to `path` at the end."""
    with plots(path, 1, 1, width, height) as (axes,):
        yield axes


@contextmanager
def plots(path: Path, lines: int, columns: int, width: float = 13.0, height: float = 6.0) -> Iterator[list[Any]]:
    """lines x columns pairs of axes, saved to `path` at the end."""
    import matplotlib
    from matplotlib.figure import Figure

    with matplotlib.rc_context(rc=dict[Any, Any](STYLE)):
        drawn = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
        yield [drawn.add_subplot(lines, columns, i + 1) for i in range(lines * columns)]
        _save(drawn, path)


def power_laws(axes: Any, lines: Sequence[Line], slopes: Sequence[float] = ()) -> None:
    """Draw lines on logarithmic axes, labelled at the right; dashed lines with `slopes` start above the first point."""
    axes.set_xscale("log")
    axes.set_yscale("log")
    ends = []
    for line, colour, marker in zip(lines, _endless(COLOURS), _endless(tuple(MARKERS.values())), strict=False):
        x, y = np.asarray(line.x, float), np.asarray(line.y, float)
        axes.plot(x, y, color=colour, marker=marker)
        text = line.label
        if line.fitted:
            kept = x >= line.fit_from
            text += f"  (slope {slope(x[kept], y[kept]):.2f})".replace("-", MINUS)
        ends.append((float(x[-1]), float(y[-1]), text, colour))
    low, high = axes.get_ylim()
    left, right = (f(float(f(np.asarray(line.x, float))) for line in lines) for f in (min, max))  # type: ignore[operator]
    top = max(float(np.max(np.asarray(line.y, float))) for line in lines)
    for exponent in slopes:
        end = min(right, left * (low / (2.0 * top)) ** (1.0 / exponent))
        reference_line(axes, exponent, (left, 2.0 * top), end, above=True)
    axes.set_ylim(low, max(high, 4.0 * top if slopes else high))
    label_lines(axes, ends)


def _endless(values: tuple[Any, ...]) -> Iterator[Any]:
    while True:
        yield from values


def _save(drawn: Any, path: Path) -> None:
    """PNG with at most 256 colours: a third of the bytes, and no difference to the eye."""
    import io

    from PIL import Image as Pillow

    buffer = io.BytesIO()
    drawn.savefig(buffer, format="png", dpi=DPI, metadata={"Software": None})
    full = Pillow.open(buffer).convert("RGB")
    full.quantize(256, method=Pillow.Quantize.MEDIANCUT, dither=Pillow.Dither.NONE).save(path, optimize=True)
