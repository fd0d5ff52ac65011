"""The page of all figures, docs/gallery.md."""

from __future__ import annotations

from raylab.figures.registry import all_figures

HEAD = """# Gallery

Every figure of the lecture, in slide order. `make figures` makes all of them and this page; the command beside a
figure makes that one. [The slide table](slides.md) says which function and which test belong to it.
"""


def markdown(pictures: str = "figures") -> str:
    """The page; `pictures` is the folder of the files as seen from it."""
    parts, slide = [HEAD], ""
    for figure in all_figures().values():
        if figure.slide != slide:
            parts.append(f"## {figure.slide}\n")
        slide = figure.slide
        parts.append(f"![{figure.name}]({pictures}/{figure.name}.png)\n\n{figure.caption}\n")
        parts.append(f"    raylab figures {figure.name} -o docs/{pictures}\n")
    return "\n".join(parts)
