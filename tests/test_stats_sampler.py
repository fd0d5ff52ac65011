"""Samplers against their pdf: the charts of domains, and raylab's maps, which pass."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import unit
from vectors import density, density_2d, directions, directions_and_pdf, pairs

from raylab import description as d
from raylab import sampling as s
from raylab.brdf import Phong
from raylab.jit import njit
from raylab.light_choice import FewLights, alias_table
from raylab.microfacet import BECKMANN, GGX, Microfacets, pdf_visible_normal, sample_visible_normal
from raylab.sky import make_environment
from raylab.solid_angle import sample_triangle_angle, triangle_angle
from raylab.stats.cells import integrate
from raylab.stats.domains import cap, choices, disk, hemisphere, lobe, sphere, square, texels, triangle
from raylab.stats.sampler_check import check_sampler, first_wrong
from raylab.vec3 import Vec3
from raylab.view import View

AXIS = unit(0.3, -0.5, 0.7)
A = np.array([*AXIS])
PI = math.pi
DOMAINS = [
    square(), disk(0.7), triangle(), triangle((1, 2, 3), (2, 2.5, 3), (0, 3, 5)), hemisphere(A), sphere(A),
    cap(A, 0.01), lobe(A, 0.0), lobe(A, 50.0), lobe(A, 1e7), texels(8, 16),
]  # fmt: skip
AREAS = [1.0, PI * 0.49, 0.5, 0.5 * math.sqrt(7.25), 2 * PI, 4 * PI, 0.02 * PI, 2 * PI, 2 * PI, 2 * PI, 4 * PI]


@pytest.mark.parametrize(("domain", "area"), [*zip(DOMAINS, AREAS, strict=True)], ids=lambda x: getattr(x, "name", ""))
def test_a_chart_and_its_inverse(domain, area):
    """The chart of a point of a chart is that point; the domain's density is the Jacobian, and adds up to its area."""
    v = 0.01 + 0.98 * np.random.default_rng().random((500, 2))
    points = domain.from_chart(v)
    assert domain.contains(points).all()
    resolution = 1e-12 if domain.name != "lobe" else 1e-8
    np.testing.assert_allclose(domain.to_chart(points), v, atol=resolution)
    h = 2.0**-18
    along, across = ((domain.from_chart(v + step) - domain.from_chart(v - step)) / (2 * h) for step in h * np.eye(2))
    gram = (along**2).sum(1) * (across**2).sum(1) - (along * across).sum(1) ** 2
    off = np.sqrt(gram) / domain.density(v) - 1.0
    assert np.median(np.abs(off)) < 1e-7  # the median: where a lobe ends, its chart bends within 1 / n
    p, error = integrate(lambda x: np.full(len(x), 1.0 / area), domain)
    assert abs(p.sum() - 1.0) <= error.sum() + 1e-12
    assert p.shape == (len(domain.edges[0]) - 1, len(domain.edges[1]) - 1)


# --- what is right passes ---


def rough(kind):
    facets, v = Microfacets(kind, 0.3, 0.1), unit(0.6, 0.3, 0.5)
    return directions(sample_visible_normal, facets, v), density(pdf_visible_normal, facets, v), lobe((0, 0, 1), 20)


def phong(n):
    return directions(s.sample_phong_lobe, AXIS, n), density(s.pdf_phong_lobe, AXIS, n), lobe(A, n)


def about_axis(name, domain):
    return directions(getattr(s, f"sample_{name}"), AXIS), density(getattr(s, f"pdf_{name}"), AXIS), domain


def plane(name, domain):
    return pairs(getattr(s, f"sample_{name}")), density_2d(getattr(s, f"pdf_{name}")), domain


def cone(sin_max):
    height = sin_max**2 / (1.0 + math.sqrt(1.0 - sin_max**2))
    return directions(s.sample_cone, AXIS, sin_max), density(s.pdf_cone, AXIS, sin_max), cap(A, height)


def sky(kind):
    """4 x 8 texels of unlike brightness, one of them black."""
    pixels = np.random.default_rng(1).random((4, 8, 3)) + 0.1
    pixels[1, 2] = 0.0
    pixels[2, 5] = 20.0
    environment = make_environment(d.ImageEnvironment(pixels=pixels, filter=kind, to_world=np.eye(4)))
    up, back = np.array([*environment.up]), np.array([*environment.back])
    right = np.array([*environment.right])
    half = 2 * PI / 8 * environment.texels.offset()  # cells of a bilinear image begin at the middles of its texels
    start = -back * math.cos(half) + right * math.sin(half)
    towards = back * math.sin(half) + right * math.cos(half)
    return (
        directions_and_pdf(sky_sample, environment), density(sky_pdf, environment),
        texels(environment.rows, environment.columns, up, start, towards),
    )  # fmt: skip


@njit
def sky_sample(environment, u):
    return environment.sample(Vec3(0.0, 0.0, 1.0), u)


@njit
def sky_pdf(environment, w):
    return environment.pdf(Vec3(0.0, 0.0, 1.0), w)


def gradient():
    radiance, slope = np.array([1.0, 1.2, 0.9]), 0.5 * np.eye(3)
    environment = make_environment(d.GradientEnvironment(radiance, slope))
    return directions_and_pdf(sky_sample, environment), density(sky_pdf, environment), sphere(A)


def seen_triangle():
    """(s, t) on a triangle, uniform in solid angle: p = dw / d(s, t) / Omega = |a . e1 x e2| / (r^3 Omega)."""
    a, e1, e2 = Vec3(-0.3, -0.5, 0.6), Vec3(1.2, 0.4, 0.5), Vec3(0.4, 1.3, 0.1)
    corner, edges = np.array([*a]), np.array([[*e1], [*e2]])
    volume = abs(np.linalg.det([corner, *edges]))
    omega = triangle_angle(a, e1, e2)

    def pdf(x):
        return volume / np.linalg.norm(corner + x @ edges, axis=1) ** 3 / omega

    return pairs(sample_triangle_angle, a, e1, e2), pdf, triangle()


RIGHT = {
    "hemisphere": lambda: about_axis("hemisphere", hemisphere(A)),
    "cosine": lambda: about_axis("cos_hemisphere", hemisphere(A)),
    "cosine on the sphere": lambda: about_axis("cos_hemisphere", sphere(A)),
    "sphere": lambda: (directions(s.sample_sphere), density(s.pdf_sphere), sphere(A)),
    "disk": lambda: plane("disk", disk()),
    "concentric disk": lambda: plane("concentric_disk", disk()),
    "triangle": lambda: plane("triangle", triangle()),
    "cone": lambda: cone(0.5),
    "narrow cone": lambda: cone(0.001),
    "Phong lobe": lambda: phong(30.0),
    "mirror-like Phong lobe": lambda: phong(1e7),
    "GGX": lambda: rough(GGX),
    "Beckmann": lambda: rough(BECKMANN),
    "light by solid angle": lambda: seen_triangle(),
    "gradient environment": lambda: gradient(),
    "nearest environment": lambda: sky("nearest"),
    "bilinear environment": lambda: sky("bilinear"),
}


@pytest.mark.parametrize("name", RIGHT)
def test_raylabs_maps_have_the_density_that_they_claim(name):
    findings = check_sampler(*RIGHT[name](), phi2=2e-3)
    assert all(f.ok for f in findings), findings
    assert "jacobian" in [f.name for f in findings]


@njit
def phong_sample(brdf, V, N, u):
    return brdf.sample(V, N, u)


@njit
def phong_pdf(brdf, V, N, w):
    return brdf.pdf(V, w, N)


def test_the_phong_mixture_has_the_density_that_it_claims():
    """Two lobes, many-to-one: counted, not mapped. Half of the lobe is below the horizon."""
    N, V = unit(0.0, 0.0, 1.0), unit(1.0, 0.0, 0.3)
    brdf = Phong(Vec3(0.1, 0.1, 0.1), Vec3(0.4, 0.4, 0.4), 20.0, N)
    sample, pdf = directions_and_pdf(phong_sample, brdf, V, N), density(phong_pdf, brdf, V, N)
    findings = check_sampler(sample, pdf, sphere(), one_to_one=False, phi2=2e-3, integrand=lambda w: pdf(w) * w[:, 2])
    assert all(f.ok for f in findings), findings


@njit
def choose_all(lights, u, out):
    for i in range(len(u)):
        k, q = lights.choose((u[i, 0], u[i, 1]))
        out[i, 0], out[i, 1] = k, q


@pytest.mark.parametrize("power", [[1.0, 5.0, 0.5, 3.5], [1.0] * 7, [*np.arange(200.0)]])
def test_lights_are_chosen_with_the_probabilities_that_are_returned(power):
    """The alias table of `one_light_power`; light 0 of the last list is dark and never chosen."""
    thresholds, aliases, shares = alias_table(power)
    lights = FewLights(View(thresholds), View(aliases), View(shares))
    expected = np.array(power) / np.sum(power)

    def sample(u):
        out = np.empty((len(u), 2))
        choose_all(lights, u, out)
        return out[:, 0], out[:, 1]

    findings = check_sampler(sample, lambda k: expected[k[:, 0].astype(int)], choices(len(power)), phi2=2e-3)
    assert all(f.ok for f in findings), findings


def test_choices_by_power():
    power = np.array([1.0, 5.0, 0.5, 3.5])
    edges = np.cumsum(power) / power.sum()
    pick = choices(4)

    def sample(u):
        return np.searchsorted(edges, u[:, 0], side="right")

    def pdf(k):
        return (power / power.sum())[k[:, 0].astype(int)]

    assert first_wrong(check_sampler(sample, pdf, pick, numbers=1)) is None
    uniform = check_sampler(lambda u: (4 * u[:, 0]).astype(int), pdf, pick, numbers=1)  # V7
    assert first_wrong(uniform).name == "counts"
    halved = check_sampler(sample, lambda k: 0.5 * pdf(k), pick, numbers=1)
    assert first_wrong(halved).name == "integral"
    dark = check_sampler(sample, pdf, pick, numbers=1, integrand=lambda k: np.ones(len(k)))
    assert first_wrong(dark) is None


# --- what is wrong is named: P1 to P12, in numpy ---
