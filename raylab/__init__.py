"""raylab: the lecture "Advanced Ray Tracing" (CS 4620, lecture 24) as a laboratory.

    scene = raylab.load("reference_scenes/soft_shadows/scene.xml")
    image = raylab.render(scene, shade="area", spp=64)
    raylab.save(image, "picture.png")

The slides' functions are in `raylab.shade`; everything else serves them.
"""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from raylab._version import __version__
from raylab.errors import SceneError, UserError
from raylab.image import Image
from raylab.render import render
from raylab.scene import Scene

__all__ = ["Image", "Scene", "SceneError", "UserError", "__version__", "load", "render", "save"]


def load(path: str | PathLike[str], parameters: Mapping[str, Any] | None = None) -> Scene:
    """Read a Mitsuba 3 scene file (the subset in docs/scenes.md) and make it ready to render.

    `parameters` replace `$name` in the file. Raises SceneError, which names file, line and element.
    """
    from raylab.io.mitsuba_xml import read

    return Scene(read(Path(path), {name: str(value) for name, value in (parameters or {}).items()}))


def save(image: Image, path: str | PathLike[str]) -> None:
    """Write a picture: .png (8-bit sRGB), .exr (mean and standard error as named channels) or .npz (all of it)."""
    from raylab.io.picture import write

    write(image, Path(path))


def __getattr__(name: str) -> Any:
    """`raylab.estimator_test` is for test files; pytest is imported only where it is asked for."""
    if name == "estimator_test":
        from raylab.pytest_plugin import estimator_test

        return estimator_test
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
