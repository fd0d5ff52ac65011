"""Scene files of a few lines, and what is read from them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from raylab.description import (
    Bitmap,
    SceneDescription,
)
from raylab.io.mitsuba_xml import read

EPS = np.finfo(float).eps
SIX_DIGITS = 0.5e-5  # Mitsuba prints six significant digits
SENSOR = '<sensor type="perspective"/>'


def load(folder: Path, body: str, parameters: dict[str, str] | None = None, sensor: str = SENSOR) -> SceneDescription:
    path = folder / "test.xml"
    path.write_text(f'<scene version="3.0.0">\n<integrator type="direct"/>\n{sensor}\n{body}\n</scene>\n')
    return read(path, parameters)


def shape(folder: Path, body: str, kind: str = "rectangle") -> Any:
    (result,) = load(folder, f'<shape type="{kind}">{body}</shape>').shapes
    return result


def matrix(folder: Path, operations: str) -> np.ndarray:
    """The to_world that `operations` make."""
    result: np.ndarray = shape(folder, f'<transform name="to_world">{operations}</transform>').to_world
    return result


def camera_scene(folder: Path, inside: str) -> SceneDescription:
    return load(folder, "", sensor=f'<sensor type="perspective">{inside}</sensor>')


def bitmap(folder: Path, inside: str = "", name: str = "t.exr") -> Bitmap:
    texture = f'<texture type="bitmap" name="reflectance"><string name="filename" value="{name}"/>{inside}</texture>'
    result = shape(folder, f'<bsdf type="diffuse">{texture}</bsdf>').front.reflectance
    assert isinstance(result, Bitmap)
    return result


# A picture of 4 x 4 pixels.
LAMP_OVER_FLOOR = """<scene version="3.0.0">
<integrator type="direct"/>
<sensor type="perspective">
  <transform name="to_world"><lookat origin="0,2,4" target="0,0,0" up="0,1,0"/></transform>
  <film type="hdrfilm"><integer name="width" value="4"/><integer name="height" value="4"/><rfilter type="box"/></film>
</sensor>
<shape type="rectangle"><transform name="to_world"><rotate x="1" angle="-90"/></transform></shape>
<shape type="rectangle">
  <transform name="to_world"><rotate x="1" angle="90"/><translate y="2"/></transform>
  <emitter type="area"><rgb name="radiance" value="2"/></emitter>
</shape>
</scene>
"""

# A wall light [-1, 1] x [0, 2] that stands on a floor; the picture of 8 x 8 pixels is of the floor [0, 1/2] x
# [-1/4, 1/4] in front of it, fov = 2 atan(1 / 32): the light's foot is in the pixels of the first column.
LAMP_ON_FLOOR = """<scene version="3.0.0">
<integrator type="direct"/>
<sensor type="perspective">
  <float name="fov" value="3.5798"/>
  <transform name="to_world"><lookat origin="0.25,0,8" target="0.25,0,0" up="0,1,0"/></transform>
  <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/><rfilter type="box"/></film>
</sensor>
<shape type="rectangle"><transform name="to_world"><scale value="4"/></transform></shape>
<shape type="rectangle">
  <transform name="to_world"><matrix value="0 0 1 0  1 0 0 0  0 1 0 1  0 0 0 1"/></transform>
  <emitter type="area"><rgb name="radiance" value="1"/></emitter>
</shape>
</scene>"""
