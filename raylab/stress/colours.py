"""Colours: what a picture file cannot show, and what a curve does at its ends."""

from __future__ import annotations

import math
import tempfile
import warnings
from pathlib import Path

import numpy as np
import numpy.typing as npt

from raylab import description as d
from raylab.io.image_file import decode_srgb, encode_srgb, read_image, write_exr, write_png
from raylab.stats.tails import rule_of_three
from raylab.stress.case import Found, case
from raylab.stress.oracle import exact, worst

Array = npt.NDArray[np.float64]
LINEAR = 0.0031308  # IEC 61966-2-1: the end of the straight part


def grey(values: npt.ArrayLike) -> Array:
    """Values as grey pixels (n, 3)."""
    return np.repeat(np.asarray(values, float)[..., None], 3, axis=-1)


def usual_srgb(x: npt.ArrayLike) -> npt.NDArray[np.uint8]:
    """The curve times 255 as a byte, without a thought of what lies outside [0, 1]."""
    x = np.asarray(x, float)
    with np.errstate(invalid="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        curve = np.where(x <= LINEAR, 12.92 * x, 1.055 * np.abs(x) ** (1.0 / 2.4) - 0.055)
        return np.nan_to_num(curve * 255.0, posinf=0.0).astype(np.int64).astype(np.uint8)


@case(
    "H01", "-0.1, 1.001, 2, NaN and infinity as bytes", usual="the curve times 255, cast",
    rule="clamped first; magenta and a warning for what is not finite", truth="0, 255, 255, magenta, magenta",
    unit="wrong pixels", allowed=0.0,
)  # fmt: skip
def outside() -> Found:
    values, magenta = [-0.1, 1.001, 2.0, math.nan, math.inf], [255, 0, 255]
    truth = [[0] * 3, [255] * 3, [255] * 3, magenta, magenta]
    ours = (encode_srgb(grey(values)) != truth).any(axis=1).sum()
    with tempfile.TemporaryDirectory() as folder:
        report = write_png(Path(folder) / "x.png", grey(values)[None])
    ours += report != (2, 3)
    return Found(float(ours), float((grey(usual_srgb(values)) != truth).any(axis=1).sum()))


@case(
    "H02", "1 as a byte", usual="1.055 1^(1 / 2.4) - 0.055 = 0.9999999999999999, cast",
    rule="the bytes whose steps lie below", truth="255", unit="error of the byte", allowed=0.0,
)  # fmt: skip
def white() -> Found:
    return Found(255.0 - encode_srgb(grey([1.0]))[0, 0], 255.0 - float(usual_srgb([1.0])[0]))


@case(
    "H03", "a million values around the end of the straight part of sRGB's curve, and from 0 to 1",
    usual="the curve times 255, cast", rule="the steps of the bytes, which are in order", truth="monotone",
    unit="places where a larger value has a smaller byte, or a larger level of 8 or 16 bits a smaller value",
    allowed=0.0,
)  # fmt: skip
def monotone() -> Found:
    x = np.concatenate([LINEAR + np.linspace(-1e-6, 1e-6, 500_000), np.linspace(0.01, 1.0, 500_000)])
    down = sum(int((np.diff(decode_srgb(np.arange(n) / (n - 1))) <= 0.0).sum()) for n in (256, 65536))
    ours = int((np.diff(encode_srgb(grey(x))[:, 0].astype(int)) < 0).sum()) + down
    return Found(ours, int((np.diff(usual_srgb(x).astype(int)) < 0).sum()))


@case(
    "H04", "all bytes to linear and back", usual="the curve times 255, cast", rule="the steps lie between the bytes",
    truth="the same bytes", unit="bytes that change", allowed=0.0,
)  # fmt: skip
def there_and_back() -> Found:
    bytes_ = np.arange(256)
    linear = decode_srgb(bytes_ / 255.0)
    ours, usual = encode_srgb(grey(linear))[:, 0], usual_srgb(linear)
    return Found(int((ours != bytes_).sum()), int((usual != bytes_).sum()))


@case(
    "H05", "radiances up to 1e160 and infinity on a display", usual="x (1 + x / w^2) / (1 + x), w = 4, in float64",
    rule="no tone curve: clamped and counted; infinity is magenta", truth="finite and monotone",
    unit="values that are not finite or go down", allowed=0.0,
)  # fmt: skip
def very_bright() -> Found:
    x = np.array([0.0, 1e-160, 1e-3, 1.0, 1e30, 1e155, 1e160, math.inf])
    shown = encode_srgb(grey(x)).astype(float)
    ours = int((np.diff(shown[:-1, 0]) < 0.0).sum()) + int(tuple(shown[-1]) != (255.0, 0.0, 255.0))
    with np.errstate(over="ignore", invalid="ignore"):
        curve = x * (1.0 + x / 16.0) / (1.0 + x)
        return Found(ours, int((~np.isfinite(curve)).sum() + (np.diff(curve) < 0.0).sum()))


@case(
    "H06", "1 - exp(-x) at x = 3e-6, 3e-9 and 3e-12: the rule of three for 1e6, 1e9 and 1e12 samples",
    usual="1 - 0.05^(1 / n)", rule="-expm1(log1p(-0.95) / n)", truth="60 digits", unit="relative error", allowed=1e-15,
)  # fmt: skip
def next_to_nothing() -> Found:
    m, numbers = exact(), (10**6, 10**9, 10**12)
    truths = [1 - (1 - m.mpf(0.95)) ** (m.mpf(1) / n) for n in numbers]
    return Found(worst(map(rule_of_three, numbers), truths), worst([1.0 - 0.05 ** (1.0 / n) for n in numbers], truths))


@case(
    "H07", "light of 500 nm, which no display can show", usual="negative components cut off",
    rule="cut off, with a warning, as Mitsuba 3 does", truth="the luminance before",
    unit="relative error of the luminance", allowed=1e-12,
)  # fmt: skip
def out_of_gamut() -> Found:
    from raylab.io import mitsuba_xml, spectrum

    line = np.array([499.0, 500.0, 501.0]), np.array([0.0, 1.0, 0.0])
    text = (
        "<scene version='3.0.0'><sensor type='perspective'/><emitter type='constant'>"
        "<spectrum name='radiance' value='499:0, 500:1, 501:0'/></emitter></scene>"
    )
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "x.xml"
        path.write_text(text, encoding="utf-8")
        sky = mitsuba_xml.read(path).environment
    true = spectrum.integrate(spectrum.tabulated(*line))
    luminance = np.linalg.inv(spectrum.XYZ_TO_RGB)[1]
    assert isinstance(sky, d.ConstantEnvironment)
    shown = (np.asarray(sky.radiance), np.maximum(true, 0.0))
    ours, usual = (abs(float(luminance @ rgb / (luminance @ true)) - 1.0) for rgb in shown)
    return Found(ours, usual)


@case(
    "H08", "radiances of 1e9 and 1e-9 next to one another in a file", usual="half floats, as many .exr files have",
    rule=".exr in float32; .png counts what it cuts", truth="both values to float32, one pixel cut",
    unit="relative error of the .exr file, infinite if the cut pixel is not counted", allowed=2.0**-24,
)  # fmt: skip
def wide_range() -> Found:
    pixels = grey([[1e9, 1e-9]])
    with tempfile.TemporaryDirectory() as folder:
        write_exr(Path(folder) / "x.exr", {"": pixels}, {})
        ours = read_image(Path(folder) / "x.exr")
        counted = write_png(Path(folder) / "x.png", pixels) == (0, 1)
    with np.errstate(over="ignore"):
        half = pixels.astype(np.float16).astype(float)
    error = float(np.abs(ours / pixels - 1.0).max())
    return Found(error if counted else math.inf, float(np.abs(half / pixels - 1.0).max()))
