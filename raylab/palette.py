"""From described materials to the table that `raylab.materials` reads."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab import kinds as k
from raylab import materials as m
from raylab.errors import SceneError
from raylab.microfacet import BECKMANN, GGX, LEAST_ALPHA
from raylab.rough import plastic_table
from raylab.view import View

_DISTRIBUTIONS = {"ggx": GGX, "beckmann": BECKMANN}
_FILTERS = {"bilinear": m.BILINEAR, "nearest": m.NEAREST}
_WRAPS = {"repeat": m.REPEAT, "mirror": m.MIRROR, "clamp": m.CLAMP}


class Palette:
    """Numbers the materials and textures of a scene, each once."""

    def __init__(self) -> None:
        self._numbers: dict[int, int] = {}
        self._rows: list[list[float]] = []
        self._bitmaps: list[d.Bitmap] = []
        self._keep: list[d.Material] = []
        self._coats: dict[tuple[int, float, float], npt.NDArray[np.float64]] = {}

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
        for described, read in ROWS.items():
            if isinstance(material, described):
                return read(self, material)
        raise SceneError(f"expected a material of raylab.description, got {type(material).__name__}")

    def colour(self, value: d.Colour, what: str) -> list[float]:
        """The columns COLOUR and TEXTURE."""
        if isinstance(value, d.Bitmap):
            if np.ndim(value.pixels) != 3 or min(np.shape(value.pixels)) < 1:
                raise SceneError(f"{what}: an image must be (h, w, 3), got {np.shape(value.pixels)}")
            reflectance(value.pixels, what)
            if np.shape(value.to_uv) != (3, 3) or not np.all(np.isfinite(value.to_uv)):
                raise SceneError(f"{what}: to_uv must be a finite (3, 3) matrix, got\n{value.to_uv}")
            self._bitmaps.append(value)
            return [0.0, 0.0, 0.0, len(self._bitmaps) - 1.0]
        return [*reflectance(value, what).tolist(), -1.0]

    def materials(self) -> Any:
        """The record `scene.materials`, compiled for the kinds that occur."""
        rows = np.array(self._rows or [row(k.DIFFUSE, [0.0, 0.0, 0.0, -1.0])], np.float64)
        textures = self._textures() if self._bitmaps else m.NoTextures()
        present = {int(kind) for kind in rows[:, k.KIND]}
        if present == {k.DIFFUSE}:
            return m.DiffuseMaterials(View(rows[:, : k.SPECULAR]), textures)
        if present <= {k.DIFFUSE, k.PHONG}:
            return m.PhongMaterials(View(rows[:, : k.KIND]), textures)
        kinds = dict(k.RECORDS[kind] for kind in present if kind in k.RECORDS)
        if self._coats:
            kinds["rough_plastic"] = k.RoughPlasticKind(View(np.stack(list(self._coats.values()))))
        return m.AnyMaterials(View(rows), textures, k.Kinds(**kinds))

    def coat(self, kind: int, alpha: float, eta: float) -> int:
        """The row of a rough plastic's coat, computed once."""
        key = (kind, alpha, eta)
        if key not in self._coats:
            self._coats[key] = plastic_table(*key)
        return list(self._coats).index(key)

    def _textures(self) -> m.Textures:
        sheets, maps, first = [], [], 0
        for bitmap in self._bitmaps:
            height, width = bitmap.pixels.shape[:2]
            sheets.append([first, width, height, _FILTERS[bitmap.filter], _WRAPS[bitmap.wrap]])
            maps.append(np.asarray(bitmap.to_uv, np.float64)[:2].ravel())
            first += width * height
        texels = np.concatenate([b.pixels.reshape(-1, 3) for b in self._bitmaps]).astype(np.float32)
        return m.Textures(View(np.array(sheets, np.int64)), View(np.stack(maps)), View(texels))


# --- one row for each kind ---

BLACK = [0.0, 0.0, 0.0, -1.0]


def row(kind: int, colour: list[float], specular: Any = (0, 0, 0), exponent: float = 1.0, *more: float) -> list[float]:
    """All columns of a material (`raylab.kinds`), `more` from PARAMETERS on."""
    columns = [*colour, *map(float, specular), float(exponent), float(kind), *map(float, more)]
    return columns + [0.0] * (k.ROW - len(columns))


def _diffuse(palette: Palette, material: d.Diffuse) -> list[float]:
    return row(k.DIFFUSE, palette.colour(material.reflectance, "diffuse reflectance"))


def _phong(palette: Palette, material: d.Phong) -> list[float]:
    """A black lobe makes it diffuse."""
    if not (0.0 <= material.exponent <= 1e9):
        raise SceneError(f"phong: exponent must be in [0, 1e9], got {material.exponent}")
    diffuse = palette.colour(material.diffuse_reflectance, "phong diffuse_reflectance")
    specular = reflectance(material.specular_reflectance, "phong specular_reflectance")
    value = material.diffuse_reflectance
    brightest = value.pixels.max(axis=(0, 1)) if isinstance(value, d.Bitmap) else np.asarray(value)
    if np.max(brightest + specular) > 1.0 + 1e-9:
        raise SceneError(f"phong: diffuse and specular reflectance add up to more than 1: {brightest} and {specular}")
    return row(k.PHONG if specular.max() > 0.0 else k.DIFFUSE, diffuse, specular, material.exponent)


def _conductor(palette: Palette, material: d.Conductor) -> list[float]:
    eta, absorption = (index(v, f"conductor {n}") for n, v in (("eta", material.eta), ("k", material.k)))
    specular = reflectance(material.specular_reflectance, "conductor specular_reflectance")
    return row(k.CONDUCTOR, BLACK, specular, 1.0, *eta, *absorption)


def _dielectric(palette: Palette, material: d.Dielectric) -> list[float]:
    indices(material, "dielectric")
    specular = reflectance(material.specular_reflectance, "dielectric specular_reflectance")
    transmittance = reflectance(material.specular_transmittance, "dielectric specular_transmittance")
    return row(k.DIELECTRIC, BLACK, specular, 1.0, material.int_ior / material.ext_ior, *transmittance)


def _rough_conductor(palette: Palette, material: d.RoughConductor) -> list[float]:
    what = "roughconductor"
    eta, absorption = (index(v, f"{what} {n}") for n, v in (("eta", material.eta), ("k", material.k)))
    specular = reflectance(material.specular_reflectance, f"{what} specular_reflectance")
    alphas = [alpha(v, f"{what} {n}") for n, v in (("alpha_u", material.alpha_u), ("alpha_v", material.alpha_v))]
    kind = distribution(material.distribution, what)
    if alphas[0] != alphas[1]:
        raise SceneError(f"{what}: alpha_u and alpha_v must be equal, got {alphas[0]:g} and {alphas[1]:g}")
    return row(k.ROUGH_CONDUCTOR, BLACK, specular, 1.0, *eta, *absorption, kind, *alphas)


def _rough_plastic(palette: Palette, material: d.RoughPlastic) -> list[float]:
    what = "roughplastic"
    indices(material, what)
    colour = palette.colour(material.diffuse_reflectance, f"{what} diffuse_reflectance")
    specular = reflectance(material.specular_reflectance, f"{what} specular_reflectance")
    kind, roughness = distribution(material.distribution, what), alpha(material.alpha, f"{what} alpha")
    eta = material.int_ior / material.ext_ior
    coat = palette.coat(kind, roughness, eta)
    return row(k.ROUGH_PLASTIC, colour, specular, 1.0, kind, roughness, eta, material.nonlinear, coat)


ROWS: dict[type, Callable[[Palette, Any], list[float]]] = {
    d.Diffuse: _diffuse,
    d.Phong: _phong,
    d.Conductor: _conductor,
    d.Dielectric: _dielectric,
    d.RoughConductor: _rough_conductor,
    d.RoughPlastic: _rough_plastic,
}
LARGEST_INDEX = 1e6
LARGEST_ALPHA = 10.0  # 1 is very rough already


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


def index(value: Any, what: str) -> npt.NDArray[np.float64]:
    """A part of a refractive index for each colour; SceneError unless it is in [0, LARGEST_INDEX]."""
    rgb = np.asarray(value, np.float64)
    if rgb.shape not in ((), (3,)):
        raise SceneError(f"{what} must be one number or an RGB triple, got shape {rgb.shape}")
    rgb = np.array(np.broadcast_to(rgb, 3))
    bad = ~((rgb >= 0.0) & (rgb <= LARGEST_INDEX))
    if bad.any():
        raise SceneError(f"{what} must lie in [0, {LARGEST_INDEX:g}], got {rgb[bad][0]}")
    return rgb


def indices(material: d.Dielectric | d.RoughPlastic, what: str) -> None:
    """SceneError unless both refractive indices are in (0, LARGEST_INDEX]."""
    for name, value in (("int_ior", material.int_ior), ("ext_ior", material.ext_ior)):
        if not 0.0 < value <= LARGEST_INDEX:
            raise SceneError(f"{what}: {name} must be greater than 0, at most {LARGEST_INDEX:g}, got {value}")


def alpha(value: float, what: str) -> float:
    """A roughness in (0, LARGEST_ALPHA], at least LEAST_ALPHA."""
    if not 0.0 < value <= LARGEST_ALPHA:
        raise SceneError(f"{what} must be greater than 0, at most {LARGEST_ALPHA:g}, got {value}")
    return max(float(value), LEAST_ALPHA)


def distribution(name: str, what: str) -> int:
    if name not in _DISTRIBUTIONS:
        raise SceneError(f"{what}: the distribution must be one of {', '.join(_DISTRIBUTIONS)}, got {name!r}")
    return _DISTRIBUTIONS[name]
