"""Environments that are images: what they show, how they are sampled, their poles and seam; bad ones."""

from __future__ import annotations

import numpy as np
import pytest
from helpers import ALPHA, COMPILED, U53, chi_square_p, composite, same_bits, size, squares, unit
from skies import KINDS, LAST, LUMINANCE, PI, TURN, directions, edges, image, look, make, sample, two_worlds

from raylab import environment as env
from raylab.errors import SceneError
from raylab.sky import shares
from raylab.vec3 import Vec3

# --- what they show ---


def nearest(pixels, theta, turns):
    h, w = pixels.shape[:2]
    return pixels[np.minimum((theta / PI * h).astype(int), h - 1), np.minimum((turns * w).astype(int), w - 1)]


def bilinear(pixels, theta, turns):
    """Mitsuba 3.9.1, envmap.cpp: columns at (i + 1/2) / W, periodic; rows at theta = pi j / (H - 1)."""
    h, w = pixels.shape[:2]
    x, y = turns * w - 0.5, theta / PI * (h - 1)
    i, j = np.floor(x).astype(int), np.minimum(np.floor(y).astype(int), h - 2)
    s, t = (x - i)[:, None], (y - j)[:, None]
    top = pixels[j, i % w] * (1 - s) + pixels[j, (i + 1) % w] * s
    bottom = pixels[j + 1, i % w] * (1 - s) + pixels[j + 1, (i + 1) % w] * s
    return top * (1 - t) + bottom * t


@pytest.mark.parametrize(("kind", "model"), [("nearest", nearest), ("bilinear", bilinear)])
@pytest.mark.parametrize("shape", [(5, 8), (2, 3), (16, 1), (7, 2)])
def test_an_image_shows_what_a_plain_numpy_model_shows(kind, model, shape):
    pixels, rng = image(*shape), np.random.default_rng(2)
    theta, turns = np.arccos(rng.uniform(-1, 1, 500)), rng.random(500)
    turns[:10] = np.arange(10) / 1e4  # near the seam, on both sides
    turns[10:20] = 1 - np.arange(1, 11) / 1e4
    L, _ = look(make(pixels, kind), directions(np.cos(theta), turns))
    # theta and turns are exact to 16 U53 / sin(theta); the steepest slope is 10 per texel
    error = 16 * U53 / np.sin(theta)[:, None] * 10 * 4 * max(shape)
    off = np.abs(L - model(pixels, theta, turns)) > (error if kind == "bilinear" else 0.0)
    assert not off.any()


def test_row_0_is_at_local_plus_y_and_columns_run_from_minus_z_to_plus_x():
    """Mitsuba 3: u = atan2(x, -z) / 2 pi, v = acos(y) / pi."""
    pixels = np.zeros((2, 4, 3))
    pixels[..., 0] = [[1, 2, 3, 4], [5, 6, 7, 8]]
    sky = make(pixels, to_world=np.eye(4))
    seen = [sky.eval(unit(x, y, z)).x for y in (1, -1) for x, z in ((1, -1), (1, 1), (-1, 1), (-1, -1))]
    assert seen == [1, 2, 3, 4, 5, 6, 7, 8]


@pytest.mark.parametrize("kind", KINDS)
def test_to_world_turns_the_image(kind):
    pixels, w = image(), directions(np.linspace(-0.9, 0.9, 40), np.linspace(0.01, 0.95, 40), np.eye(4))
    here, p = look(make(pixels, kind, np.eye(4)), w)
    there, q = look(make(pixels, kind, TURN), w @ TURN[:3, :3].T)
    assert np.allclose(there, here, rtol=0, atol=1e-11)
    assert np.allclose(p, q, rtol=1e-11)


# --- sampling ---


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("shape", [(5, 8), (2, 3), (1, 1), (1, 6), (9, 1)])
def test_samples_come_with_their_density(kind, shape):
    sky = make(image(*shape), kind)
    w, p, pdf, L = sample(sky, squares(2000, seed=3))
    assert np.abs(np.linalg.norm(w, axis=1) - 1.0).max() <= 16 * U53
    assert np.all(p > 0.0)
    if kind == "nearest":  # constant in each cell: u within rounding of an edge would be needed for anything else
        assert np.allclose(pdf, p, rtol=4 * U53, atol=0.0)
        assert np.all(L @ LUMINANCE > 0.0)
    else:  # continuous; w is exact to 16 U53, the pdf changes by at most max(L) texels / sin(theta) per unit of w
        sine = np.linalg.norm(np.cross(w, TURN[:3, 1]), axis=1)
        slope = 4 * 10 * max(shape) ** 2 / np.minimum(sine, 1.0)
        assert np.all(np.abs(pdf - p) <= 16 * U53 * (1.0 + slope))


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("shape", [(5, 8), (2, 3), (1, 1), (64, 1), (33, 20)])
def test_the_density_of_an_image_integrates_to_one(kind, shape):  # D06
    """The cells meet at circles of latitude; in each the density is a polynomial in z and phi: two nodes are exact."""
    sky = make(image(*shape), kind)
    shift, z_edges = (0.5 if kind == "bilinear" else 0.0), np.array([sky.heights[i] for i in range(sky.rows + 1)])
    assert np.allclose(z_edges, edges(sky.rows), rtol=0, atol=4 * U53)
    z, wz = composite(2, z_edges[::-1])
    x, wx = composite(2, np.arange(sky.columns + 1))
    zz, tt = np.meshgrid(z, (x + shift) / sky.columns, indexing="ij")
    _, pdf = look(sky, directions(zz, tt).reshape(-1, 3))
    total = (pdf.reshape(zz.shape) * np.outer(wz, wx)).sum() * 2 * PI / sky.columns
    assert total == pytest.approx(1.0, rel=1e-12)


@pytest.mark.parametrize("kind", KINDS)
def test_the_density_is_one_over_the_jacobian(kind):
    sky, h = make(image(), kind), 1e-6
    u = np.array([s for s in squares(400, seed=4) if 2 * h < min(s) and max(s) < 1 - 2 * h])
    at = [sample(sky, u + np.array(shift))[0] for shift in ((h, 0), (-h, 0), (0, h), (0, -h))]
    _, p, _, _ = sample(sky, u)
    along, across = (at[0] - at[1]) / (2 * h), (at[2] - at[3]) / (2 * h)
    product = p * np.linalg.norm(np.cross(along, across), axis=1)
    # Within h of a cell's edge the differences straddle it: there are 40 + 5 edges, a share below 1e-4 of the square.
    assert np.median(np.abs(product - 1.0)) <= 1e-7
    assert np.mean(np.abs(product - 1.0) > 1e-3) <= 0.01


def test_mis_compensation_samples_what_is_above_the_mean():
    """Karlik et al. 2019: p proportional to max(0, L - mean of L over the sphere)."""
    pixels = image()
    edges_of = np.cos(np.linspace(0.0, PI, len(pixels) + 1))
    sizes = 2.0 * PI / pixels.shape[1] * (edges_of[:-1] - edges_of[1:])[:, None]
    L = pixels @ [0.2126, 0.7152, 0.0722]
    above = np.maximum(0.0, L - (L * sizes).sum() / (4.0 * PI))
    sky = make(pixels, mis_compensation=True)
    z = (edges_of[:-1] + edges_of[1:]) / 2.0
    turns = (np.arange(pixels.shape[1]) + 0.5) / pixels.shape[1]
    w = directions(np.repeat(z, len(turns)), np.tile(turns, len(z)))
    p = look(sky, w)[1].reshape(above.shape)
    assert p == pytest.approx(above / (above * sizes).sum(), rel=1e-9, abs=1e-12)
    assert (p == 0.0).any()


def test_mis_compensation_of_a_sky_without_contrast_changes_nothing():
    grey = np.full((4, 8, 3), 0.7)
    assert make(grey, mis_compensation=True).cell_cdf.array.tolist() == make(grey).cell_cdf.array.tolist()


def test_the_density_of_texels_is_proportional_to_their_luminance():
    pixels = image()
    pixels[2] = 0.0
    sky = make(pixels)
    z = edges(5)
    total = ((pixels @ LUMINANCE).sum(axis=1) * (z[:-1] - z[1:])).sum() * 2 * PI / 8  # integral of Y over the sphere
    theta, turns = (np.arange(5) + 0.5) / 5 * PI, (np.arange(8) + 0.5) / 8
    tt, uu = np.meshgrid(theta, turns, indexing="ij")
    L, pdf = look(sky, directions(np.cos(tt), uu).reshape(-1, 3))
    assert np.allclose(pdf, L @ LUMINANCE / total, rtol=1e-13, atol=0)


def test_the_density_at_the_corners_of_bilinear_cells_is_proportional_to_their_luminance():
    pixels = image()
    sky = make(pixels, "bilinear")
    y = pixels @ LUMINANCE
    around_cell = (y + np.roll(y, -1, axis=1))[:-1] + (y + np.roll(y, -1, axis=1))[1:]
    z = edges(4)
    total = (around_cell.sum(axis=1) / 4 * (z[:-1] - z[1:])).sum() * 2 * PI / 8
    tt, uu = np.meshgrid(np.arange(1, 4) / 4 * PI, (np.arange(8) + 0.5) / 8, indexing="ij")
    L, pdf = look(sky, directions(np.cos(tt), uu).reshape(-1, 3))
    assert np.allclose(L, pixels[1:4].reshape(-1, 3), rtol=0, atol=1e-12)
    assert np.allclose(pdf, L @ LUMINANCE / total, rtol=1e-12, atol=0)


@pytest.mark.parametrize("kind", KINDS)
def test_texels_are_found_as_often_as_they_are_bright(kind):
    pixels, n = image(), size(50_000, 5_000)
    sky = make(pixels, kind)
    y = pixels @ LUMINANCE
    if kind == "bilinear":
        y = (y + np.roll(y, -1, axis=1))[:-1] + (y + np.roll(y, -1, axis=1))[1:]
    z = edges(len(y))
    share = y * (z[:-1] - z[1:])[:, None]
    w = sample(sky, squares(n, seed=5))[0] @ TURN[:3, :3]
    row = np.searchsorted(-z, -w[:, 1], side="right") - 1
    turns = np.arctan2(w[:, 0], -w[:, 2]) / (2 * PI) * 8 - (0.5 if kind == "bilinear" else 0.0)
    counts = np.zeros_like(share)
    np.add.at(counts, (np.clip(row, 0, len(y) - 1), np.floor(turns).astype(int) % 8), 1)
    assert chi_square_p(counts, n * share / share.sum()) > ALPHA


@pytest.mark.parametrize("kind", KINDS)
def test_a_single_bright_texel_gets_every_sample(kind):  # D03
    pixels = np.zeros((6, 9, 3))
    pixels[2, 4] = [0.0, 3.0, 0.0]
    u = squares(300, seed=6) + [(a, b) for a in (0.0, 2.0**-53, 0.5, LAST) for b in (0.0, 2.0**-53, 0.5, LAST)]
    _, p, pdf, L = sample(make(pixels, kind, np.eye(4)), u)
    assert np.all(p[:300] > 0.0)
    assert np.all(p >= 0.0)
    assert np.all(np.isfinite(p))
    if kind == "nearest":
        z = edges(6)
        assert np.allclose(p, 9 / (2 * PI * (z[2] - z[3])), rtol=8 * U53)
        assert np.all(L[:300] == [0.0, 3.0, 0.0])  # the others lie on its edge, where rounding decides
        assert np.array_equal(p[:300], pdf[:300])


def test_rows_and_texels_without_light_are_never_chosen():
    """Also for u exactly on a step of the cumulated shares, at 0 and at 1 - 2^-53."""
    pixels = image(8, 8)
    pixels[[0, 3, 7]] = 0.0
    pixels[:, [0, 5, 7]] = 0.0
    sky = make(pixels)
    rows = [sky.row_cdf[i] for i in range(8)]
    cells = [sky.cell_cdf[i, j] for i in range(8) for j in range(8)]
    near = sorted({min(max(v + e, 0.0), LAST) for v in (*rows, *cells, 0.0) for e in (-(2.0**-53), 0.0, 2.0**-53)})
    step = near if COMPILED else near[::9]
    u = [(a, b) for a in step for b in step]
    assert sample(sky, u)[1].min() > 0.0  # p is that of the chosen cell: zero for a dark one


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("sun", [1e6, 1e9])
def test_no_texel_is_out_of_reach_beside_the_sun(kind, sun):  # D04, D05
    height, width = size(1024, 64), size(2048, 128)
    pixels = np.ones((height, width, 3), np.float32)
    pixels[height // 4, width // 3] = sun
    sky = make(pixels, kind)
    assert (np.diff(sky.row_cdf.array, prepend=0.0) > 0.0).all()
    assert (np.diff(sky.cell_cdf.array, axis=1, prepend=0.0) > 0.0).all()
    assert sky.row_cdf.array[-1] == 1.0
    assert np.all(sky.cell_cdf.array[:, -1] == 1.0)


def test_shares_end_at_one_with_the_last_weight():
    weights = np.array([[0.0, 1.0, 0.0, 3.0, 0.0, 0.0], [0.0] * 6, [0.1] * 6])
    cdf = shares(weights)
    assert cdf[0].tolist() == [0.0, 0.25, 0.25, 1.0, 1.0, 1.0]
    assert cdf[2, -1] == 1.0 > cdf[2, -2]
    assert np.all(cdf[1] == 1.0)


# --- poles, seam, small images ---


@pytest.mark.parametrize("kind", KINDS)
def test_the_poles_and_the_seam(kind):  # D06, D07, D08
    pixels = image(64, 32)
    sky = make(pixels, kind, np.eye(4))
    special = [
        (0, 1, 0), (0, -1, 0), (4.5e-9, 1, 0), (0, 1, -4.5e-9), (-1e-20, 0, -1), (1e-20, 0, -1), (-0.0, 0, -1),
        (0, 0, 1), (-0.0, 0, 1), (1e-20, 1, -1e-20), (-1e-300, -1, 0),
    ]  # fmt: skip
    L, pdf = look(sky, special)
    assert np.all(np.isfinite(L))
    assert np.all(np.isfinite(pdf))
    assert np.all(pdf > 0.0)
    seam = pixels[:, [0, -1]]
    if kind == "nearest":
        assert np.all(L[4] == pixels[32, -1]) or np.all(L[4] == pixels[32, 0])
        assert np.all(L[5] == pixels[32, 0])
    else:
        middle = (seam[31] + seam[32]).mean(axis=0) / 2  # between two rows and two columns
        assert np.allclose(L[4:7], middle, rtol=1e-12)


def test_angles_near_the_pole_are_exact():  # D08
    sky = make(image(), "nearest", np.eye(4))
    theta, turns = env.angles(sky, Vec3(4.5e-9, 1.0, 0.0))
    assert theta == pytest.approx(4.5e-9, rel=1e-15)
    assert turns == 0.25
    theta, turns = env.angles(sky, Vec3(-1e-20, 0.0, -1.0))
    assert (theta, turns) == (PI / 2, 0.0)


@pytest.mark.parametrize("kind", KINDS)
def test_one_texel_is_a_constant_sky(kind):  # D02
    w, p, pdf, L = sample(make(np.full((1, 1, 3), 2.5), kind), squares(200, seed=7))
    assert np.allclose(p, 0.25 / PI, rtol=16 * U53)
    assert np.allclose(pdf, 0.25 / PI, rtol=16 * U53)
    assert np.allclose(L, 2.5, rtol=4 * U53)
    assert np.abs(w.mean(axis=0)).max() < 0.3  # all around: three standard deviations are 0.12


# --- bad input ---


def test_a_black_image_is_a_black_sky():  # D01
    sky = make(np.zeros((4, 8, 3)))
    w, p, _, L = sample(sky, squares(10))
    assert np.all(L == 0.0)
    assert np.all(p > 0.0)
    assert np.all(np.isfinite(w))


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf, -1e-3, 1e39])
def test_a_bad_texel_is_refused_with_its_place(value):  # D09
    pixels = image()
    pixels[3, 6, 1] = value
    pixels[4, 2, 0] = value
    with pytest.raises(SceneError, match=r"2 texels .* row 3, column 6"):
        make(pixels)


def test_the_brightest_float32_is_accepted():
    pixels = np.full((2, 4, 3), np.finfo(np.float32).max, np.float32)
    _, p, _, L = sample(make(pixels), squares(10))
    assert np.allclose(p, 0.25 / PI, rtol=16 * U53)
    assert np.all(np.isfinite(L))


@pytest.mark.parametrize("shape", [(4, 8), (4, 8, 4), (0, 8, 3), (8, 0, 3)])
def test_an_image_has_three_channels_and_some_texels(shape):
    with pytest.raises(SceneError, match=r"\(h, w, 3\)"):
        make(np.ones(shape))


@pytest.mark.parametrize("change", [np.diag([1.0, 2, 1, 1]), np.diag([2.0, 2, 2, 1]), np.full((4, 4), np.nan)])
def test_an_environment_can_be_turned_but_not_stretched(change):
    with pytest.raises(SceneError, match="rotation"):
        make(image(), to_world=change)


def test_moving_an_environment_changes_nothing():
    moved = TURN.copy()
    moved[:3, 3] = 7.0
    assert make(image(), to_world=moved).right == make(image()).right


# --- one source, two worlds ---


@pytest.mark.parametrize("kind", KINDS)
def test_methods_in_plain_python_give_what_the_kernel_gets(kind):
    assert same_bits(*two_worlds(make(image(), kind)))


def test_linear_densities_are_sampled_exactly():
    for left, right in ((1.0, 3.0), (3.0, 1.0), (0.0, 2.0), (2.0, 0.0), (1.0, 1.0), (0.0, 0.0), (1e-300, 1.0)):
        for u in (0.0, 2.0**-53, 0.3, LAST):
            x = env.sample_linear(left, right, u)
            assert 0.0 <= x <= 1.0
            if left + right > 0.0:
                share = (left * x + (right - left) * x * x / 2) / ((left + right) / 2)
                assert share == pytest.approx(u, abs=8 * U53)
