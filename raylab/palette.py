"""From described materials to the table that `raylab.materials` reads."""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab import materials as m
from raylab.errors import SceneError
from raylab.view import View

_FILTERS = {"bilinear": m.BILINEAR, "nearest": m.NEAREST}
_WRAPS = {"repeat": m.REPEAT, "mirror": m.MIRROR, "clamp": m.CLAMP}


class Palette:
    """Numbers the materials and textures of a scene, each once."""

    def __init__(self) -> None:
        self._numbers: dict[int, int] = {}
        self._rows: list[list[float]] = []
        self._bitmaps: list[d.Bitmap] = []
        self._keep: list[d.Material] = []
        self.glossy = False

    @property
    def textured(self) -> bool:
        return bool(self._bitmaps)

    def number(self, material: d.Material | None) -> int:
        """The row of a material; -1 for none."""
        if material is None:
            return -1
        if id(material) not in self._numbers:
            self._keep.append(material)
            self._rows.append(self._row(material))
            self._numbers[id(material)] = len(self._rows) - 1
        return self._numbers[id(material)]

    def _row(self, material: d.Material) -> list[float]:
        if isinstance(material, d.Diffuse):
            return [*self._colour(material.reflectance, "diffuse reflectance"), 0.0, 0.0, 0.0, 1.0]
        if not isinstance(material, d.Phong):
            raise SceneError(f"expected a material of raylab.description, got {type(material).__name__}")
        if not (0.0 <= material.exponent <= 1e9):
            raise SceneError(f"phong: exponent must be in [0, 1e9], got {material.exponent}")
        diffuse = self._colour(material.diffuse_reflectance, "phong diffuse_reflectance")
        specular = reflectance(material.specular_reflectance, "phong specular_reflectance")
        value = material.diffuse_reflectance
        brightest = value.pixels.max(axis=(0, 1)) if isinstance(value, d.Bitmap) else np.asarray(value)
        if np.max(brightest + specular) > 1.0 + 1e-9:
            raise SceneError(
                f"phong: diffuse and specular reflectance add up to more than 1: {brightest} and {specular}"
            )
        self.glossy = self.glossy or bool(specular.max() > 0.0)
        return [*diffuse, *specular, float(material.exponent)]

    def _colour(self, value: d.Colour, what: str) -> list[float]:
        if isinstance(value, d.Bitmap):
            if np.ndim(value.pixels) != 3 or min(np.shape(value.pixels)) < 1:
                raise SceneError(f"{what}: an image must be (h, w, 3), got {np.shape(value.pixels)}")
            reflectance(value.pixels, what)
            self._bitmaps.append(value)
            return [0.0, 0.0, 0.0, len(self._bitmaps) - 1.0]
        return [*reflectance(value, what).tolist(), -1.0]

    def materials(self) -> Any:
        """The record `scene.materials`."""
        rows = np.array(self._rows or [[0.0, 0, 0, -1, 0, 0, 0, 1]], np.float64)
        textures = self._textures() if self._bitmaps else m.NoTextures()
        if self.glossy:
            return m.PhongMaterials(View(rows), textures)
        return m.DiffuseMaterials(View(rows[:, :4]), textures)

    def _textures(self) -> m.Textures:
        sheets, maps, first = [], [], 0
        for bitmap in self._bitmaps:
            height, width = bitmap.pixels.shape[:2]
            sheets.append([first, width, height, _FILTERS[bitmap.filter], _WRAPS[bitmap.wrap]])
            maps.append(np.asarray(bitmap.to_uv, np.float64)[:2].ravel())
            first += width * height
        texels = np.concatenate([b.pixels.reshape(-1, 3) for b in self._bitmaps]).astype(np.float32)
        return m.Textures(View(np.array(sheets, np.int64)), View(np.stack(maps)), View(texels))


def reflectance(value: Any, what: str) -> npt.NDArray[np.float64]:
    """`value` as an array of RGB; SceneError unless all of it lies in [0, 1]."""
    rgb = np.asarray(value, np.float64)
    if rgb.ndim == 0:
        rgb = np.full(3, float(rgb))
    if rgb.shape[-1] != 3:
        raise SceneError(f"{what} must be one number, an RGB triple or an image (h, w, 3), got shape {rgb.shape}")
    bad = ~((rgb >= 0.0) & (rgb <= 1.0))
    if bad.any():
        where = f" at {tuple(int(i) for i in np.argwhere(bad)[0])}" if rgb.ndim > 1 else ""
        raise SceneError(f"{what} must lie in [0, 1], got {rgb[bad][0]}{where}")
    return rgb
