"""One scene file, two renderers: Mitsuba's pictures, and how far raylab's may be from them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from scipy import stats
from scipy.ndimage import maximum_filter

import raylab

WIDTH, HEIGHT = 48, 36
REPEATS = 24  # pictures of Mitsuba's, from which its standard errors are taken
ALPHA = 1e-6  # probability of a false alarm, for each scene
FILM = """<film type="hdrfilm">
            <integer name="width" value="$width"/><integer name="height" value="$height"/><rfilter type="box"/>
        </film>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>"""


def parameters(text: str, spp: int) -> dict[str, str]:
    """Those of width, height and spp that the file knows."""
    wanted = {"width": str(WIDTH), "height": str(HEIGHT), "spp": str(spp)}
    return {name: value for name, value in wanted.items() if f"${name}" in text}


def theirs(mitsuba, path: Path, spp: int) -> tuple[np.ndarray, np.ndarray]:
    """Mean and standard error (h, w, 3) of Mitsuba's pictures."""
    scene = mitsuba.load_file(str(path), **parameters(path.read_text(), spp))
    pictures = np.array([np.array(mitsuba.render(scene, spp=spp, seed=k))[..., :3] for k in range(REPEATS)], float)
    return pictures.mean(axis=0), stats.sem(pictures, axis=0)


def agree(mitsuba, path: Path, spp: int, shade: str = "direct") -> None:
    expected, error = theirs(mitsuba, path, spp)
    scene = raylab.load(path, parameters(path.read_text(), spp))
    image = raylab.render(scene, shade, sampler="independent", spp=REPEATS * spp, seed=7)
    assert image.mean.shape == expected.shape
    rounding = 4e-5 * np.abs(expected) + 1e-6  # of float32, in which Mitsuba works and sums up
    # Where a filter's tail just reaches something bright, few samples or none hit it, and the standard error says 0:
    # a pixel's mean cannot be known better than the step that one sample makes.
    step = maximum_filter(expected, size=(5, 5, 1)) / (REPEATS * spp)
    joint = np.hypot(np.hypot(image.standard_error, error), step)
    z = np.maximum(np.abs(image.mean - expected) - rounding, 0.0) / np.maximum(joint, 1e-300)
    limit = stats.t.isf(ALPHA / 2 / z.size, REPEATS - 1)
    worst = np.unravel_index(np.argmax(z), z.shape)
    assert z.max() < limit, f"{z.max():.1f} standard errors at {worst}: {image.mean[worst]} and {expected[worst]}"
    whole = (image.image_mean - expected.mean(axis=(0, 1))) / np.hypot(
        image.image_standard_error, np.sqrt((error**2).sum(axis=(0, 1))) / error[..., 0].size
    )
    assert np.abs(whole).max() < stats.norm.isf(ALPHA / 6)
