"""Rough metal and plastic: textbook formulas, energy, quadrature of the plastic's tables, and Mitsuba's own values."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import U53, array, gauss, size

from raylab import fresnel, rough
from raylab.brdf import reflect
from raylab.jit import njit
from raylab.microfacet import BECKMANN, GGX, Microfacets
from raylab.rough import TABLE, RoughConductor, RoughPlastic, plastic_table, transmittance
from raylab.smooth import Conductor
from raylab.vec3 import Vec3
from raylab.view import View

rough.QUADRATURE = size(64, 4)
PI = math.pi
X, Z = Vec3(1, 0, 0), Vec3(0, 0, 1)
WHITE, RHO = Vec3(1, 1, 1), Vec3(0.5, 0.3, 0.1)
GOLD = Vec3(0.15, 0.4, 1.4), Vec3(3.9, 2.4, 1.9)  # roughly
PLASTIC = 1.49 / 1.000277
ROUGH = [(GGX, 0.1, 0.1), (GGX, 0.2, 0.6), (BECKMANN, 0.1, 0.1), (BECKMANN, 0.2, 0.6)]


def metal(kind, alpha_u, alpha_v, specular=WHITE):
    return RoughConductor(Microfacets(kind, alpha_u, alpha_v), *GOLD, specular, Z, X)


def plastic(kind, alpha, nonlinear=False, k_d=RHO / PI, specular=WHITE):
    rows = View(plastic_table(kind, alpha, PLASTIC)[None])
    return RoughPlastic(Microfacets(kind, alpha, alpha), PLASTIC, k_d, specular, nonlinear, rows, 0, Z, X)


def direction(degrees, phi):
    t = math.radians(degrees)
    return Vec3(math.sin(t) * math.cos(phi), math.sin(t) * math.sin(phi), math.cos(t))


@njit
def evaluate(brdf, V, directions, out):
    for i in range(len(directions)):
        w = Vec3(directions[i, 0], directions[i, 1], directions[i, 2])
        f = brdf.eval(V, w)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = f.x, f.y, f.z, brdf.pdf(V, w, brdf.N)


def values(brdf, V, directions):
    out = np.empty((len(directions), 4))
    evaluate(brdf, V, np.ascontiguousarray(directions), out)
    return out[:, :3], out[:, 3]


@pytest.mark.parametrize("facets", ROUGH)
def test_the_lobe_is_that_of_cook_and_torrance(facets):
    """F D G1 G1 / (4 cos cos), with the cosines and the shadowing kept apart."""
    brdf = metal(*facets)
    V, L = direction(40, 0.3), direction(55, 2.9)
    h = array(V) + array(L)
    H = Vec3(*(h / np.linalg.norm(h)))
    F = array(fresnel.conductor(float(array(V) @ array(H)), *GOLD))
    G = V.z / brdf.facets.seen_as_mitsuba(V) * L.z / brdf.facets.seen_as_mitsuba(L)
    want = F * brdf.facets.density(H) * G / (4.0 * V.z * L.z)
    assert [*brdf.eval(V, L)] == pytest.approx(want, rel=64 * U53 / min(facets[1:]) ** 2)


BRDFS = [metal(*facets) for facets in ROUGH] + [plastic(GGX, 0.3), plastic(BECKMANN, 0.1, nonlinear=True)]


@pytest.mark.parametrize("brdf", BRDFS)
def test_reciprocity(brdf):
    for a, b, turn in ((10, 40, 0.4), (60, 65, 2.0), (5, 85, 3.0), (45, 45.5, 3.1)):
        V, L = direction(a, 0.7), direction(b, 0.7 + turn)
        assert [*brdf.eval(V, L)] == pytest.approx([*brdf.eval(L, V)], rel=16 * U53)


@pytest.mark.compiled(reason="fifty thousand directions each")
@pytest.mark.parametrize("degrees", [0, 30, 60, 80, 88])
@pytest.mark.parametrize("brdf", BRDFS)
def test_no_more_is_reflected_than_arrives(brdf, degrees):
    theta, weight = gauss(200, 0.0, PI / 2)
    phi = 2.0 * PI * (np.arange(256) + 0.5) / 256
    t, p = (a.ravel() for a in np.meshgrid(theta, phi, indexing="ij"))
    w = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1)
    f, _ = values(brdf, direction(degrees, 0.5), w)
    share = f[:, 0] @ (np.cos(t) * np.sin(t) * np.repeat(weight, len(phi))) * 2.0 * PI / len(phi)
    assert 0.2 < share < 1.0


@pytest.mark.parametrize("brdf", BRDFS)
def test_nothing_is_reflected_from_below_or_to_below(brdf):
    V = direction(50, 0.5)
    for degrees in (90.001, 120, 180):
        assert [*brdf.eval(V, direction(degrees, 2.0))] == [0.0, 0.0, 0.0]
    assert brdf.pdf(V, -V, Z) == 0.0
    w, p = brdf.sample(direction(89.99, 0.5), Z, (0.999, 0.5))
    assert p > 0.0
    assert all(map(math.isfinite, brdf.eval(direction(89.99, 0.5), w)))


@pytest.mark.parametrize("kind", [GGX, BECKMANN])
@pytest.mark.parametrize("degrees", [0, 45, 80])
def test_a_nearly_smooth_surface_reflects_like_a_mirror(kind, degrees):
    """alpha -> 0: f cos / p of each sample tends to Fresnel's reflectance, and the sample to the mirror direction.

    A slope of r alpha turns the mirror direction by 2 r alpha; the middle of the square has r < 2.
    """
    alpha, V = 1e-4, direction(degrees, 0.4)
    brdf, smooth = metal(kind, alpha, alpha), Conductor(*GOLD, WHITE)
    mirror = array(reflect(V, Z))
    for u1 in (0.1, 0.5, 0.7):
        for u2 in (0.1, 0.4, 0.9):
            w, p = brdf.sample(V, Z, (u1, u2))
            assert np.linalg.norm(array(w) - mirror) <= 4 * alpha
            got = array(brdf.eval(V, w)) * w.z / p
            assert got == pytest.approx(array(smooth.reflection(V, Z)), rel=40 * alpha)


# --- the tables of rough plastic ---


def normals_seen(facets, n, m):
    """Nodes over all normals (slopes alpha r, r = q / (1 - q)) and their weights in projected area D(m) dm."""
    q, weight = gauss(n)
    q, phi = (a.ravel() for a in np.meshgrid(q, np.arange(m) * 2.0 * PI / m, indexing="ij"))
    r, weight = q / (1.0 - q), np.repeat(weight, m) * 2.0 * PI / m
    slopes = facets.alpha_u * r * np.array([np.cos(phi), np.sin(phi)])
    z = 1.0 / np.sqrt(1.0 + (slopes**2).sum(axis=0))
    area = r / (1.0 - q) ** 2 / PI * (np.exp(-r * r) if facets.kind == BECKMANN else 1.0 / (1.0 + r * r) ** 2) / z
    return np.stack([*(slopes * z), z], axis=-1), area * weight


@pytest.mark.compiled(reason="half a million facets")
@pytest.mark.parametrize(("kind", "alpha"), [(GGX, 0.1), (GGX, 0.5), (BECKMANN, 0.1), (BECKMANN, 0.5)])
def test_the_table_is_the_share_of_light_that_passes_the_coat(kind, alpha):
    """T(cos) by quadrature over slopes instead of the sampler's square, with Fresnel's formulas by numpy."""
    facets, table = Microfacets(kind, alpha, alpha), plastic_table(kind, alpha, PLASTIC)
    m, area = normals_seen(facets, 400, 256)
    for node in (1, 16, 40, 63):
        c = node / 63
        v = np.array([math.sqrt(1 - c * c), 0.0, c])
        ci = m @ v
        ct = np.sqrt(1 - (1 - ci**2) / PLASTIC**2)
        r_s, r_p = (ci - PLASTIC * ct) / (ci + PLASTIC * ct), (PLASTIC * ci - ct) / (PLASTIC * ci + ct)
        w = m * (ci / PLASTIC - ct)[:, None] - v / PLASTIC  # refracted
        s = alpha * np.hypot(w[:, 0], w[:, 1])
        a = np.maximum(-w[:, 2], 0.0) / np.maximum(s, 1e-300)
        if kind == GGX:
            g1 = 2 * a / (a + np.sqrt(a * a + 1))
        else:
            g1 = np.where(a >= 1.6, 1.0, (3.535 * a + 2.181 * a * a) / (1 + 2.276 * a + 2.577 * a * a))
        share = np.where(ci > 0, ci * area * g1 * (1 - (r_s**2 + r_p**2) / 2), 0.0).sum()
        seen = np.where(ci > 0, ci * area, 0.0).sum()
        assert table[node] == pytest.approx(share / seen, abs=2e-4)  # 64 nodes each way, masked facets at the edge
    assert 0.0 < table.min() <= table.max() < 1.0


@pytest.mark.compiled(reason="a quarter of a million facets")
@pytest.mark.parametrize("kind", [GGX, BECKMANN])
def test_a_smooth_coat_has_fresnel_s_transmittance(kind):
    """alpha -> 0: T = 1 - F from outside, and R is the mean of 2 F cos over the nodes inside."""
    table, nodes = plastic_table(kind, 1e-3, PLASTIC), np.arange(TABLE) / (TABLE - 1)
    for node in (16, 40, 63):
        assert table[node] == pytest.approx(fresnel.dielectric(nodes[node], PLASTIC)[1], abs=1e-5)
    inside = np.mean([2.0 * c * fresnel.dielectric(c, 1.0 / PLASTIC)[0] for c in nodes])
    assert table[TABLE] == pytest.approx(inside, abs=3e-4)  # F bends at the critical angle, within 1e-3 of a node


# --- Mitsuba ---


def grid():
    return [direction(t, p) for t in (1, 20, 45, 70, 85, 89) for p in (0.2, 1.5, 2.9, 4.0, 5.5)]


def theirs(bsdf, V):
    import mitsuba as mi

    si, context = mi.SurfaceInteraction3f(), mi.BSDFContext()
    si.wi = mi.Vector3f(*V)
    directions = [mi.Vector3f(*w) for w in grid()]
    f = np.array([[*bsdf.eval(context, si, w)] for w in directions])
    return f, np.array([bsdf.pdf(context, si, w) for w in directions])


def float32(facets):
    """Relative error: some 40 roundings, and those of H, 4 of 2^-24, in exp(-x^2 / alpha^2) for |x| < 7 alpha."""
    return 2.0**-24 * (40 + 4 * 14 / min(facets.alpha_u, facets.alpha_v))


def ratios(brdf, bsdf, off):
    """How far f_r cos(theta) and the pdf are from Mitsuba's at the most, for each V, in units of what is allowed.

    `off` bounds the error of Mitsuba's tables: twice in T(V) T(L), once in the odds T / (1 - T) of the samples.
    """
    w = np.array([[*v] for v in grid()])
    for V in grid()[::3]:
        f, pdf = values(brdf, V, w)
        f_cos, p = theirs(bsdf, V)
        T = transmittance(brdf, V) if off else 0.5
        rounding = float32(brdf.facets) + off / (T * (1.0 - T))
        if brdf.facets.kind == BECKMANN:  # Mitsuba divides by Walter's G1, we by the one that belongs to the samples
            rounding += 0.0035
        yield np.max(np.abs(f * w[:, 2:] - f_cos) / (1e-15 + (float32(brdf.facets) + 3 * off) * np.abs(f_cos)))
        yield np.max(np.abs(pdf - p) / (1e-15 + rounding * np.abs(p)))


NAMES = {GGX: "ggx", BECKMANN: "beckmann"}


def rgb(v):
    return {"type": "rgb", "value": [*v]}


@pytest.mark.crosscheck
@pytest.mark.parametrize("facets", ROUGH)
def test_rough_metal_is_that_of_mitsuba(mitsuba, facets):
    kind, alpha_u, alpha_v = facets
    bsdf = mitsuba.load_dict({
        "type": "roughconductor", "distribution": NAMES[kind], "alpha_u": alpha_u, "alpha_v": alpha_v,
        "eta": rgb(GOLD[0]), "k": rgb(GOLD[1]), "specular_reflectance": rgb((0.9, 0.8, 0.7)),
    })  # fmt: skip
    assert all(off <= 1.0 for off in ratios(metal(*facets, Vec3(0.9, 0.8, 0.7)), bsdf, 0.0))


@pytest.mark.crosscheck
@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize(("kind", "alpha"), [(GGX, 0.1), (GGX, 0.4), (BECKMANN, 0.1), (BECKMANN, 0.4)])
def test_rough_plastic_is_that_of_mitsuba(mitsuba, kind, alpha, nonlinear):
    """Mitsuba fills its tables with 32 x 32 facets in float32, which is off by less than 5e-4."""
    bsdf = mitsuba.load_dict({
        "type": "roughplastic", "distribution": NAMES[kind], "alpha": alpha, "nonlinear": nonlinear,
        "diffuse_reflectance": rgb(RHO), "specular_reflectance": rgb((0.9, 0.8, 0.7)),
    })  # fmt: skip
    assert all(off <= 1.0 for off in ratios(plastic(kind, alpha, nonlinear, specular=Vec3(0.9, 0.8, 0.7)), bsdf, 5e-4))
