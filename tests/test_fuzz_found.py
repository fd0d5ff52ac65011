"""What the fuzzers found, each as its smallest case."""

from __future__ import annotations

import numpy as np
import pytest
from scenes import moved

from raylab import description as d
from raylab.errors import SceneError
from raylab.scene import Scene

WORLD = d.Rectangle(name="world")
SPECK = moved(0, 0, 0, 1e-170, 1e-170, 1e-170)


def test_a_square_whose_area_is_beyond_float64_has_no_normal():
    """It was divided by its area of 0."""
    scene = Scene(d.SceneDescription(shapes=(WORLD, d.Rectangle(to_world=SPECK, name="dust"))))
    assert any("'dust'" in warning and "too fine for float32" in warning for warning in scene.warnings)
    assert np.isfinite(scene.data.planes.array).all()


@pytest.mark.parametrize("faces", [2, 1], ids=["rectangle", "triangle"])
def test_a_lamp_whose_area_is_beyond_float64_is_refused(faces):
    """Its density 1 / A was infinite."""
    corners = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    triangle = d.Mesh(vertices=corners, faces=np.array([[0, 1, 2]]), to_world=SPECK, radiance=np.ones(3))
    square = d.Rectangle(to_world=SPECK, radiance=np.ones(3))
    with pytest.raises(SceneError, match="an area light needs an area"):
        Scene(d.SceneDescription(shapes=(WORLD, square if faces == 2 else triangle)))


@pytest.mark.parametrize(
    ("eye", "words"),
    [
        (d.Camera(principal_point_offset=(0.0, np.nan)), "principal_point_offset must be finite"),
        (d.Camera(filter=d.Filter("box", np.inf)), "positive radius"),
        (d.Camera(filter=d.Filter("gaussian", 4e-200, 1e-200)), "radius and stddev of a gaussian"),
        (d.Camera(filter=d.Filter("gaussian", 1.0, np.inf)), "radius and stddev of a gaussian"),
    ],
)
def test_a_camera_without_directions_is_refused(eye, words):
    """Each eye ray was NaN."""
    with pytest.raises(SceneError, match=words):
        Scene(d.SceneDescription(camera=eye))


@pytest.mark.parametrize("length", [1e200, 1e-200, 5e-324])
def test_the_direction_of_a_sun_has_any_length(length):
    """Its square over- or underflowed, and the sun was refused as infinite or as none."""
    sun = d.DirectionalLight(np.array([0.0, 0.0, -length]), np.ones(3))
    (found,) = Scene(d.SceneDescription(lights=(sun,))).data.suns
    assert [*found.w] == [0.0, 0.0, 1.0]
