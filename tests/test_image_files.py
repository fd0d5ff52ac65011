"""Images keep their values through files, and files are there in full or not at all."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import OpenImageIO
import pytest

from raylab.atomic import replacing
from raylab.errors import UserError
from raylab.io.image_file import decode_srgb, encode_srgb, faulty_texel, read_image, write_exr, write_png

EPS = np.finfo(float).eps


def save(path: Path, pixels: np.ndarray, kind: str, names: tuple[str, ...], **attributes: object) -> Path:
    """Write (h, w, c) `pixels` with OpenImageIO itself."""
    spec = OpenImageIO.ImageSpec(pixels.shape[1], pixels.shape[0], pixels.shape[2], kind)
    spec.channelnames = names
    for key, value in attributes.items():
        spec.attribute(key.replace("__", ":"), value)
    image = OpenImageIO.ImageOutput.create(str(path))
    assert image.open(str(path), spec)
    assert image.write_image(pixels)
    assert image.close()
    return path


def srgb(v: float) -> float:
    """IEC 61966-2-1, decoding."""
    return v / 12.92 if v <= 0.04045 else ((v + 0.055) / 1.055) ** 2.4


def test_decoding_is_the_standard() -> None:
    levels = np.arange(256) / 255
    assert np.allclose(decode_srgb(levels), [srgb(v) for v in levels], rtol=16 * EPS, atol=0)


def test_all_256_levels_survive_encoding() -> None:
    levels = np.arange(256)
    assert encode_srgb(decode_srgb(np.repeat(levels[:, None], 3, 1) / 255)).tolist() == [[k] * 3 for k in levels]


def test_encoding_rounds_to_the_nearest_level() -> None:
    middle = np.array([srgb((k + 0.5) / 255) for k in range(255)])
    below, above = (encode_srgb(np.repeat((middle * f)[:, None], 3, 1))[:, 0] for f in (1 - 1e-9, 1 + 1e-9))
    assert below.tolist() == list(range(255))
    assert above.tolist() == list(range(1, 256))


def test_png_round_trip_of_all_levels(tmp_path: Path) -> None:
    levels = np.arange(768).reshape(16, 16, 3) % 256
    report = write_png(tmp_path / "a.png", decode_srgb(levels / 255))
    assert report == (0, 0)
    assert np.array_equal(encode_srgb(read_image(tmp_path / "a.png")), levels)
    raw = read_image(tmp_path / "a.png", raw=True)
    assert np.array_equal(raw, levels / 255)


def test_png_counts_what_it_cannot_show(tmp_path: Path) -> None:
    picture = np.full((3, 4, 3), 0.5)
    picture[0, 0, 1] = np.nan
    picture[0, 1] = np.inf
    picture[1, 0, 2] = 1.5
    picture[1, 1, 0] = -0.1
    picture[2, 3] = 1.0
    assert write_png(tmp_path / "a.png", picture) == (2, 2)
    shown = encode_srgb(read_image(tmp_path / "a.png"))
    assert shown[0, :2].tolist() == [[255, 0, 255]] * 2
    assert shown[1, 0, 2] == 255
    assert shown[1, 1, 0] == 0
    assert shown[2, 3].tolist() == [255] * 3


def test_exr_keeps_float32_channels_names_and_metadata(tmp_path: Path) -> None:
    rng = np.random.default_rng(1)
    mean, error = (rng.exponential(size=(5, 7, 3)).astype(np.float32) for _ in range(2))
    mean[0, 0] = 1e30
    count = np.arange(35.0).reshape(5, 7)
    channels = {"": mean, "standard_error": error, "samples": count}
    write_exr(tmp_path / "a.exr", channels, {"raylab:shade": "area", "Software": "raylab"})
    image = OpenImageIO.ImageInput.open(str(tmp_path / "a.exr"))
    names = list(image.spec().channelnames)
    pixels = image.read_image(0, 0, 0, len(names), OpenImageIO.FLOAT)
    assert str(image.spec().format) == "float"
    assert image.spec().getattribute("raylab:shade") == "area"
    image.close()
    expected = ["R", "G", "B", *(f"standard_error.{c}" for c in "RGB"), "samples"]
    assert sorted(names) == sorted(expected)
    values = {name: pixels[..., names.index(name)] for name in names}
    assert np.array_equal(np.stack([values[c] for c in "RGB"], -1), mean)
    assert np.array_equal(np.stack([values[f"standard_error.{c}"] for c in "RGB"], -1), error)
    assert np.array_equal(values["samples"], count)
    assert np.array_equal(read_image(tmp_path / "a.exr"), mean)


def test_float_images_are_linear_with_row_0_at_the_top(tmp_path: Path) -> None:
    pixels = np.arange(24, dtype=np.float32).reshape(2, 4, 3)
    path = save(tmp_path / "a.exr", pixels, "float", ("R", "G", "B"))
    assert np.array_equal(read_image(path), pixels)
    path = save(tmp_path / "a.hdr", pixels, "float", ("R", "G", "B"))
    # RGBE shares the exponent of the largest channel: 8 bits of mantissa, truncated
    assert np.all(np.abs(read_image(path) - pixels) <= pixels.max(axis=-1, keepdims=True) * 2.0**-7)


def test_grey_expands_and_alpha_is_dropped_without_being_multiplied(tmp_path: Path) -> None:
    grey = np.array([[[0], [128], [255]]], dtype=np.uint8)
    assert np.allclose(
        read_image(save(tmp_path / "g.png", grey, "uint8", ("Y",))),
        np.repeat([[[srgb(0)], [srgb(128 / 255)], [srgb(1)]]], 3, -1),
        rtol=16 * EPS,
    )
    rgba = np.array([[[200, 100, 50, 0], [200, 100, 50, 128]]], dtype=np.uint8)
    path = save(tmp_path / "a.png", rgba, "uint8", ("R", "G", "B", "A"), oiio__UnassociatedAlpha=1)
    expected = [srgb(v / 255) for v in (200, 100, 50)]
    assert np.allclose(read_image(path), [[expected, expected]], rtol=16 * EPS)


def test_16_bit_and_jpeg_images_are_decoded(tmp_path: Path) -> None:
    wide = np.array([[[0, 1000, 65535], [40000, 300, 2]]], dtype=np.uint16)
    path = save(tmp_path / "a.png", wide, "uint16", ("R", "G", "B"))
    assert np.allclose(read_image(path), np.vectorize(srgb)(wide / 65535), rtol=16 * EPS)
    flat = np.full((16, 16, 3), 128, dtype=np.uint8)
    path = save(tmp_path / "a.jpg", flat, "uint8", ("R", "G", "B"))
    assert np.allclose(read_image(path), srgb(128 / 255), rtol=16 * EPS)  # a flat grey block has no loss


def test_unreadable_images_are_refused(tmp_path: Path) -> None:
    (tmp_path / "text.png").write_text("this is no picture")
    whole = save(tmp_path / "whole.exr", np.ones((64, 64, 3), np.float32), "float", ("R", "G", "B"))
    (tmp_path / "cut.exr").write_bytes(whole.read_bytes()[:400])
    save(tmp_path / "depth.exr", np.ones((2, 2, 2), np.float32), "float", ("near", "far"))
    for name in ("missing.png", "text.png", "cut.exr", "depth.exr"):
        with pytest.raises(UserError, match=name):
            read_image(tmp_path / name)


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, -1e-6, 1.5])
def test_faulty_texels_are_named_with_their_place(value: float) -> None:
    pixels = np.full((4, 5, 3), 0.5)
    assert faulty_texel(pixels, 1.0) == ""
    pixels[2, 3, 1] = pixels[3, 4, 0] = value
    assert "column 3, row 2" in faulty_texel(pixels, 1.0)
    assert "2 such pixels" in faulty_texel(pixels, 1.0)
    assert (faulty_texel(pixels) == "") == (value == 1.5)


def interrupted(target: Path) -> None:
    with replacing(target) as beside:
        beside.write_text("half")
        raise RuntimeError


def test_files_are_complete_or_absent(tmp_path: Path) -> None:
    target = tmp_path / "a.txt"
    with replacing(target) as beside:
        beside.write_text("new")
        assert beside.suffix == ".txt"
        assert beside.parent == tmp_path
        assert not target.exists()
    assert target.read_text() == "new"
    with pytest.raises(RuntimeError):
        interrupted(target)
    assert target.read_text() == "new"
    assert [path.name for path in tmp_path.iterdir()] == ["a.txt"]


def test_bad_targets_are_refused(tmp_path: Path) -> None:
    picture = np.zeros((2, 2, 3))
    (tmp_path / "folder.png").mkdir()
    for name in ("missing/a.png", "a.jpg", "folder.png"):
        with pytest.raises(UserError, match=name):
            write_png(tmp_path / name, picture)
    with pytest.raises(UserError, match=r"\.exr"):
        write_exr(tmp_path / "a.png", {"": picture}, {})
    assert [path.name for path in tmp_path.iterdir()] == ["folder.png"]


@pytest.mark.parametrize(
    "channels",
    [{}, {"": np.zeros((2, 2))}, {"a": np.zeros(3)}, {"a": np.zeros((2, 2)), "b": np.zeros((2, 3))}],
)
def test_bad_channels_are_refused(channels: dict[str, np.ndarray], tmp_path: Path) -> None:
    with pytest.raises(UserError):
        write_exr(tmp_path / "a.exr", channels, {})
    with pytest.raises(UserError, match="shape"):
        write_png(tmp_path / "a.png", np.zeros((2, 2)))
