"""Microfacets: the distributions of normals against quadrature and published numbers, and the normals seen."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import ALPHA, U53, array, chi_square_p, composite, gauss, same_bits, size, squares, unit

from raylab.jit import njit
from raylab.microfacet import (
    BECKMANN,
    GGX,
    LEAST_ALPHA,
    Microfacets,
    invert_visible_normal,
    pdf_visible_normal,
    sample_visible_normal,
)
from raylab.vec3 import Vec3, dot, length

PI = math.pi
KINDS = [GGX, BECKMANN]
ROUGH = [(0.3, 0.3), (0.1, 0.4), (1.0, 0.5)]
VIEWS = [0.0, 30.0, 70.0, 88.0]  # degrees from the normal


def view(degrees, phi=0.8):
    t = math.radians(degrees)
    return Vec3(math.sin(t) * math.cos(phi), math.sin(t) * math.sin(phi), math.cos(t))


@njit
def evaluate(facets, v, normals, out):
    for i in range(len(normals)):
        m = Vec3(normals[i, 0], normals[i, 1], normals[i, 2])
        out[i, 0], out[i, 1] = facets.density(m), pdf_visible_normal(facets, v, m)


@njit
def draw(facets, v, u, out):
    for i in range(len(u)):
        m = sample_visible_normal(facets, v, (u[i, 0], u[i, 1]))
        a, b = invert_visible_normal(facets, v, m)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3], out[i, 4] = m.x, m.y, m.z, a, b


def densities(facets, v, normals):
    out = np.empty((len(normals), 2))
    evaluate(facets, v, np.ascontiguousarray(normals), out)
    return out.T


def normals_of(facets, v, u):
    out = np.empty((len(u), 5))
    draw(facets, v, np.asarray(u, np.float64), out)
    return out[:, :3], out[:, 3:]


def from_slopes(facets, q, phi):
    """Normals with slopes alpha r (cos, sin) at r = q / (1 - q), and their solid angle for each dq dphi."""
    r = q / (1.0 - q)
    x, y = facets.alpha_u * r * np.cos(phi), facets.alpha_v * r * np.sin(phi)
    z = 1.0 / np.sqrt(1.0 + x * x + y * y)
    solid_angle = facets.alpha_u * facets.alpha_v * r * z**3 / (1.0 - q) ** 2
    return np.stack([x * z, y * z, z], axis=-1), solid_angle


def slope_grid(facets, n, m):
    """Nodes and weights (in sr) over all normals: Gauss-Legendre in q, the trapezoidal rule in phi."""
    q, weight = gauss(n)
    phi = np.arange(m) * (2.0 * PI / m)
    qq, pp = np.meshgrid(q, phi, indexing="ij")
    normals, solid_angle = from_slopes(facets, qq, pp)
    return normals.reshape(-1, 3), (solid_angle * weight[:, None] * (2.0 * PI / m)).ravel()


# --- the distribution ---


@pytest.mark.parametrize("alphas", ROUGH)
@pytest.mark.parametrize("kind", KINDS)
def test_the_facets_of_an_area_1_project_to_an_area_1(kind, alphas):
    facets = Microfacets(kind, *alphas)
    normals, weight = slope_grid(facets, 100, 64)
    density, _ = densities(facets, view(0.0), normals)
    assert (density * normals[:, 2]) @ weight == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("degrees", VIEWS)
@pytest.mark.parametrize("alphas", ROUGH)
@pytest.mark.parametrize("kind", KINDS)
def test_what_is_seen_is_the_projected_area_of_the_visible_facets(kind, alphas, degrees):
    """Smith: integral of D(m) max(0, v . m) = v.z / G1(v). The bend at v . m = 0 limits the quadrature."""
    facets, v = Microfacets(kind, *alphas), view(degrees)
    bend = size(2e-5, 5e-4)  # second order in the steps
    normals, weight = slope_grid(facets, size(400, 100), size(256, 64))
    density, pdf = densities(facets, v, normals)
    area = (density * np.maximum(0.0, normals @ array(v))) @ weight
    assert facets.seen(v) == pytest.approx(area, rel=bend)
    assert pdf @ weight == pytest.approx(1.0, abs=bend)  # the weak white furnace


PUBLISHED = [  # tests of Mitsuba 3 and its predecessors (test_microfacet.py), to the digits that they print
    (Microfacets(BECKMANN, 0.1, 0.1), "D", 0.0, 31.8309879),
    (Microfacets(BECKMANN, 0.1, 0.1), "D", 0.1, 11.86709118),
    (Microfacets(BECKMANN, 0.1, 0.1), "D", PI / 19, 2.07673073),
    (Microfacets(BECKMANN, 0.1, 0.3), "D", 0.0, 10.6103287),
    (Microfacets(BECKMANN, 0.1, 0.1), "G1", 0.98 * PI / 2, 0.67333597),
    (Microfacets(GGX, 0.1, 0.1), "G1", 0.98 * PI / 2, 0.46130955),
    (Microfacets(GGX, 0.1, 0.1), "G1", PI / 3, 0.99261039),
]


@pytest.mark.parametrize(("facets", "what", "theta", "value"), PUBLISHED)
def test_published_numbers(facets, what, theta, value):
    m = Vec3(math.sin(theta), 0.0, math.cos(theta))
    got = facets.density(m) if what == "D" else m.z / facets.seen_as_mitsuba(m)
    assert got == pytest.approx(value, rel=2.0**-21)  # float32, a few roundings


@pytest.mark.parametrize("alphas", ROUGH)
def test_the_rational_function_of_walter_is_off_by_0_35_percent_at_most(alphas):
    facets = Microfacets(BECKMANN, *alphas)
    off = [facets.seen_as_mitsuba(v) / facets.seen(v) - 1.0 for v in map(view, np.linspace(0.0, 90.0, 1000))]
    assert np.abs(off).max() <= 0.0035
    assert np.abs(off).max() >= 0.001  # it is not the exact one


@pytest.mark.parametrize("kind", KINDS)
def test_a_smooth_surface_hides_nothing(kind):
    facets = Microfacets(kind, LEAST_ALPHA, LEAST_ALPHA)
    for degrees in (0.0, 45.0, 80.0):
        v = view(degrees)
        limit = 0.3 * (LEAST_ALPHA * math.tan(math.radians(degrees))) ** 2  # 1 + (alpha tan)^2 / 4, GGX
        assert 0.0 <= facets.seen(v) / v.z - 1.0 <= limit + 2 * U53


# --- the normals that v sees ---

CASES = [(kind, alphas, degrees) for kind in KINDS for alphas in ROUGH for degrees in VIEWS]


@pytest.mark.parametrize(("kind", "alphas", "degrees"), CASES)
def test_the_density_is_one_over_the_jacobian(kind, alphas, degrees):
    """p(m(u)) |dm/du1 x dm/du2| = 1, by central differences."""
    facets, v = Microfacets(kind, *alphas), view(degrees)
    u = 0.02 + 0.96 * np.random.default_rng(1).random((size(200, 20), 2))
    h = 1e-5
    sides = [normals_of(facets, v, u + h * np.array(e))[0] for e in ((1, 0), (-1, 0), (0, 1), (0, -1))]
    jacobian = np.linalg.norm(np.cross(sides[0] - sides[1], sides[2] - sides[3]), axis=1) / (4 * h * h)
    _, pdf = densities(facets, v, normals_of(facets, v, u)[0])
    # third derivatives of the map: within 0.02 of the edge of the square they are at most some 1 / 0.02^3
    assert np.abs(pdf * jacobian - 1.0).max() <= 2 * h * h / 0.02**2


@pytest.mark.parametrize(("kind", "alphas", "degrees"), CASES)
def test_the_square_is_found_again(kind, alphas, degrees):
    facets, v = Microfacets(kind, *alphas), view(degrees)
    u = np.array(squares(size(300, 30), seed=2))
    _, back = normals_of(facets, v, u)
    far = np.abs(back - u)
    assert np.minimum(far, 1.0 - far).max() <= 1e-11


@pytest.mark.parametrize(("kind", "alphas", "degrees"), CASES)
def test_samples_have_the_distribution_that_the_pdf_claims(kind, alphas, degrees):
    """chi-square over cells in (q, phi), each filled by quadrature; false alarms 1e-6."""
    facets, v = Microfacets(kind, *alphas), view(degrees)
    n, rings, sectors, nodes = size(60_000, 3_000), size(8, 4), size(16, 4), 16
    m, _ = normals_of(facets, v, squares(n, seed=3))
    assert np.abs((m**2).sum(axis=1) - 1.0).max() <= 8 * U53
    assert (m @ array(v)).min() > -4 * U53
    slopes = m[:, :2] / m[:, 2:] / np.array(alphas)
    r, phi = np.hypot(*slopes.T), np.arctan2(slopes[:, 1], slopes[:, 0])
    counts, *_ = np.histogram2d(r / (1 + r), phi, bins=(rings, sectors), range=[[0, 1], [-PI, PI]])
    qs, wq = composite(nodes, np.linspace(0, 1, rings + 1))
    ps, wp = composite(nodes, np.linspace(-PI, PI, sectors + 1))
    qq, pp = np.meshgrid(qs, ps, indexing="ij")
    normals, solid_angle = from_slopes(facets, qq, pp)
    _, pdf = densities(facets, v, normals.reshape(-1, 3))
    mass = pdf.reshape(qq.shape) * solid_angle * np.outer(wq, wp)
    mass = mass.reshape(rings, nodes, sectors, nodes).sum(axis=(1, 3))
    assert mass.sum() == pytest.approx(1.0, abs=1e-3)
    assert chi_square_p(counts, n * mass / mass.sum()) > ALPHA


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("alpha", [LEAST_ALPHA, 1.0])
@pytest.mark.parametrize("v", [view(0.0), view(89.9999), unit(1.0, 0.0, 1e-12), unit(0.0, 1.0, 5e-324)])
def test_extreme_views_and_points_of_the_square_give_normals(kind, alpha, v):
    facets = Microfacets(kind, alpha, alpha)
    for u1 in (0.0, 2.0**-53, 0.5, 1.0 - 2.0**-53):
        for u2 in (0.0, 2.0**-53, 0.5, 1.0 - 2.0**-53):
            m = sample_visible_normal(facets, v, (u1, u2))
            assert abs(length(m) - 1.0) <= 4 * U53
            assert m.z >= 0.0
            assert dot(m, v) >= -(2.0**-26)  # slopes next to those that v just does not see are known to 2^-26
            assert 0.0 <= pdf_visible_normal(facets, v, m) < math.inf


@pytest.mark.parametrize("kind", KINDS)
def test_plain_python_gives_what_the_kernel_gets(kind):
    facets, v = Microfacets(kind, 0.2, 0.6), view(50.0)
    u = squares(20, seed=4)
    m, back = normals_of(facets, v, u)
    for i, square in enumerate(u):
        normal = sample_visible_normal(facets, v, square)
        assert same_bits([*normal, *invert_visible_normal(facets, v, normal)], [*m[i], *back[i]])
