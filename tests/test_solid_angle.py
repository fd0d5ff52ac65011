"""Flat lights by solid angle: exact angles in extreme places, densities as Jacobians, irradiance in closed form.

B05 to B11 are hard cases for these formulas; their truths were computed with sixty digits. `angle_of` recomputes
some here with mpmath. Lights are named by their corner a and edges e1, e2 as seen from the receiver.
"""

from __future__ import annotations

import math

import mpmath
import numpy as np
import pytest
from helpers import U53, array, composite, squares, unit
from test_lights import EXTREME, WHITE, lambert, matrix, rectangle, table, triangle

from raylab import description as d
from raylab import solid_angle as sa
from raylab.closed_forms import irradiance as forms
from raylab.jit import njit
from raylab.point import curved_point, dist_sqr, free_point
from raylab.vec3 import Vec3, black, dot, length, normalize

PI = math.pi
pytestmark = pytest.mark.compiled(reason="sums over many points")
ORIGIN = free_point(black)
UP = Vec3(0.0, 0.0, 1.0)


def v(*xyz):
    return Vec3(*(float(c) for c in xyz))


def angle_of(a, e1, e2):
    """The solid angle of a triangle with sixty digits."""
    with mpmath.workdps(60):
        a, e1, e2 = (mpmath.matrix([mpmath.mpf(c) for c in w]) for w in (a, e1, e2))
        b, c = a + e1, a + e2
        normal = [e1[i - 2] * e2[i - 1] - e1[i - 1] * e2[i - 2] for i in range(3)]
        la, lb, lc = mpmath.norm(a), mpmath.norm(b), mpmath.norm(c)

        def dots(p, q):
            return mpmath.fsum(p[i] * q[i] for i in range(3))

        below = la * lb * lc + dots(a, b) * lc + dots(b, c) * la + dots(c, a) * lb
        return 2 * mpmath.atan2(abs(dots(a, normal)), below)


# --- angles ---


@pytest.mark.parametrize("size", [1.0, 1e-2, 1e-4, 1e-6, 1e-8])
def test_the_solid_angle_of_a_triangle_of_any_size(size):  # B05
    rng = np.random.default_rng(5)
    for _ in range(20):
        a = unit(*rng.normal(size=3))
        e1, e2 = (v(*rng.normal(size=3)) * size for _ in range(2))
        # the triple product loses what the sight along the triangle loses: 1 / cosine at the light
        slant = length(e1) * length(e2) / abs(dot(a, sa.cross(e1, e2)))
        assert float(sa.triangle_angle(a, e1, e2) / angle_of(a, e1, e2) - 1) == pytest.approx(0.0, abs=16 * U53 * slant)


def test_the_solid_angle_of_a_small_rectangle():  # B06
    for size, truth in ((2.0**-14, 3.3276881113355830e-9), (2.0**-27, 4.9587995980210155e-17)):
        angle = sa.rectangle_angle(v(0.25, 0.125, 1), v(size, 0, 0), v(0, size, 0))
        assert angle == pytest.approx(truth, rel=1e-14)


def test_the_solid_angle_of_a_square_from_just_above_it():  # B07
    for z, gap in ((2.0**-30, 5.2683560638617540e-9), (2.0**-52, 1.2560739669470200e-15)):
        angle = sa.rectangle_angle(v(-1, -1, z), v(2, 0, 0), v(0, 2, 0))
        assert abs(angle - (2.0 * PI - gap)) <= 4e-16 * 2.0 * PI


def test_the_solid_angle_of_a_rectangle_seen_edge_on():  # B08
    for z, truth in ((2.0**-20, 5.6491770481679206e-7), (2.0**-40, 5.3874750596733102e-13)):
        assert sa.rectangle_angle(v(-1, 1, z), v(2, 0, 0), v(0, 1, 0)) == pytest.approx(truth, rel=1e-13)


# --- lights in places ---


def down(half, centre, axis=(0.0, 0.0, -1.0)):
    return matrix((*half, 1.0), centre, axis)


SLANTED = (0.3, 0.2, -1.0)
TURNED = matrix((1.0, 0.6, 1.0), (0.3, -0.2, 1.2), (0.3, 0.2, -1.0))
PLACES = {
    "triangle": triangle([[0.5, 0.2, 2.0], [0.3, 1.4, 1.5], [1.5, 0.1, 2.5]]),
    "triangle, small": triangle(np.array([[0.5, 0.2, 2.0], [0.498, 0.203, 2.001], [0.502, 0.203, 2.0]])),
    "triangle, near": triangle(np.array([[-1.0, -1.0, 0.02], [0.0, 1.5, 0.02], [1.0, -1.0, 0.02]])),
    "rectangle": rectangle(to_world=TURNED),
    "rectangle, small": rectangle(to_world=down((0.001, 0.002), (0.3, 0.4, 1.0), SLANTED)),
    "rectangle, near": rectangle(to_world=down((1.0, 0.5), (0.3, 0.2, 0.02))),
    "parallelogram": rectangle(to_world=TURNED @ (np.eye(4) + np.diag([0.4, 0, 0], 1))),
    "disk": d.Disk(radiance=WHITE, to_world=down((0.8, 0.8), (0.7, 0.2, 1.2), SLANTED)),
    "disk, small": d.Disk(radiance=WHITE, to_world=down((0.002, 0.002), (0.7, 0.2, 1.2), SLANTED)),
    "disk, near, inside": d.Disk(radiance=WHITE, to_world=down((1.0, 1.0), (0.3, 0.2, 0.02))),
    "disk, near, outside": d.Disk(radiance=WHITE, to_world=down((1.0, 1.0), (0.9, 0.8, 0.05))),
    "disk, above": d.Disk(radiance=WHITE, to_world=down((1.0, 1.0), (0.0, 0.0, 1.5))),
    "ellipse": d.Disk(radiance=WHITE, to_world=down((1.0, 0.5), (0.3, 0.2, 1.5), SLANTED)),
}
BY_ANGLE = [name for name in PLACES if name != "ellipse"]


ALL = (PLACES["triangle"], PLACES["rectangle"], PLACES["disk"])


def light(shape):
    """The last light of a table that has all three kinds: one type, one kernel."""
    return table(*ALL, shape)[3]


def apart(one, x):
    """The greatest distance over the height: how much rounding a point of the light may carry."""
    n, a = array(one.n), array(one.p - x.p)
    reach = np.linalg.norm(a) + length(one.e1) + length(one.e2)
    return reach / abs(a @ n)


@pytest.mark.parametrize("name", PLACES)
def test_the_density_is_one_over_the_jacobian(name):
    """dA = |dy/du1 x dy/du2| du1 du2, hence p |dy/du1 x dy/du2| = 1."""
    one, h = light(PLACES[name]), 2e-5
    angles = 8 * U53 / (h * sa.rectangle_angle(one.p, one.e1, one.e2)) if one.kind == 1 else 0.0  # Urena's, added up
    size = min(length(one.e1), length(one.e2))
    for u1 in (0.13, 0.41, 0.77, 0.93):
        for u2 in (0.1, 0.33, 0.8):
            _, p = one.sample_solid_angle(ORIGIN, (u1, u2))
            step = [(u1 + h, u2), (u1 - h, u2), (u1, u2 + h), (u1, u2 - h)]
            right, left, up, low = (array(one.sample_solid_angle(ORIGIN, u)[0].p) for u in step)
            area = np.linalg.norm(np.cross(right - left, up - low)) / (4.0 * h * h)
            # truncation: third derivatives, which a near light has large; rounding: of y, seen from a distance
            slope = max(np.linalg.norm(right - left), np.linalg.norm(up - low)) / (2.0 * h) / size
            truncation = 40 * h * h * (25.0 + slope**2 * apart(one, ORIGIN) ** 2)
            rounding = 64 * U53 / (h * size) * apart(one, ORIGIN) + angles
            assert abs(p * area - 1.0) <= truncation + rounding


@pytest.mark.parametrize("name", PLACES)
def test_samples_lie_on_the_light_and_carry_their_density(name):
    one = light(PLACES[name])
    for u in EXTREME + squares(50, seed=3):
        y, p = one.sample_solid_angle(ORIGIN, u)
        assert 0.0 < p < math.inf
        assert one.pdf_solid_angle(ORIGIN, y) == pytest.approx(p, rel=256 * U53 * apart(one, ORIGIN))
        (s, t), *_ = np.linalg.lstsq(np.array([[*one.e1], [*one.e2]]).T, array(y.p - one.p), rcond=None)
        edge = 64 * U53 * length(one.p) / min(length(one.e1), length(one.e2))
        inside = math.hypot(s, t) <= 1.0 + edge if one.kind == 2 else min(s, t) >= -edge and max(s, t) <= 1.0 + edge
        assert inside
        assert one.kind != 0 or s + t <= 1.0 + edge


@njit
def masses(one, x, st, out):
    """The density at the points (s, t) of the light."""
    for i in range(len(st)):
        y = curved_point(one.p + one.e1 * st[i, 0] + one.e2 * st[i, 1], one.n)
        out[i] = one.pdf_solid_angle(x, y)


@pytest.mark.parametrize("name", [n for n in PLACES if not n.startswith("disk, near")])  # those by irradiance
def test_the_density_integrates_to_one_over_the_light(name):
    one = light(PLACES[name])
    st, weights = over_disk(one) if one.kind == 2 else over_polygon(one)
    out = np.empty(len(st))
    masses(one, ORIGIN, st, out)
    # a disk's density has kinks at its polygon's points: their quadrature error falls with the square of the nodes
    assert out @ weights == pytest.approx(1.0, rel=4.0 / ROUND**2 if one.kind == 2 else 1e-9)


ROUND = 256


def over_disk(one):
    r, wr = composite(12, np.linspace(0.0, 1.0, 9))
    phi = 2.0 * PI * np.arange(ROUND) / ROUND
    st = np.stack([np.outer(r, np.cos(phi)), np.outer(r, np.sin(phi))], axis=-1).reshape(-1, 2)
    return st, np.repeat(wr * r, ROUND) * 2.0 / ROUND * one.area


def over_polygon(one):
    """Finer towards the foot of the receiver, where the density of a near light has its peak."""
    foot = array(ORIGIN.p - one.p - one.n * dot(ORIGIN.p - one.p, one.n))
    (fs, ft), *_ = np.linalg.lstsq(np.array([[*one.e1], [*one.e2]]).T, foot, rcond=None)
    parts = []
    for s, ws in zip(*composite(12, cuts(fs)), strict=True):
        top = 1.0 if one.kind == 1 else 1.0 - s
        t, wt = composite(12, np.unique(np.clip(cuts(ft), 0.0, top)))
        parts.append(np.stack([np.full_like(t, s), t, ws * wt * one.area * (2 - one.kind)], axis=1))
    st = np.concatenate(parts)
    return st[:, :2].copy(), st[:, 2]


def cuts(foot):
    near = [foot + sign * 0.02 * 3.0**k for k in range(5) for sign in (-1.0, 1.0)] if abs(foot - 0.5) < 1.5 else []
    return np.unique(np.clip([0.0, foot, *near, 1.0], 0.0, 1.0))


# --- irradiance ---


@njit
def estimates(one, x, n, u, out):
    """cos cos / (r^2 p) at the points u of the square: what `area_solid_angle` adds up."""
    for i in range(len(u)):
        y, p = one.sample_solid_angle(x, (u[i, 0], u[i, 1]))
        L = normalize(y - x)
        out[i] = max(0.0, dot(L, n)) * max(0.0, -dot(L, y.n)) / dist_sqr(x, y) / p


GRADED = np.array([0.0, 1e-4, 1e-2, 0.1, 0.5, 0.9, 0.99, 1.0 - 1e-4, 1.0])  # a near light bends the square at its edges


def irradiance(one, n, edges_1, edges_2, root):
    """Gauss-Legendre over the square in the given parts; where the map is a root of u (axis `root`), over u = t^2."""
    edges = [edges_1, edges_2]
    edges[root] = np.sqrt(edges[root])
    (u1, w1), (u2, w2) = composite(12, edges[0]), composite(12, edges[1])
    if root == 0:
        u1, w1 = u1 * u1, 2.0 * u1 * w1
    else:
        u2, w2 = u2 * u2, 2.0 * u2 * w2
    u = np.stack(np.meshgrid(u1, u2, indexing="ij"), axis=-1).reshape(-1, 2)
    out = np.empty(len(u))
    estimates(one, ORIGIN, n, u, out)
    return out @ np.outer(w1, w2).ravel()


def corners(one):
    last = [one.p + one.e2] if one.kind == 0 else [one.p + one.e1 + one.e2, one.p + one.e2]
    return np.array([array(p) for p in (one.p, one.p + one.e1, *last)])


def of_polygon(one, n):
    """A rectangle that is two triangles has a seam in u1."""
    first = sa.triangle_angle(one.p, one.e1, one.e2)
    second = sa.triangle_angle(one.p + one.e1 + one.e2, -one.e1, -one.e2)
    seam = first / (first + second) if one.kind == 1 else 0.5
    return irradiance(one, n, np.unique([*(seam * GRADED), *(seam + (1.0 - seam) * GRADED)]), GRADED, root=1)


@pytest.mark.parametrize("name", [n for n in PLACES if n.startswith(("tri", "rec", "par"))])
def test_irradiance_of_polygons(name):
    one, n = light(PLACES[name]), UP if "near" in name else unit(0.1, -0.2, 1.0)  # all of it above the horizon
    assert of_polygon(one, n) == pytest.approx(lambert(corners(one), array(n)), rel=1e-8)


def of_disk(radius, height, offset):
    one = light(d.Disk(radiance=WHITE, to_world=down((radius, radius), (offset, 0.0, height))))
    return irradiance(one, UP, GRADED, np.linspace(0.0, 1.0, 17), root=0)  # the parts of its polygon


@pytest.mark.parametrize("height", [10.0, 1.5, 1e-1, 1e-2, 1e-3])
def test_irradiance_of_a_disk_above(height):  # B19
    assert of_disk(1.0, height, 0.0) == pytest.approx(forms.disk_coaxial(1.0, height), rel=1e-9)


@pytest.mark.parametrize(("radius", "height", "offset"), [(0.8, 1.0, 0.6), (1.0, 0.3, 0.5), (0.5, 0.5, 2.0)])
def test_irradiance_of_a_disk_beside(radius, height, offset):
    assert of_disk(radius, height, offset) == pytest.approx(forms.disk_parallel(radius, height, offset), rel=1e-6)


def test_a_large_light_seen_edge_on_is_not_biased():  # B11
    one = light(rectangle(to_world=down((0.5, 0.975), (0.0, 1.025, 1.4e-5))))
    n = unit(0.02, 0.6, 0.5)
    assert of_polygon(one, n) == pytest.approx(lambert(corners(one), array(n)), rel=1e-6)


# --- where there is nothing to sample ---


@pytest.mark.parametrize("name", ["triangle", "rectangle", "parallelogram", "disk"])
def test_in_the_plane_of_the_light_the_density_is_zero(name):  # B09
    one = light(PLACES[name])
    for s, t in ((0.0, 0.0), (1.0, 0.0), (2.0, 0.0), (0.3, 0.3), (-1.0, 3.0)):
        x = free_point(one.p + one.e1 * s + one.e2 * t)
        for u in EXTREME:
            y, p = one.sample_solid_angle(x, u)
            assert p == 0.0
            assert math.isfinite(length(y.p))


@pytest.mark.parametrize("name", BY_ANGLE)
def test_behind_the_light_the_density_is_zero(name):  # B18
    one = light(PLACES[name])
    x = free_point(one.p - one.n * (10.0 * length(one.e1)))
    for u in EXTREME:
        assert one.sample_solid_angle(x, u)[1] == 0.0


@pytest.mark.parametrize("name", BY_ANGLE)
def test_a_light_far_away_is_sampled_by_area(name):  # B10
    one = light(PLACES[name])
    size = math.sqrt(dot(one.e1, one.e1) + dot(one.e2, one.e2))
    for factor, by_area in ((0.9, False), (1.1, True)):
        x = free_point(one.p + one.n * (factor * size / sa.FAR))
        y, p = one.sample_solid_angle(x, (0.3, 0.6))
        assert (p == 1.0 / one.area) == by_area == (y.p == one.sample(x, (0.3, 0.6))[0].p)
        # so close to uniform that it does not matter which
        assert p == pytest.approx(1.0 / one.area, rel=4.0 * sa.FAR)


def test_a_round_disk_has_a_density_uniform_within_three_percent():
    """For all half angles: the polygon of `sample_disk_angle` against the curve it stands for."""
    for cos_a in np.linspace(0.0, 1.0, 11):
        for cos_b in np.linspace(0.0, 1.0, 11):
            g = sa.sector_polygon(cos_a, cos_b)
            psi = np.linspace(0.0, PI / 2, 60)
            true = np.array([sa.sector(cos_a, cos_b, p) for p in psi])
            own = np.array([sa.polygon_at(g, p) for p in psi]) / sa.polygon_total(g)
            ratio = own / true * (true[:-1] + true[1:]).sum() / 2.0 * (PI / 2 / 59) * 4.0
            assert np.abs(ratio - 1.0).max() < 0.03
