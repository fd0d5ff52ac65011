"""Materials: from description to BRDF, all kinds as the BRDF of each, and what is none refused."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import U53, array, size, unit
from test_textures import pixels

from raylab import description as d
from raylab import materials as m
from raylab import rough
from raylab.brdf import Lambertian, Phong
from raylab.errors import SceneError
from raylab.jit import njit
from raylab.kinds import Absent
from raylab.microfacet import BECKMANN, GGX, Microfacets
from raylab.palette import Palette
from raylab.rough import RoughConductor, RoughPlastic, plastic_table
from raylab.sampling import frame
from raylab.smooth import Conductor, Dielectric
from raylab.vec3 import Vec3
from raylab.view import View

rough.QUADRATURE = size(64, 4)
N = unit(0.0, 0.6, 0.8)


@njit
def brdf_at(materials, material, N, uv):
    return materials.at(material, N, uv)


def test_diffuse_materials():
    grey, red = d.Diffuse(np.array([0.5, 0.5, 0.5])), d.Diffuse(np.array([0.9, 0.1, 0.0]))
    palette = Palette()
    assert [palette.number(x) for x in (grey, red, grey, None)] == [0, 1, 0, -1]
    table = palette.materials()
    assert isinstance(table, m.DiffuseMaterials)
    assert not table.glossy()
    assert not palette.textured
    for number, rho in ((0, 0.5), (1, 0.9)):
        brdf = brdf_at(table, number, N, (0.0, 0.0))
        assert type(brdf) is Lambertian
        assert brdf.k_d.x == rho / math.pi or brdf.k_d.x == rho * (1.0 / math.pi)
    assert brdf_at(table, 1, N, (0.0, 0.0)).k_d.z == 0.0


def test_phong_materials_hold_diffuse_ones_with_a_black_lobe():
    shiny = d.Phong(np.array([0.1, 0.2, 0.3]), np.array([0.4, 0.5, 0.6]), 25.0)
    palette = Palette()
    assert [palette.number(x) for x in (d.Diffuse(), shiny)] == [0, 1]
    table = palette.materials()
    assert isinstance(table, m.PhongMaterials)
    assert table.glossy()
    dull, brdf = (brdf_at(table, k, N, (0.0, 0.0)) for k in (0, 1))
    assert type(brdf) is Phong
    assert [*brdf.k_d] == pytest.approx(np.array([0.1, 0.2, 0.3]) / math.pi, rel=4 * U53)
    assert brdf.k_s == Vec3(0.4, 0.5, 0.6)
    assert (brdf.n, brdf.N) == (25.0, N)
    assert not dull.is_glossy()
    assert brdf.is_glossy()


def test_a_phong_that_does_not_shine_is_diffuse():
    palette = Palette()
    palette.number(d.Phong(specular_reflectance=np.zeros(3)))
    assert isinstance(palette.materials(), m.DiffuseMaterials)


def test_textured_materials_look_their_reflectance_up():
    image = pixels(2, 2)
    bitmap, palette = d.Bitmap(image, "nearest"), Palette()
    numbers = [palette.number(x) for x in (d.Diffuse(), d.Diffuse(bitmap), d.Phong(bitmap, np.full(3, 0.05), 9.0))]
    assert palette.textured
    table = palette.materials()
    for number in numbers[1:]:
        k_d = brdf_at(table, number, N, (0.25, 0.75)).k_d
        assert [*k_d] == pytest.approx(image[0, 0] / math.pi, rel=4 * U53)
    assert [*brdf_at(table, 0, N, (0.25, 0.75)).k_d] == pytest.approx(np.full(3, 0.5) / math.pi, rel=4 * U53)


def test_a_scene_without_materials_has_a_black_one():
    table = Palette().materials()
    assert brdf_at(table, 0, N, (0.0, 0.0)).k_d == Vec3(0, 0, 0)


def test_one_number_stands_for_grey():
    palette = Palette()
    palette.number(d.Diffuse(np.float64(0.25)))  # type: ignore[arg-type]
    assert [palette.materials().rows[0, k] for k in range(4)] == [0.25, 0.25, 0.25, -1.0]


BAD = [
    (d.Phong(np.full(3, 0.7), np.full(3, 0.4)), "add up to more than 1"),
    (d.Diffuse(np.array([0.5, 1.5, 0.5])), r"diffuse reflectance must lie in \[0, 1\], got 1.5"),
    (d.Diffuse(np.array([0.5, -0.1, 0.5])), r"got -0.1"),
    (d.Diffuse(np.array([0.5, np.nan, 0.5])), "got nan"),
    (d.Diffuse(np.ones(4)), r"one number, an RGB triple or an image \(h, w, 3\), got shape \(4,\)"),
    (d.Diffuse(d.Bitmap(np.full((2, 2, 3), 1.01))), r"got 1.01 at \(0, 0, 0\)"),
    (d.Diffuse(d.Bitmap(np.full((2, 3), 0.5))), r"an image must be \(h, w, 3\), got \(2, 3\)"),
    (d.Phong(specular_reflectance=np.full(3, 2.0)), "phong specular_reflectance"),
    (d.Phong(exponent=-1.0), r"exponent must be in \[0, 1e9\], got -1.0"),
    (d.Phong(exponent=np.nan), "exponent"),
    ("chrome", "expected a material of raylab.description, got str"),
]


@pytest.mark.parametrize(("material", "message"), BAD)
def test_what_is_no_material_is_refused(material, message):
    with pytest.raises(SceneError, match=message):
        Palette().number(material)


# --- mirrors and glass: one kind of BRDF for all surfaces of a scene ---


GLASS = d.Dielectric(1.5, 1.0, np.array([0.9, 0.8, 0.7]), np.array([0.3, 0.4, 0.5]))
GOLD = d.Conductor(np.array([0.2, 0.4, 1.3]), np.array([3.9, 2.4, 1.9]), np.array([1.0, 0.9, 0.8]))
STEEL = d.RoughConductor(GOLD.eta, GOLD.k, GOLD.specular_reflectance, 0.2, 0.2, "ggx")
CUP = d.RoughPlastic(np.array([0.1, 0.2, 0.3]), np.array([0.9, 0.8, 0.7]), 1.5, 1.0, 0.3, "beckmann", True)
SHINY = d.Phong(np.array([0.1, 0.2, 0.3]), np.array([0.4, 0.5, 0.6]), 25.0)


@njit
def answers(brdf, V, L, N, u):
    w, p = brdf.sample(V, N, u)
    r, t = brdf.refraction(V, N)
    kinds = brdf.is_glossy(), brdf.is_specular()
    return kinds, brdf.eval(V, L), w, p, brdf.pdf(V, L, N), brdf.reflection(V, N), r, t


@njit
def answers_at(materials, material, V, L, N, u):
    return answers(materials.at(material, N, (0.0, 0.0)), V, L, N, u)


def numbers_in(answer):
    """All numbers of an answer, in one row."""
    return np.concatenate([[*part] if isinstance(part, (Vec3, tuple)) else [part] for part in answer]).astype(float)


def vec(rgb):
    return Vec3(*rgb)


def everything():
    palette = Palette()
    numbers = [palette.number(x) for x in (d.Diffuse(), SHINY, STEEL, CUP, GOLD, GLASS, GLASS.inside)]
    return palette.materials(), numbers


def test_any_brdf_answers_as_the_brdf_of_its_kind():
    table, numbers = everything()
    assert isinstance(table, m.AnyMaterials)
    assert table.glossy()
    assert table.smooth()
    T, _ = frame(N)
    alone = [
        Lambertian(Vec3(*np.full(3, 0.5 / math.pi))),
        Phong(Vec3(*SHINY.diffuse_reflectance / math.pi), Vec3(*SHINY.specular_reflectance), 25.0, N),
        RoughConductor(Microfacets(GGX, 0.2, 0.2), *map(vec, (STEEL.eta, STEEL.k, STEEL.specular_reflectance)), N, T),
        RoughPlastic(
            Microfacets(BECKMANN, 0.3, 0.3),
            1.5,
            vec(CUP.diffuse_reflectance / math.pi),
            vec(CUP.specular_reflectance),
            True,
            View(plastic_table(BECKMANN, 0.3, 1.5)[None]),
            0,
            N,
            T,
        ),
        Conductor(Vec3(*GOLD.eta), Vec3(*GOLD.k), Vec3(*GOLD.specular_reflectance)),
        Dielectric(1.5, Vec3(*GLASS.specular_reflectance), Vec3(*GLASS.specular_transmittance)),
        Dielectric(1.0 / 1.5, Vec3(*GLASS.specular_reflectance), Vec3(*GLASS.specular_transmittance)),
    ]
    V, L = unit(0.3, 0.4, 0.9), unit(-0.3, 0.1, 0.8)
    for number, brdf in zip(numbers, alone, strict=True):
        for u in ((0.05, 0.3), (0.9, 0.7)):
            found = answers_at(table, number, V, L, N, u)
            expected = answers(brdf, V, L, N, u)
            assert found[0] == expected[0]
            assert numbers_in(found) == pytest.approx(numbers_in(expected), rel=4 * U53)


def test_light_sampling_finds_a_smooth_surface_black():
    table, numbers = everything()
    V = unit(0.3, 0.4, 0.9)
    for number in numbers[4:]:
        (glossy, specular), f, w, p, pdf, *_ = answers_at(table, number, V, V, N, (0.3, 0.3))
        assert (glossy, specular) == (False, True)
        assert (f, pdf) == (Vec3(0, 0, 0), 0.0)
        assert p > 0.0  # what is black is divided by it
        assert array(w) == pytest.approx(2 * (array(N) @ array(V)) * array(N) - array(V), abs=4 * U53)


def test_kinds_that_a_scene_lacks_are_absent():
    palette = Palette()
    for material in (d.Diffuse(), GOLD):
        palette.number(material)
    table = palette.materials()
    assert isinstance(table.kinds.phong, Absent)
    assert isinstance(table.kinds.dielectric, Absent)
    assert isinstance(table.kinds.rough_conductor, Absent)
    assert isinstance(table.kinds.rough_plastic, Absent)
    assert not table.glossy()
    assert table.smooth()


def test_glass_from_within_is_the_same_boundary():
    assert (GLASS.inside.int_ior, GLASS.inside.ext_ior) == (GLASS.ext_ior, GLASS.int_ior)
    assert GLASS.inside.specular_transmittance is GLASS.specular_transmittance


BAD_SMOOTH = [
    (d.Conductor(eta=np.array([0.2, -0.1, 0.2])), r"conductor eta must lie in \[0, 1e\+06\], got -0.1"),
    (d.Conductor(k=np.array([1.0, np.nan, 1.0])), r"conductor k must lie in .* got nan"),
    (d.Conductor(k=np.ones(4)), r"conductor k must be one number or an RGB triple, got shape \(4,\)"),
    (d.Conductor(specular_reflectance=np.full(3, 1.5)), r"conductor specular_reflectance must lie in \[0, 1\]"),
    (d.Dielectric(int_ior=0.0), r"dielectric: int_ior must be greater than 0, at most 1e\+06, got 0.0"),
    (d.Dielectric(ext_ior=-1.0), "dielectric: ext_ior must be greater than 0"),
    (d.Dielectric(int_ior=math.inf), "int_ior"),
    (d.Dielectric(specular_transmittance=np.full(3, -1.0)), r"specular_transmittance must lie in \[0, 1\]"),
]


@pytest.mark.parametrize(("material", "message"), BAD_SMOOTH)
def test_what_is_no_mirror_and_no_glass_is_refused(material, message):
    with pytest.raises(SceneError, match=message):
        Palette().number(material)


BAD_ROUGH = [
    (d.RoughConductor(alpha_u=0.0), "roughconductor alpha_u must be greater than 0, at most 10, got 0.0"),
    (d.RoughConductor(alpha_v=-0.1), "roughconductor alpha_v must be greater than 0, at most 10, got -0.1"),
    (d.RoughPlastic(alpha=math.nan), "roughplastic alpha must be greater than 0"),
    (d.RoughPlastic(alpha=11.0), "at most 10, got 11"),
    (d.RoughPlastic(distribution="phong"), "distribution must be one of ggx, beckmann, got 'phong'"),  # type: ignore[arg-type]
    (d.RoughPlastic(int_ior=-1.5), "roughplastic: int_ior must be greater than 0"),
    (d.RoughConductor(eta=np.array([0.2, -0.1, 0.2])), "roughconductor eta must lie in"),
    (d.RoughPlastic(diffuse_reflectance=np.full(3, 2.0)), "roughplastic diffuse_reflectance"),
]


@pytest.mark.parametrize(("material", "message"), BAD_ROUGH)
def test_what_is_no_rough_surface_is_refused(material, message):
    with pytest.raises(SceneError, match=message):
        Palette().number(material)


def test_rough_metal_alone_is_glossy_and_equal_coats_are_computed_once():
    palette = Palette()
    palette.number(d.RoughConductor())
    assert palette.materials().glossy()
    rows = [palette.coat(GGX, a, 1.5) for a in (0.2, 0.3, 0.2)]
    assert rows == [0, 1, 0]
    assert len(palette.materials().kinds.rough_plastic.coats) == 2
