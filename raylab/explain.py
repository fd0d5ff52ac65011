"""What a scene's kernel contains, what was left out of it, and why; said in sentences and as data."""

from __future__ import annotations

import sys
from typing import Any, NamedTuple

from raylab.scene import FEATURES, Scene


class Part(NamedTuple):
    """A feature in words: what the kernel does when it is there, and why it is not."""

    there: str
    absent: str


PARTS = {
    "area lights": Part("chooses points on the area lights", "no surface emits light"),
    "point lights": Part("sums over the point lights", "the scene has no point light"),
    "directional lights": Part("sums over the directional lights", "the scene has no directional light"),
    "environment": Part("looks up the environment for rays that leave the scene", "the scene has no environment"),
    "glossy BRDF": Part("evaluates and samples the lobes of glossy surfaces", "all surfaces are diffuse"),
    "mirrors and glass": Part("sends light on by Fresnel's formulas and Snell's law", "no surface is smooth"),
    "textures": Part("interpolates (u, v) and looks up bitmaps", "no surface has a bitmap"),
    "smooth normals": Part("interpolates vertex normals", "no mesh has vertex normals"),
    "spheres, disks and cylinders": Part("recomputes hits on curved shapes", "all shapes are triangle meshes"),
    "lens": Part("draws a point on the aperture for each eye ray", "the camera is a pinhole"),
    "motion": Part("draws a time for each eye ray", "nothing moves"),
}

RECURSION = "follows up to {} rays in a row, eye ray and shadow ray included; what would come by more is left out"

MODULES = {
    "colour": "spectra, sRGB colours and .png files",
    "OpenImageIO": "image files",
    "trimesh": "mesh files",
    "scipy.stats": "the statistics of a study",
    "matplotlib": "plots",
    "skimage": "image comparison",
    "jinja2": "reports",
}


def left_out(scene: Scene) -> dict[str, list[str]]:
    """`features` that the kernel does not contain, `modules` that this process has not imported so far."""
    return {
        "features": [name for name in FEATURES if name not in scene.features],
        "modules": [name for name in MODULES if name not in sys.modules],
    }


def explain(scene: Scene, shade: str, sampler: str) -> str:
    """Plain sentences on the kernel that renders `scene` with `shade` and `sampler`."""
    there = [name for name in FEATURES if name in scene.features]
    lines = [
        f"The kernel is compiled for shade {shade!r}, sampler {sampler!r} and what the scene has"
        + (":" if there else ", which is none of the optional parts."),
        *(f"  + {name}: it {PARTS[name].there}." for name in there),
        *_motion(scene),
        *([f"  + recursion: it {RECURSION.format(scene.data.max_depth)}."] if shade == "basic" else []),
        "Left out, with no test, no memory and no random number spent on it:",
        *(f"  - {name}: {PARTS[name].absent}." for name in FEATURES if name not in scene.features),
        "Modules not imported:",
        *(f"  - {name}, for {MODULES[name]}." for name in left_out(scene)["modules"]),
    ]
    return "\n".join(lines)


def _motion(scene: Scene) -> list[str]:
    if "motion" not in scene.features:
        return []
    return [
        f"    Moving meshes stand within {scene.motion_error:.2g} scene units of their path, all else exactly on it."
    ]


def measured(scene: Scene, image: Any, shade: str, load_seconds: float) -> dict[str, Any]:
    """What `raylab render --json` prints: the run, its result and its cost, as one JSON object."""
    from raylab.io.picture import plain

    camera, report = scene.description.camera, image.report
    taken, render_seconds = report["rays"]["camera"], report["seconds"]["render"]
    spp = taken / (camera.width * camera.height)
    return {
        "scene": str(scene.description.path or scene.description.name),
        "shade": shade,
        "sampler": report["sampler"],
        "spp": int(spp) if spp == int(spp) else spp,
        "seed": report["seed"],
        "threads": report["threads"],
        "width": camera.width,
        "height": camera.height,
        "mean": plain(image.image_mean),
        "standard_error": plain(image.image_standard_error),
        "relative_error": plain(image.relative_error),
        "seconds": {"load": load_seconds, **report["seconds"]},
        "samples_per_second": plain(taken / render_seconds if render_seconds > 0.0 else float("nan")),
        "rays": report["rays"],
        "invalid_samples": image.invalid_samples,
        "invalid_rays": image.invalid_rays,
        "degenerate_samples": image.degenerate_samples,
        "bias_bounds": image.bias_bounds,
        "complete": image.complete,
        "warnings": list(scene.warnings),
        "left_out": left_out(scene),
    }
