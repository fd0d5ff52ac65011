"""Every reference scene: complete, readable, and what it renders agrees with its truth within joint standard errors."""

from __future__ import annotations

import json
import math
import sys
from pathlib import Path

import numpy as np
import pytest
from scipy import stats

import raylab
from raylab.io.image_file import read_image
from raylab.io.mesh_file import read_mesh

FOLDER = Path(__file__).parents[1] / "reference_scenes"
SCENES = sorted(path.parent.name for path in FOLDER.glob("*/scene.xml"))
PICTURES = [name for name in SCENES if not name.startswith("cs667")]
SIGMAS = 4.5
ALPHA = 1e-6  # false alarms of each chi-square test; seeds are fixed
SPP = 64
VARIANCE_SAMPLES = 256  # behind the variances in a reference
TILE = 8  # pixels along a side: 64 pixels x 64 samples make a mean that is close enough to normal
compiled = pytest.mark.compiled(reason="half a million samples each")


@pytest.fixture
def scripts(monkeypatch):
    """The folder of the scenes on the path, for the scripts in it."""
    monkeypatch.setattr(sys, "path", [str(FOLDER), *sys.path])


def truth(name):
    return json.loads((FOLDER / name / "truth.json").read_text(encoding="utf-8"))


def reference(name):
    with np.load(FOLDER / name / truth(name)["reference"]) as arrays:
        return {key: arrays[key].astype(np.float64) for key in arrays.files}


def load(name, **parameters):
    return raylab.load(FOLDER / name / "scene.xml", {**truth(name)["parameters"], **parameters})


# --- what is there ---


def test_there_are_at_least_ten_scenes_and_they_are_small():
    assert len(SCENES) >= 10
    assert {path.name for path in FOLDER.iterdir() if path.is_dir()} - {"__pycache__"} == set(SCENES)
    assert sum(path.stat().st_size for path in FOLDER.rglob("*") if path.is_file()) < 8e6


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_is_complete(name):
    files = {path.name for path in (FOLDER / name).iterdir()}
    assert {"scene.xml", "README.md", "truth.json", "reference.npz"} <= files
    scene, arrays, told = load(name), reference(name), truth(name)
    assert scene.warnings == []
    camera = scene.description.camera
    for key in ("mean", "standard_error", "variance"):
        assert arrays[key].shape == (camera.height, camera.width, 3)
        assert np.all(np.isfinite(arrays[key]) & (arrays[key] >= 0.0))
    assert arrays["samples"] == int(arrays["samples"]) > 0
    if "mean" in told:
        np.testing.assert_allclose(arrays["mean"].mean(axis=(0, 1)), told["mean"], rtol=2.0**-23)  # kept as float32
    readme = (FOLDER / name / "README.md").read_text(encoding="utf-8")
    for file in files - {"README.md"}:
        assert file in readme, f"{file} is not explained"


@pytest.mark.parametrize("name", SCENES)
def test_the_scene_file_itself_is_a_picture_of_the_same_shape(name):
    """Without parameters: as large as a lecture needs, and of the same sides."""
    picture, small = (
        raylab.load(FOLDER / name / "scene.xml", p).description.camera for p in ({}, truth(name)["parameters"])
    )
    assert picture.width * small.height == picture.height * small.width
    if name in PICTURES:
        assert 320 <= picture.width <= 640


# --- what it renders ---


def tiles(image):
    """Sums over TILE x TILE pixels, (n, 3); what is left over at the right and below is its own tile."""
    rows, columns = (np.arange(0, n, TILE) for n in image.shape[:2])
    return np.add.reduceat(np.add.reduceat(image, rows, axis=0), columns, axis=1).reshape(-1, 3)


@compiled
@pytest.mark.parametrize("name", PICTURES)
def test_a_picture_agrees_with_its_reference(name):
    """The whole image within SIGMAS joint standard errors, and chi-square over tiles, each channel for itself.

    The variance of a sample is pooled from the one kept with the reference and the picture's own: light that reaches
    a pixel in one sample of a thousand shows in one of them and not in the other.
    """
    shade = truth(name).get("strategy", truth(name).get("shade", "direct"))
    image, known = raylab.render(load(name), shade, sampler="independent", spp=SPP, seed=1), reference(name)
    assert image.invalid_samples == image.invalid_rays == 0
    kept, own = VARIANCE_SAMPLES * known["variance"], SPP * image.standard_error**2 * SPP
    variance = (kept + own) / (VARIANCE_SAMPLES + SPP) / SPP + known["standard_error"] ** 2
    difference = image.mean - known["mean"]
    deviation, error = np.abs(difference.sum(axis=(0, 1))), np.sqrt(variance.sum(axis=(0, 1)))
    assert np.all(deviation <= SIGMAS * error), f"off by {deviation / error} standard errors"
    sums, spread, light = tiles(difference), tiles(variance), tiles(known["mean"])
    sharp = spread <= (2.0**-20 * light) ** 2  # known better than float32 keeps it: the sky, a light, the dark
    np.testing.assert_allclose(sums[sharp], 0.0, atol=2.0**-20 * light.max())
    chi_square = np.where(sharp, 0.0, sums**2 / np.where(sharp, 1.0, spread)).sum(axis=0)
    p = stats.chi2.sf(chi_square, (~sharp).sum(axis=0))
    assert np.all(p > ALPHA), f"chi-square {chi_square} over {(~sharp).sum(axis=0)} tiles, p {p}"


@compiled
@pytest.mark.parametrize("name", [name for name in SCENES if name.startswith("cs667")])
def test_cs667_number(name):
    """Within four standard errors, at a relative standard error of 1e-4 or better: sixteen pictures tell it."""
    number = {
        "cs667_sphere_normal": 0.4,
        "cs667_sphere_grazing": 0.171847,
        "cs667_triangle_normal": 0.162163,
    }[name]
    scene, exact = load(name), truth(name)["mean"]
    assert np.round(exact, 6) == pytest.approx([number] * 3, abs=1e-12)
    means = np.array([raylab.render(scene, sampler="sobol", spp=16384, seed=seed).image_mean for seed in range(16)])
    error = means.std(axis=0, ddof=1) / math.sqrt(len(means))
    assert np.all(error <= 1e-4 * number)
    assert np.all(np.abs(means.mean(axis=0) - exact) <= 4.0 * error)


# --- what the scenes claim ---


def test_lights_of_the_soft_shadows_have_one_power():
    """The sizes and radiances that the file suggests."""
    text = (FOLDER / "soft_shadows" / "scene.xml").read_text(encoding="utf-8")
    for size, radiance in ((0.05, 8000), (0.25, 320), (0.5, 80), (1, 20)):
        assert f"{size} and {radiance}" in text
        lamp = next(
            s for s in load("soft_shadows", size=size, radiance=radiance).description.shapes if s.radiance is not None
        )
        area = 4.0 * np.linalg.norm(lamp.to_world[:3, 0]) * np.linalg.norm(lamp.to_world[:3, 1])
        np.testing.assert_allclose(area * lamp.radiance, 80.0, rtol=1e-12)


def test_lights_of_the_plates_have_one_power():
    lamps = [s for s in load("veach_plates").description.shapes if s.radiance is not None]
    assert len({lamp.radius for lamp in lamps}) == len(lamps) == 4
    power = [lamp.radiance @ [0.2126, 0.7152, 0.0722] * lamp.radius**2 for lamp in lamps]
    np.testing.assert_allclose(power, 0.4, rtol=2e-6)  # six digits in the file


def test_the_sun_is_a_hundred_thousand_times_brighter_than_the_sky():
    luminance = read_image(FOLDER / "hdr_sky" / "sky.exr") @ [0.2126, 0.7152, 0.0722]
    row, column = np.unravel_index(luminance.argmax(), luminance.shape)
    others = np.delete(luminance.ravel(), row * luminance.shape[1] + column)
    assert luminance[row, column] == pytest.approx(1e5, rel=1e-6)
    assert others.max() < 10.0
    rows = np.arange(len(luminance) // 2)
    weight = np.sin(np.pi * rows / (len(luminance) - 1))
    mean = (luminance[rows].sum(axis=1) - 1e5 * (rows == row)) @ weight / (weight.sum() * luminance.shape[1])
    assert mean == pytest.approx(1.0, rel=0.01)  # the sun hides one texel of it


def test_assets_are_what_the_script_makes(scripts, tmp_path, monkeypatch, capsys):
    import make_assets

    for name in SCENES:
        (tmp_path / name).mkdir()
    monkeypatch.setattr(make_assets, "HERE", tmp_path)
    make_assets.main()
    made = [path.relative_to(tmp_path) for path in tmp_path.rglob("*.*")]
    kept = {p.relative_to(FOLDER) for p in FOLDER.rglob("*") if p.suffix in (".obj", ".ply", ".png", ".exr")}
    kept |= {p.relative_to(FOLDER) for p in FOLDER.glob("*/*.xml") if p.name != "scene.xml"}
    assert set(made) == kept
    assert len(capsys.readouterr().out.splitlines()) == len(made)
    for file in made:
        if file.suffix in (".obj", ".xml"):
            assert (tmp_path / file).read_text() == (FOLDER / file).read_text()
        elif file.suffix == ".ply":
            for a, b in zip(read_mesh(tmp_path / file), read_mesh(FOLDER / file), strict=True):
                assert (a is None and b is None) or np.allclose(a, b, rtol=0.0, atol=1e-6)
        else:
            np.testing.assert_allclose(read_image(tmp_path / file), read_image(FOLDER / file), rtol=1e-6, atol=1e-2)
