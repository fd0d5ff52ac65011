"""Textures against a plain numpy look-up."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import U53, array

from raylab import description as d
from raylab import materials as m
from raylab.palette import Palette
from raylab.vec3 import Vec3

PLAIN = Vec3(0.1, 0.2, 0.3)


def pixels(height, width, seed=0):
    """Multiples of 1/256: exact in float32."""
    return np.random.default_rng(seed).integers(0, 257, (height, width, 3)) / 256.0


def textures(*bitmaps):
    palette = Palette()
    for bitmap in bitmaps:
        palette.number(d.Diffuse(bitmap))
    return palette.materials().textures


def index(i, n, mode):
    """The texel that stands at i, by walking there."""
    i = np.asarray(i)
    if mode == "repeat":
        return i - n * np.floor(i / n).astype(int)
    if mode == "clamp":
        return np.clip(i, 0, n - 1)
    there_and_back = np.concatenate([np.arange(n), np.arange(n)[::-1]])
    return there_and_back[i - 2 * n * np.floor(i / (2 * n)).astype(int)]


def look_up(image, uv, mode, kind):
    """Mitsuba's convention: texel (i, j) covers [i, i + 1] / w x [j, j + 1] / h, row 0 at the top (v = 1)."""
    h, w = image.shape[:2]
    x, y = uv[0] * w, (1.0 - uv[1]) * h
    if kind == "nearest":
        return image[index(math.floor(y), h, mode), index(math.floor(x), w, mode)]
    i, j = math.floor(x - 0.5), math.floor(y - 0.5)
    s, t = x - 0.5 - i, y - 0.5 - j
    four = [[image[index(j + b, h, mode), index(i + a, w, mode)] for a in (0, 1)] for b in (0, 1)]
    top, bottom = (row[0] * (1 - s) + row[1] * s for row in four)
    return top * (1 - t) + bottom * t


@pytest.mark.parametrize("wrap", ["repeat", "mirror", "clamp"])
@pytest.mark.parametrize("kind", ["nearest", "bilinear"])
@pytest.mark.parametrize("shape", [(3, 5), (1, 1), (4, 1), (1, 2)])
def test_textures_are_looked_up_as_by_numpy(shape, kind, wrap):
    image, rng = pixels(*shape), np.random.default_rng(1)
    sheet = textures(d.Bitmap(image, kind, wrap))
    points = [*rng.uniform(-3, 3, (60, 2)), [0.0, 0.0], [1.0, 1.0], [0.5, 0.5], [-1.0, 2.0], [-1e-20, 1.0 + 1e-20]]
    for u, v in points:
        colour = array(sheet.colour(0, (float(u), float(v)), PLAIN))
        assert colour == pytest.approx(look_up(image, (u, v), wrap, kind), rel=8 * U53, abs=0.0)


def test_the_top_row_is_at_v_1():
    image = pixels(2, 2)
    sheet = textures(d.Bitmap(image, "nearest"))
    for uv, texel in (((0.25, 0.75), image[0, 0]), ((0.75, 0.75), image[0, 1]), ((0.25, 0.25), image[1, 0])):
        assert [*sheet.colour(0, uv, PLAIN)] == texel.tolist()


def test_bilinear_look_up_at_the_centre_of_a_texel_is_the_texel():
    image = pixels(4, 4)
    sheet = textures(d.Bitmap(image))
    for row in range(4):
        for column in range(4):
            uv = ((column + 0.5) / 4, 1.0 - (row + 0.5) / 4)
            assert [*sheet.colour(0, uv, PLAIN)] == image[row, column].tolist()


def test_to_uv_is_an_affine_map():
    image = pixels(3, 4)
    to_uv = np.array([[2.0, 0.5, 0.25], [-0.5, 3.0, -0.75], [0.0, 0.0, 1.0]])
    plain, mapped = textures(d.Bitmap(image)), textures(d.Bitmap(image, to_uv=to_uv))
    for uv in ((0.25, 0.5), (0.75, 0.125), (-1.5, 2.0)):  # dyadic: the map is exact
        u, v, _ = to_uv @ [*uv, 1.0]
        assert mapped.colour(0, uv, PLAIN) == plain.colour(0, (float(u), float(v)), PLAIN)


def test_textures_stand_one_below_the_other():
    first, second = pixels(2, 3), pixels(4, 5, seed=1)
    sheet = textures(d.Bitmap(first, "nearest"), d.Bitmap(second, "nearest"), d.Bitmap(first, "nearest", "clamp"))
    assert [*sheet.colour(0, (0.9, 0.1), PLAIN)] == first[1, 2].tolist()
    assert [*sheet.colour(1, (0.9, 0.1), PLAIN)] == second[3, 4].tolist()
    assert [*sheet.colour(2, (5.0, 0.1), PLAIN)] == first[1, 2].tolist()
    assert sheet.colour(-1, (0.9, 0.1), PLAIN) == PLAIN
    assert m.NoTextures().colour(0, (0.9, 0.1), PLAIN) == PLAIN


@pytest.mark.parametrize("u", [math.nan, math.inf, -1e300, 2.0**40])
def test_coordinates_beyond_all_bounds_give_nan_and_no_wild_read(u):
    sheet = textures(d.Bitmap(pixels(2, 2)))
    for uv in ((u, 0.5), (0.5, u)):
        assert all(map(math.isnan, sheet.colour(0, uv, PLAIN)))
