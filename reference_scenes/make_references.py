"""Make the reference of every scene: what the study and the tests compare with.

    python reference_scenes/make_references.py [--scene NAME]

Writes into each folder

- `reference.npz`: `mean` (h, w, 3) and `standard_error` (h, w, 3) of each pixel, `variance` (h, w, 3) of one
  independent sample of `direct` (or of `strategy`) there, all float32, and `samples`, how many the mean is made of;
- `truth.json`: `source` in words; `parameters`, with which the scene has the size of the reference; `reference`, the
  name of the file; `shade`, where it is not `direct`; `strategy`, where `direct` shows the same but has no variance;
  and where a closed form gives the whole image, its exact `mean` [r, g, b] and `standard_error`.

A closed form is averaged over each pixel: a smooth one by Gauss-Legendre quadrature, to all digits, one with outlines
in it at jittered points, whose spread is its standard error. Everything else is rendered: 16 pictures of 256
Owen-scrambled Sobol' samples a pixel, whose spread is the standard error.
"""

from __future__ import annotations

import argparse
import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import numpy.typing as npt

import raylab
from raylab.atomic import replacing

sys.path.insert(0, str(Path(__file__).parent))
import pictures

Array = npt.NDArray[np.float64]
Form = Callable[[Array, Array], Array]
HERE = Path(__file__).parent
SIZES = {"cornell_box": (96, 96), "soft_shadows": (120, 90), "hdr_sky": (120, 80), "veach_plates": (128, 96),
         "mirror_balls": (60, 40), "many_lights": (90, 60)}  # fmt: skip
SHADES = {"mirror_balls": "basic"}  # where it is not `direct`
STRATEGIES = {"touching_light": "area_solid_angle"}  # where `direct` has no variance
PICTURES = 16  # of which the spread is the standard error
SAMPLES = 256  # of each picture
SEED = 20_000  # the first picture's, far from the small seeds that tests and studies use
VARIANCE_SAMPLES = 256
JITTERED = 8  # points along each side of a pixel, in each of PICTURES averages of a closed form


def size(name: str) -> dict[str, int]:
    """The parameters of the scene at the size of its reference."""
    if name.startswith("cs667"):
        return {}
    width, height = SIZES.get(name, (120, 80))
    return {"width": width, "height": height}


def rendered(scene: raylab.Scene, shade: str) -> tuple[Array, Array, int]:
    """Mean and standard error over PICTURES renders with seeds of their own, and the samples of a pixel."""
    means = [raylab.render(scene, shade, sampler="sobol", spp=SAMPLES, seed=SEED + i).mean for i in range(PICTURES)]
    return (*spread(np.stack(means)), PICTURES * SAMPLES)


def integrated(scene: raylab.Scene, radiance: Form) -> tuple[Array, Array, int]:
    """The mean of a smooth closed form over each pixel by 8 x 8 Gauss-Legendre points; its error is rounding."""
    nodes, weights = np.polynomial.legendre.leggauss(8)
    rule = list(zip(0.5 + 0.5 * nodes, 0.5 * weights, strict=True))
    mean = np.sum([u * v * pictures.view(scene, x, y, radiance) for x, u in rule for y, v in rule], axis=0)
    return mean, np.zeros_like(mean), len(rule) ** 2


def averaged(scene: raylab.Scene, radiance: Form) -> tuple[Array, Array, int]:
    """Mean and standard error over PICTURES averages of a closed form at jittered points of each pixel."""
    rng = np.random.default_rng(SEED)
    cells = [(i, j) for i in range(JITTERED) for j in range(JITTERED)]
    means = []
    for _ in range(PICTURES):
        points = (np.array(cells) + rng.random((len(cells), 2))) / JITTERED
        means.append(np.mean([pictures.view(scene, x, y, radiance) for x, y in points], axis=0))
    return (*spread(np.stack(means)), PICTURES * len(cells))


def spread(means: Array) -> tuple[Array, Array]:
    """Mean and standard error of independent means, along axis 0."""
    return means.mean(axis=0), means.std(axis=0, ddof=1) / np.sqrt(len(means))


def make(name: str) -> None:
    """Write the reference and the truth of one scene, and say what came out."""
    start, parameters = time.perf_counter(), size(name)
    scene = raylab.load(HERE / name / "scene.xml", parameters)
    form, shade = pictures.PICTURES.get(name), SHADES.get(name, "direct")
    if form is None:
        mean, error, samples = rendered(scene, shade)
    else:
        mean, error, samples = (averaged if parameters else integrated)(scene, form)
    strategy = STRATEGIES.get(name, shade)
    noisy = raylab.render(scene, strategy, sampler="independent", spp=VARIANCE_SAMPLES, seed=SEED)
    variance = noisy.standard_error**2 * VARIANCE_SAMPLES
    with replacing(HERE / name / "reference.npz") as path:
        columns = {"mean": mean, "standard_error": error, "variance": variance}
        np.savez_compressed(path, samples=samples, **{k: v.astype(np.float32) for k, v in columns.items()})
    truth: dict[str, object] = {"reference": "reference.npz", "parameters": parameters}
    if shade != "direct":
        truth["shade"] = shade
    if strategy != shade:
        truth["strategy"] = strategy
    if form:
        truth["mean"] = [float(v) for v in mean.mean(axis=(0, 1))]
        truth["standard_error"] = [float(v) for v in np.sqrt((error**2).sum(axis=(0, 1))) / error[..., 0].size]
        truth["source"] = str(form.__doc__).splitlines()[0]
    else:
        truth["source"] = f"{PICTURES} renders of {SAMPLES} samples a pixel: make_references.py --scene {name}"
    with replacing(HERE / name / "truth.json") as path:
        path.write_text(json.dumps(truth, indent=2) + "\n", encoding="utf-8")
    relative = np.sqrt((error**2).mean()) / mean.mean()
    size_kb = (HERE / name / "reference.npz").stat().st_size // 1000
    print(
        f"{name}: {samples} samples a pixel, mean {mean.mean(axis=(0, 1))}, relative standard error of a pixel "
        f"{relative:.1e}, {size_kb} kB, {time.perf_counter() - start:.0f} s",
        flush=True,
    )


def names() -> list[str]:
    """All scenes, in alphabetical order."""
    return sorted(path.parent.name for path in HERE.glob("*/scene.xml"))


def main() -> None:
    parser = argparse.ArgumentParser(description="Make the references of the scenes.")
    parser.add_argument("--scene", choices=names(), help="this one only")
    chosen = parser.parse_args().scene
    for name in [chosen] if chosen else names():
        make(name)


if __name__ == "__main__":
    main()
