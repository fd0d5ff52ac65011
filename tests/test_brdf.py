"""BRDFs: closed forms, reciprocity, energy, and samples against densities."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import ALPHA, U53, around, array, chi_square_p, composite, gauss, same_bits, size, squares, unit
from scipy.special import beta

from raylab.brdf import Lambertian, Phong, diffuse_share, reflect
from raylab.jit import njit
from raylab.microfacet import BECKMANN, GGX, Microfacets
from raylab.rough import TABLE, RoughConductor, RoughPlastic
from raylab.sampling import sample_cos_hemisphere, sample_phong_lobe
from raylab.vec3 import Vec3, black, dot, length, luminance
from raylab.view import View

PI = math.pi
N = unit(0.2, -0.4, 0.6)
GREY = Vec3(0.5, 0.5, 0.5)
WHITE = Vec3(1, 1, 1)


def tilted(degrees, turn=0.7):
    """The direction at this angle from N."""
    t = math.radians(degrees)
    return around(N, math.sin(t) * math.cos(turn), math.sin(t) * math.sin(turn), math.cos(t))


@njit
def evaluate(brdf, V, directions, out):
    for i in range(len(directions)):
        w = Vec3(directions[i, 0], directions[i, 1], directions[i, 2])
        f = brdf.eval(V, w)
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = f.x, f.y, f.z, brdf.pdf(V, w, N)


@njit
def sample(brdf, V, squares, out):
    for i in range(len(squares)):
        w, p = brdf.sample(V, N, (squares[i, 0], squares[i, 1]))
        out[i, 0], out[i, 1], out[i, 2], out[i, 3] = w.x, w.y, w.z, p


def eval_all(brdf, V, directions):
    out = np.empty((len(directions), 4))
    evaluate(brdf, V, np.ascontiguousarray(directions), out)
    return out


def basis():
    return np.stack([array(around(N, *row)) for row in np.eye(3)])


def hemisphere(n, sectors):
    """Directions (n * sectors, 3), their cosines to N, and quadrature weights in solid angle."""
    theta, weight = gauss(n, 0.0, PI / 2)
    phi = 2.0 * PI * (np.arange(sectors) + 0.5) / sectors
    t, p = np.meshgrid(theta, phi, indexing="ij")
    local = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1).reshape(-1, 3)
    return local @ basis(), local[:, 2], np.repeat(weight * np.sin(theta), sectors) * 2.0 * PI / sectors


def albedo(brdf, V):
    """The share of light from V that is reflected: quadrature of f_r cos, exponentially accurate while f is smooth."""
    directions, cosine, weight = hemisphere(size(200, 60), size(256, 64))
    return (eval_all(brdf, V, directions)[:, 0] * cosine * weight).sum()


def phong(n, k_d=black, k_s=WHITE):
    return Phong(k_d, k_s, float(n), N)


# --- Lambertian ---


def test_a_lambertian_reflects_its_reflectance():
    rho = Vec3(0.9, 0.5, 0.1)
    brdf = Lambertian(rho / PI)
    assert brdf.eval(tilted(50), tilted(10)) == rho / PI
    assert albedo(brdf, tilted(50)) == pytest.approx(0.9, rel=1e-12)
    assert not brdf.is_glossy()


def test_a_lambertian_is_sampled_by_the_cosine():
    brdf = Lambertian(GREY / PI)
    for u in squares(50):
        w, p = brdf.sample(tilted(30), N, u)
        assert [*w] == [*sample_cos_hemisphere(N, u)]
        assert p == brdf.pdf(tilted(30), w, N) == pytest.approx(dot(w, N) / PI, rel=4 * U53)
    assert brdf.pdf(tilted(30), tilted(91), N) == 0.0


# --- Phong ---


def test_the_mirror_direction():
    V = tilted(35)
    R = reflect(V, N)
    assert dot(R, N) == pytest.approx(dot(V, N), abs=4 * U53)
    assert length(R) == pytest.approx(1.0, abs=8 * U53)
    assert length(R + V - N * (2.0 * dot(N, V))) <= 8 * U53
    assert length(reflect(N, N) - N) <= 8 * U53


@pytest.mark.parametrize("n", [0, 1, 10, 100])
def test_at_normal_incidence_the_lobe_reflects_everything(n):  # F1
    """Integral of (n + 2)/(2 pi) cos^n cos over the hemisphere: 1 for every n."""
    assert albedo(phong(n), N) == pytest.approx(1.0, rel=1e-11)


@pytest.mark.parametrize("n", [10, 100])
def test_at_grazing_incidence_the_albedo_is_a_beta_function(n):  # C05
    """R in the horizon: (n + 2)/(2 pi) times the integral of z^n sqrt(1 - z^2) dz, B((n + 1)/2, 3/2)/2, times 2."""
    want = (n + 2) / (2 * PI) * beta((n + 1) / 2, 1.5)
    got = albedo(phong(n), tilted(90, turn=0.0))
    # max(0, cos)^n bends at the plane through N, where the midpoint rule in phi is off by (spacing / 2)^(n + 1) at most
    assert got == pytest.approx(want, rel=1e-9)


@pytest.mark.parametrize("degrees", [0, 30, 60, 80, 89, 90])
@pytest.mark.parametrize("n", [2, 20, 200])
def test_no_more_is_reflected_than_arrives(n, degrees):
    share = albedo(phong(n, k_d=GREY / PI, k_s=GREY), tilted(degrees))
    assert 0.5 < share <= 1.0 + 1e-11


@pytest.mark.parametrize("degrees", [20, 60, 85])
def test_the_albedo_of_a_clipped_lobe(degrees):  # C05
    """By rings around R: of max(0, a + b cos(phi)) a turn holds 2 (a phi_0 + b sin(phi_0)), cos(phi_0) = -a / b."""
    t, n = math.radians(degrees), 100
    want = 0.0
    for low, high in ((0.0, PI / 2 - t), (PI / 2 - t, PI / 2)):  # rings beyond 90 - t degrees are cut by the horizon
        alpha, weight = gauss(200, low, high)
        a, b = np.cos(alpha) * math.cos(t), np.sin(alpha) * math.sin(t)
        end = np.arccos(np.clip(-a / b, -1.0, 1.0))
        want += ((n + 2) / PI * np.cos(alpha) ** n * (a * end + b * np.sin(end)) * np.sin(alpha) * weight).sum()
    assert albedo(phong(n), tilted(degrees)) == pytest.approx(want, rel=1e-7)  # the cut bends like x^(3/2): 200^-4


@pytest.mark.parametrize("n", [1, 50, 1e4])
def test_reciprocity(n):
    brdf = phong(n, k_d=Vec3(0.1, 0.2, 0.3), k_s=Vec3(0.5, 0.3, 0.1))
    for a, b in ((10, 40), (60, 65), (5, 85), (45, 45.5)):
        for turn in (0.7, 0.7 + PI, 3.0):
            V, L = tilted(a), tilted(b, turn)
            cosine = max(dot(reflect(V, N), L), 1e-3)
            relative = 8 * U53 * (2 + n * math.sqrt(max(0.0, 1 - cosine**2)) / cosine)  # d log cos^n = n tan d alpha
            f, g = array(brdf.eval(V, L)), array(brdf.eval(L, V))
            assert np.all(np.abs(f - g) <= f * relative + 1e-300)


def test_the_value_of_the_lobe():
    V, L = tilted(20), tilted(50, turn=0.7 + PI)  # R stands at 20 degrees on the other side: 30 degrees from L
    f = phong(8, k_d=Vec3(0.1, 0.2, 0.3), k_s=Vec3(1.0, 0.5, 0.0)).eval(V, L)
    lobe = 10 / (2 * PI) * math.cos(math.radians(30)) ** 8
    assert np.allclose([*f], [0.1 + lobe, 0.2 + lobe / 2, 0.3], rtol=1e-13, atol=0.0)


def test_behind_the_lobe_only_the_diffuse_part_is_left():
    k_d = Vec3(0.1, 0.2, 0.3)
    assert phong(5, k_d=k_d).eval(tilted(80), tilted(60)) == k_d  # 140 degrees from R
    assert phong(1e7, k_d=k_d).eval(tilted(30), tilted(30)) == k_d  # C04: 60 degrees from R, cos^n underflows


def test_the_share_of_the_diffuse_part():
    k_d, k_s = Vec3(0.1, 0.05, 0.02), Vec3(0.4, 0.2, 0.3)
    diffuse, specular = luminance(k_d) * PI, luminance(k_s)
    assert diffuse_share(phong(5, k_d, k_s)) == pytest.approx(diffuse / (diffuse + specular), rel=4 * U53)
    assert diffuse_share(phong(5, black, k_s)) == 0.0
    assert diffuse_share(phong(5, k_d, black)) == 1.0
    assert diffuse_share(phong(5, black, black)) == 1.0
    assert phong(5, k_d, k_s).is_glossy()
    assert not phong(5, k_d, black).is_glossy()


def test_the_parts_of_the_mixture_take_their_shares_of_the_square():
    brdf = phong(40, k_d=Vec3(0.25, 0.25, 0.25) / PI, k_s=Vec3(0.75, 0.75, 0.75))
    V, share = tilted(40), diffuse_share(brdf)
    assert share == pytest.approx(0.25, rel=4 * U53)
    for u1, u2 in squares(100, seed=1):
        w, p = brdf.sample(V, N, (u1, u2))
        if u1 < share:
            want = sample_cos_hemisphere(N, (u1 / share, u2))
        else:
            want = sample_phong_lobe(reflect(V, N), 40.0, ((u1 - share) / (1 - share), u2))
        assert length(w - want) <= 16 * U53 / math.sqrt(abs(u1 - share))
        lobe = 41 / (2 * PI) * max(0.0, dot(reflect(V, N), w)) ** 40
        assert p == pytest.approx(share * max(0.0, dot(w, N)) / PI + (1 - share) * lobe, rel=1e-12)


def metal(kind, alpha_u, alpha_v):
    return RoughConductor(Microfacets(kind, alpha_u, alpha_v), GREY, WHITE * 3.0, WHITE, N, around(N, 1, 0, 0))


def plastic(kind, alpha):
    """Half of what the coat does not reflect passes it, at every angle."""
    coat = View(np.full((1, TABLE + 1), 0.5))
    return RoughPlastic(Microfacets(kind, alpha, alpha), 1.5, GREY / PI, WHITE, False, coat, 0, N, around(N, 1, 0, 0))


MIXTURES = [
    (Lambertian(GREY / PI), 30),
    (phong(5, GREY * (0.4 / PI), GREY), 55),
    (phong(60), 20),
    (phong(2, GREY / PI, black), 70),
    (metal(GGX, 0.6, 0.3), 60),
    (metal(BECKMANN, 0.4, 0.4), 75),
    (plastic(GGX, 0.5), 40),
]


@pytest.mark.parametrize(("brdf", "degrees"), MIXTURES)
def test_samples_have_the_distribution_that_the_pdf_claims(brdf, degrees):
    n, rings, sectors, nodes = size(60_000, 6_000), 8, size(16, 8), 8
    V = tilted(degrees)
    out = np.empty((n, 4))
    sample(brdf, V, np.array(squares(n, seed=2)), out)
    w, p = out[:, :3], out[:, 3]
    assert np.abs((w**2).sum(axis=1) - 1.0).max() <= 32 * U53
    assert same_bits(eval_all(brdf, V, w)[:, 3], p)  # sample() returns pdf()
    local = w @ basis().T
    above = local[:, 2] > 0.0
    box = [[0, 1], [-PI, PI]]
    x, y, z = local[above].T
    counts, *_ = np.histogram2d(z, np.arctan2(y, x), bins=(rings, sectors), range=box)
    zs, wz = composite(nodes, np.linspace(0, 1, rings + 1))
    ps, wp = composite(nodes, np.linspace(-PI, PI, sectors + 1))
    zz, pp = np.meshgrid(zs, ps, indexing="ij")
    r = np.sqrt(1 - zz**2)
    nodes_of = np.stack([r * np.cos(pp), r * np.sin(pp), zz], axis=-1).reshape(-1, 3)
    density = eval_all(brdf, V, nodes_of @ basis())[:, 3].reshape(zz.shape) * np.outer(wz, wp)
    mass = density.reshape(rings, nodes, sectors, nodes).sum(axis=(1, 3))
    below = 1.0 - mass.sum()  # the part of the lobe that lies under the horizon
    assert below > -1e-9
    counts, mass = np.append(counts, (~above).sum()), np.append(mass, max(below, 0.0) if below > 1e-9 else 0.0)
    assert chi_square_p(counts, n * mass) > ALPHA


def test_extreme_points_of_the_square_give_finite_samples():
    for brdf, degrees in [*MIXTURES, (phong(1e7, GREY / PI, GREY), 60), (phong(1e7), 0)]:
        for u1 in (0.0, 2.0**-53, 0.5, 1.0 - 2.0**-53):
            w, p = brdf.sample(tilted(degrees), N, (u1, 0.3))
            assert abs(length(w) - 1.0) <= 16 * U53
            assert 0.0 <= p < math.inf


def test_the_last_point_of_the_square_stays_inside_it():
    """(u - share) / (1 - share) may round to 1 for u = 1 - 2^-53: for this share it does."""
    share = 0.25 + 3 * 2.0**-54
    brdf = phong(10, Vec3(share, share, share) / PI, Vec3(1 - share, 1 - share, 1 - share))
    w, p = brdf.sample(tilted(45), N, (1.0 - 2.0**-53, 0.3))
    assert abs(length(w) - 1.0) <= 16 * U53
    assert 0.0 <= p < math.inf


@pytest.mark.parametrize(("brdf", "degrees"), MIXTURES[:2])
def test_methods_in_plain_python_give_what_the_kernel_gets(brdf, degrees):
    V, u = tilted(degrees), np.array(squares(20, seed=3))
    out = np.empty((20, 4))
    sample(brdf, V, u, out)
    values = eval_all(brdf, V, out[:, :3])
    for i in range(20):
        w, p = brdf.sample(V, N, (float(u[i, 0]), float(u[i, 1])))
        assert same_bits([*w, p], out[i])
        assert same_bits([*brdf.eval(V, w), brdf.pdf(V, w, N)], values[i])
