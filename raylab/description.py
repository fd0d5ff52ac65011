"""What a scene is made of, in plain Python: the words that a scene file and a Python script share.

A reader (`raylab.io.mitsuba_xml`) or a script fills these records; `raylab.scene.build` checks them once and turns
them into what the kernels need. Lengths are in scene units, angles in degrees, colours are linear RGB with sRGB
primaries as float64 arrays of shape (3,), matrices are (4, 4) float64 and map local to world coordinates.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Literal

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]
DEEPEST = 16  # rays in a row that `SceneDescription.max_depth` may ask for: behind glass, each doubles the work


def _identity() -> Array:
    return np.eye(4)


def _rgb(value: float) -> Array:
    return np.full(3, float(value))


@dataclass(frozen=True, eq=False)
class Bitmap:
    """An image over the (u, v) square: `pixels` (h, w, 3) linear RGB, row 0 at the top (v = 1)."""

    pixels: Array
    filter: Literal["bilinear", "nearest"] = "bilinear"
    wrap: Literal["repeat", "mirror", "clamp"] = "repeat"
    to_uv: Array = field(default_factory=lambda: np.eye(3))


Colour = Array | Bitmap


@dataclass(frozen=True, eq=False)
class Animation:
    """Where something stands over time: matrices (k, 4, 4) at increasing `times` (k,), k >= 2.

    Between two of them translation and stretch change evenly, and so does the angle of the rotation, the shorter way
    round; before the first and after the last it stands still.
    """

    times: Array
    matrices: Array


@dataclass(frozen=True, eq=False)
class Diffuse:
    """Lambertian reflection: f_r = reflectance / pi, 1/sr."""

    reflectance: Colour = field(default_factory=lambda: _rgb(0.5))


@dataclass(frozen=True, eq=False)
class Phong:
    """Modified Phong, energy-normalised: f_r = diffuse/pi + specular (n + 2)/(2 pi) max(0, r.w)^n, 1/sr."""

    diffuse_reflectance: Colour = field(default_factory=lambda: _rgb(0.5))
    specular_reflectance: Array = field(default_factory=lambda: _rgb(0.2))
    exponent: float = 30.0


@dataclass(frozen=True, eq=False)
class Conductor:
    """A smooth metal of index `eta` + i `k` relative to the air, for each colour; by default a perfect mirror."""

    eta: Array = field(default_factory=lambda: _rgb(0.0))
    k: Array = field(default_factory=lambda: _rgb(1.0))
    specular_reflectance: Array = field(default_factory=lambda: _rgb(1.0))


@dataclass(frozen=True, eq=False)
class Dielectric:
    """Smooth glass of index `int_ior` behind the surface and `ext_ior` in front of it (BK7 and air by default).

    It belongs on both sides of a shape: on the back as `inside`. The colours scale what Fresnel's formulas give.
    """

    int_ior: float = 1.5046
    ext_ior: float = 1.000277
    specular_reflectance: Array = field(default_factory=lambda: _rgb(1.0))
    specular_transmittance: Array = field(default_factory=lambda: _rgb(1.0))

    @property
    def inside(self) -> Dielectric:
        """The same boundary seen from behind."""
        return replace(self, int_ior=self.ext_ior, ext_ior=self.int_ior)


Distribution = Literal["beckmann", "ggx"]


@dataclass(frozen=True, eq=False)
class RoughConductor:
    """Metal of microfacets of index `eta` + i `k` relative to the air; roughness alpha > 0 along u and v."""

    eta: Array = field(default_factory=lambda: _rgb(0.0))
    k: Array = field(default_factory=lambda: _rgb(1.0))
    specular_reflectance: Array = field(default_factory=lambda: _rgb(1.0))
    alpha_u: float = 0.1
    alpha_v: float = 0.1
    distribution: Distribution = "beckmann"


@dataclass(frozen=True, eq=False)
class RoughPlastic:
    """A diffuse base under a rough clear coat of index `int_ior` (polypropylene) in `ext_ior` (air).

    `nonlinear` counts the colour of the base each time that the coat throws light back to it.
    """

    diffuse_reflectance: Colour = field(default_factory=lambda: _rgb(0.5))
    specular_reflectance: Array = field(default_factory=lambda: _rgb(1.0))
    int_ior: float = 1.49
    ext_ior: float = 1.000277
    alpha: float = 0.1
    distribution: Distribution = "beckmann"
    nonlinear: bool = False


Material = Diffuse | Phong | Conductor | Dielectric | RoughConductor | RoughPlastic


@dataclass(frozen=True, eq=False, kw_only=True)
class Shape:
    """What every shape has: a material on either side (None reflects nothing) and what its front emits."""

    name: str = ""
    front: Material | None = field(default_factory=Diffuse)
    back: Material | None = None
    radiance: Array | None = None  # W/(m^2 sr), emitted on the side the normal points to
    to_world: Array = field(default_factory=_identity)
    motion: Animation | None = None  # takes the place of to_world
    flip_normals: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Mesh(Shape):
    """Triangles: `vertices` (n, 3), `faces` (m, 3) integers, optional unit `normals` (n, 3) and `uv` (n, 2).

    All of them in local coordinates; without `normals` every face is flat.
    """

    vertices: Array
    faces: npt.NDArray[np.integer]
    normals: Array | None = None
    uv: Array | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Rectangle(Shape):
    """The square [-1, 1] x [-1, 1] in the local plane z = 0, normal +z."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Cube(Shape):
    """The cube [-1, 1]^3, normals outwards."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Disk(Shape):
    """The unit disk in the local plane z = 0, normal +z."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Sphere(Shape):
    """A sphere around local `center`, normals outwards (inwards with `flip_normals`)."""

    center: Array = field(default_factory=lambda: np.zeros(3))
    radius: float = 1.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Cylinder(Shape):
    """An open cylinder from local `p0` to `p1`, normals outwards (inwards with `flip_normals`)."""

    p0: Array = field(default_factory=lambda: np.zeros(3))
    p1: Array = field(default_factory=lambda: np.array([0.0, 0.0, 1.0]))
    radius: float = 1.0


@dataclass(frozen=True, eq=False)
class PointLight:
    """Radiant intensity (W/sr) from one world position."""

    position: Array
    intensity: Array


@dataclass(frozen=True, eq=False)
class DirectionalLight:
    """Parallel light that travels along world `direction`; irradiance (W/m^2) on a surface that faces it."""

    direction: Array
    irradiance: Array


@dataclass(frozen=True, eq=False)
class ConstantEnvironment:
    """The same radiance from every direction."""

    radiance: Array


@dataclass(frozen=True, eq=False)
class GradientEnvironment:
    """Radiance radiance + w . gradient: `radiance` (3,), `gradient` (3, 3), one row for each colour."""

    radiance: Array
    gradient: Array


@dataclass(frozen=True, eq=False)
class ImageEnvironment:
    """A latitude-longitude image: `pixels` (h, w, 3) linear RGB radiance, row 0 at local +y; placed by `to_world`.

    With `mis_compensation` only what is brighter than the mean is sampled by brightness; the BRDF's samples find the
    rest, so that only shades that combine both may use it (`direct`, `mis_balance`, `mis_power`).
    """

    pixels: Array
    to_world: Array = field(default_factory=_identity)
    filter: Literal["bilinear", "nearest"] = "bilinear"
    mis_compensation: bool = False


Light = PointLight | DirectionalLight
Environment = ConstantEnvironment | GradientEnvironment | ImageEnvironment


@dataclass(frozen=True)
class Filter:
    """Pixel reconstruction filter; `radius` in pixels (`stddev` only for the gaussian)."""

    kind: Literal["box", "tent", "gaussian"] = "box"
    radius: float = 0.5
    stddev: float = 0.5


@dataclass(frozen=True, eq=False)
class Camera:
    """A perspective camera at the local origin that looks along local +z with +y up and +x to the left.

    With an `aperture_radius` it has a thin lens: a disk, or a regular polygon of the same area with `aperture_blades`
    sides and its first corner `aperture_rotation` degrees from local +x. What lies at the depth `focus_distance` is
    sharp.
    """

    to_world: Array = field(default_factory=_identity)
    motion: Animation | None = None  # takes the place of to_world
    shutter_open: float = 0.0
    shutter_close: float = 0.0
    fov: float = 45.0  # degrees, along `fov_axis`
    fov_axis: Literal["x", "y", "diagonal", "smaller", "larger"] = "x"
    near_clip: float = 1e-2
    far_clip: float = 1e4
    principal_point_offset: tuple[float, float] = (0.0, 0.0)
    aperture_radius: float = 0.0
    focus_distance: float = 1e4  # measured along the axis; may be inf
    aperture_blades: int = 0
    aperture_rotation: float = 0.0
    width: int = 256
    height: int = 256
    filter: Filter = field(default_factory=Filter)


@dataclass(frozen=True, eq=False)
class SceneDescription:
    """A whole scene, as read; `spp`, `sampler` and `seed` are what the file asks for by default."""

    camera: Camera = field(default_factory=Camera)
    shapes: tuple[Shape, ...] = ()
    lights: tuple[Light, ...] = ()
    environment: Environment | None = None
    sampler: Literal["independent", "stratified", "latin", "sobol", "centre"] = "sobol"
    spp: int = 16
    seed: int = 0
    hide_emitters: bool = False
    max_depth: int = 8  # rays in a row, the eye ray included; only the shade "basic" asks for it
    name: str = "scene"
    path: Path | None = None
    warnings: tuple[str, ...] = ()
