"""Slide "Cause of glossy reflection (rough surfaces)": balls of rough copper."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from raylab import description as d
from raylab.figures import panels
from raylab.figures.registry import figure
from raylab.io.indices import METALS
from raylab.scene import Scene

ALPHAS = (0.05, 0.1, 0.2, 0.35, 0.5)
NAMES: tuple[tuple[d.Distribution, str], ...] = (("ggx", "GGX"), ("beckmann", "Beckmann"))
PIXELS, SAMPLES = 110, 32


def ball(material: d.Material, environment: d.Environment) -> Scene:
    """A ball before a sky, seen from the height of its centre."""
    pose = np.diag([1.0, 1.0, -1.0, 1.0])  # along -z
    pose[2, 3] = 6.0
    camera = d.Camera(to_world=pose, fov=21.0, width=PIXELS, height=PIXELS)
    return Scene(d.SceneDescription(camera=camera, shapes=(d.Sphere(front=material),), environment=environment))


@figure(
    "roughness",
    "Cause of glossy reflection (rough surfaces)",
    """A copper ball in a sky with a sun: small mirrors whose normals scatter by alpha. Both distributions have the same
    roughness; GGX has the longer tails, so its highlights fade into a halo where Beckmann's end. Normals that are seen
    are sampled, together with the sky, so that a narrow lobe and a small sun are both free of noise.""",
)
def roughness(path: Path) -> None:
    sky = panels.scene("hdr_sky").description.environment
    assert sky is not None
    eta, k = (np.array(rgb) for rgb in METALS["Cu"])
    shown = []
    for distribution, name in NAMES:
        for alpha in ALPHAS:
            copper = d.RoughConductor(eta, k, alpha_u=alpha, alpha_v=alpha, distribution=distribution)
            image = panels.picture(ball(copper, sky), "direct", spp=SAMPLES)
            shown.append(panels.Panel(f"alpha {alpha:g}", 0.7 * image.mean, name))
    panels.row(path, shown, columns=len(ALPHAS), scale=2)
