"""Pictures as files: what each format holds, and what it says that it cannot show."""

from __future__ import annotations

import json

import numpy as np
import pytest

import raylab
from raylab.errors import UserError
from raylab.image import Image
from raylab.io import picture
from raylab.io.image_file import decode_srgb

HALF_A_STEP = 0.5 / 255.0  # of 8 bits


@pytest.fixture
def image() -> Image:
    rng = np.random.default_rng(7)
    mean, error = rng.random((5, 4, 3)), rng.random((5, 4, 3))
    report = {"sampler": "sobol", "seconds": {"render": 0.25}}
    return Image(mean, error, np.full((5, 4), 16.0), invalid_samples=3, complete=False, report=report)


def read_channels(path):
    import OpenImageIO

    file = OpenImageIO.ImageInput.open(str(path))
    pixels, spec = file.read_image(), file.spec()
    file.close()
    return {name: pixels[..., k] for k, name in enumerate(spec.channelnames)}, spec


def test_npz_holds_everything_exactly(image, tmp_path):
    raylab.save(image, tmp_path / "a.npz")
    with np.load(tmp_path / "a.npz", allow_pickle=False) as arrays:
        for name in ("mean", "standard_error", "samples"):
            np.testing.assert_array_equal(arrays[name], getattr(image, name))
        report = json.loads(str(arrays["report"]))
    counts = {"invalid_samples": 3, "invalid_rays": 0, "degenerate_samples": 0, "complete": False}
    share = 3.0 / (5 * 4 * 16 + 3)
    bounds = {"invalid_samples": share, "invalid_rays": 0.0, "degenerate_samples": 0.0}
    assert report == {**image.report, **counts, "bias_bounds": bounds}


def test_exr_has_named_channels(image, tmp_path):
    raylab.save(image, tmp_path / "a.exr")
    channels, spec = read_channels(tmp_path / "a.exr")
    assert set(channels) == {*"RGB", *(f"standard_error.{c}" for c in "RGB"), "samples"}
    for k, c in enumerate("RGB"):
        np.testing.assert_array_equal(channels[c], image.mean[..., k].astype(np.float32))
        np.testing.assert_array_equal(channels[f"standard_error.{c}"], image.standard_error[..., k].astype(np.float32))
    assert json.loads(spec["raylab"])["sampler"] == "sobol"


def test_png_shows_the_mean_in_srgb(image, tmp_path):
    assert picture.write(image, tmp_path / "a.png") == ""
    channels, _ = read_channels(tmp_path / "a.png")
    shown = np.stack([channels[c] for c in "RGB"], axis=-1)
    back = decode_srgb(np.clip(shown - HALF_A_STEP, 0.0, 1.0)), decode_srgb(np.clip(shown + HALF_A_STEP, 0.0, 1.0))
    rounding = np.finfo(np.float32).eps
    assert np.all((image.mean >= back[0] - rounding) & (image.mean <= back[1] + rounding))


def test_png_says_what_it_cannot_show(image, tmp_path):
    image.mean[0, 0] = 1.5
    image.mean[1, 1, 2] = np.nan
    sentence = picture.write(image, tmp_path / "a.png")
    assert "1 of 20 pixels have no finite value" in sentence
    assert "1 of 20 pixels are darker than 0 or brighter than 1" in sentence


@pytest.mark.parametrize("name", ["a.jpg", "a", "missing/a.npz"])
def test_names_that_cannot_be_written(image, tmp_path, name):
    with pytest.raises(UserError, match="cannot write"):
        raylab.save(image, tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_failed_write_leaves_the_old_file(image, tmp_path, monkeypatch):
    raylab.save(image, tmp_path / "a.npz")
    before = (tmp_path / "a.npz").read_bytes()

    def break_off(file, **arrays):
        file.write_bytes(b"half")
        raise KeyboardInterrupt

    monkeypatch.setattr(np, "savez", break_off)
    with pytest.raises(KeyboardInterrupt):
        raylab.save(image, tmp_path / "a.npz")
    assert (tmp_path / "a.npz").read_bytes() == before
    assert [path.name for path in tmp_path.iterdir()] == ["a.npz"]


def test_report_is_strict_json():
    text = picture.plain(
        {"a": np.array([1.0, np.nan]), "b": np.float64(np.inf), "c": (np.int64(2),), "d": np.bool_(True)}
    )
    assert json.dumps(text, allow_nan=False) == '{"a": [1.0, null], "b": null, "c": [2], "d": true}'
