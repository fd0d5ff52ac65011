"""Samplers against their pdf: raylab's maps pass, each planted bug is named by the check that should see it."""

from __future__ import annotations

import math

import numpy as np
import pytest
from helpers import unit
from scipy.stats import binom
from vectors import density, density_2d, directions, directions_and_pdf, pairs

from raylab import description as d
from raylab import sampling as s
from raylab.brdf import Phong
from raylab.jit import njit
from raylab.light_choice import FewLights, alias_table
from raylab.microfacet import BECKMANN, GGX, Microfacets, pdf_visible_normal, sample_visible_normal
from raylab.sky import make_environment
from raylab.solid_angle import sample_triangle_angle, triangle_angle
from raylab.stats import Counts
from raylab.stats.cells import cells_of, integrate
from raylab.stats.domains import cap, choices, disk, hemisphere, lobe, sphere, square, texels, triangle
from raylab.stats.sampler_check import ENOUGH, check_sampler, first_wrong
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


def lift(z, phi):
    r = np.sqrt(np.maximum(1.0 - z * z, 0.0))
    return np.stack([r * np.cos(phi), r * np.sin(phi), z], axis=1)


def cosine_pdf(w):
    return np.maximum(w[:, 2], 0.0) / PI


def flat_pdf(w):
    return np.where(w[:, 2] >= 0.0, 0.5 / PI, 0.0)


def lobe_pdf(w, n=10.0):
    return (n + 1) / (2 * PI) * np.maximum(w[:, 2], 0.0) ** n


def triangle_pdf(x):
    return np.where((x.min(axis=1) >= 0.0) & (x.sum(axis=1) <= 1.0), 2.0, 0.0)


def malley(r, phi):
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(np.maximum(1.0 - r * r, 0.0))], axis=1)


def to_pole(u):
    """P8: the guard against NaN sends 1 % of all samples to the pole."""
    w = lift(np.sqrt(u[:, 0]), 2 * PI * u[:, 1])
    w[u[:, 0] < 0.01] = (0.0, 0.0, 1.0)
    return w


def three_numbers(u):
    u = u + 1e-9  # no 0 / 0: that is another bug
    return (u / u.sum(axis=1, keepdims=True))[:, :2]


def texel_centres(u):
    centres = (np.floor(u * [16, 32]) + 0.5) / [16, 32]
    return texels(16, 32).from_chart(np.stack([np.arccos(1 - 2 * centres[:, 0]) / PI, centres[:, 1]], axis=1))


def coarse(u):
    """P12: rand() % 1000 / 1000."""
    u = np.floor(1000 * u) / 1000
    return lift(np.sqrt(u[:, 0]), 2 * PI * u[:, 1])


def whole_sphere_pdf(w):
    return np.full(len(w), 0.25 / PI)


UP = hemisphere((0, 0, 1))
# name: sample, pdf, domain, the check that names it, the check that sees it without the Jacobian, its samples there
WRONG = {
    "P1 uniform z, cosine pdf": (
        lambda u: lift(u[:, 0], 2 * PI * u[:, 1]), cosine_pdf, UP, "jacobian", "counts", 384),
    "P2 r = u, cosine pdf": (
        lambda u: malley(u[:, 0], 2 * PI * u[:, 1]), cosine_pdf, UP, "jacobian", "counts", 384),
    "P3 phi up to pi": (
        lambda u: lift(np.sqrt(u[:, 0]), PI * u[:, 1]), cosine_pdf, UP, "jacobian", "counts", 192),
    "P4 phi = 6 u": (
        lambda u: lift(np.sqrt(u[:, 0]), 6.0 * u[:, 1]), cosine_pdf, UP, "jacobian", "counts", 4500),
    "P4 phi = 6.28 u": (
        lambda u: lift(np.sqrt(u[:, 0]), 6.28 * u[:, 1]), cosine_pdf, UP, "jacobian", None, None),
    "P5 one number for two": (
        lambda u: lift(np.sqrt(u[:, 0]), 2 * PI * u[:, 0]), cosine_pdf, UP, "jacobian", "counts", 64),
    "P6 z = u^(1 / 2.05)": (
        lambda u: lift(u[:, 0] ** (1 / 2.05), 2 * PI * u[:, 1]), cosine_pdf, UP, "jacobian", "counts", 2.9e5),
    "P7 lobe u^(1 / n)": (
        lambda u: lift(u[:, 0] ** (1 / 10), 2 * PI * u[:, 1]), lobe_pdf, UP, "jacobian", "counts", 1.5e4),
    "P7 lobe u^(1 / (n + 2))": (
        lambda u: lift(u[:, 0] ** (1 / 12), 2 * PI * u[:, 1]), lobe_pdf, UP, "jacobian", "counts", 1.8e4),
    "P8 1 % to the pole": (to_pole, cosine_pdf, UP, "jacobian counts", "counts", 2.5e5),
    "P9 (u, (1 - u) v)": (
        lambda u: np.stack([u[:, 0], (1 - u[:, 0]) * u[:, 1]], axis=1), triangle_pdf, triangle(),
        "jacobian", "counts", 192),
    "P9 three numbers": (three_numbers, triangle_pdf, triangle(), "counts", "counts", 384),
    "P10 pdf off by a constant": (
        lambda u: lift(np.sqrt(u[:, 0]), 2 * PI * u[:, 1]), lambda w: 0.9 * cosine_pdf(w), UP,
        "jacobian", "integral", None),
    "P10 only pdf() is off": (
        lambda u: ((w := lift(np.sqrt(u[:, 0]), 2 * PI * u[:, 1])), cosine_pdf(w)), lambda w: 0.9 * cosine_pdf(w), UP,
        "returned pdf", "returned pdf", None),
    "P11 texel centres": (texel_centres, whole_sphere_pdf, sphere(), "jacobian", "counts ties", None),
    "P12 a thousand numbers": (coarse, cosine_pdf, UP, "jacobian", "counts ties", None),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_each_planted_bug_is_named_by_the_check_that_should_see_it(name):
    sample, pdf, domain, seen_by, _, _ = WRONG[name]
    numbers = 3 if "three" in name else 2
    wrong = first_wrong(check_sampler(sample, pdf, domain, numbers=numbers, one_to_one=numbers == 2, phi2=2.5e-4))
    assert wrong is not None
    assert wrong.name in seen_by, wrong


@pytest.mark.parametrize("name", WRONG)
def test_without_the_jacobian_counts_need_about_as_many_samples_as_the_theory_says(name):
    """docs/statistics.md has the numbers; the counts look at 64, 128, ... and then at each half as many again."""
    sample, pdf, domain, _, seen_by, samples = WRONG[name]
    numbers = 3 if "three" in name else 2
    findings = check_sampler(sample, pdf, domain, numbers=numbers, one_to_one=False, phi2=2.5e-4)
    wrong = first_wrong(findings)
    if seen_by is None:
        assert wrong is None  # a shift of 5e-4: a million samples in cells cannot see it
        return
    assert wrong.name in seen_by, wrong
    if samples:
        assert wrong.number <= 3 * samples + 256
    if name in ("P8 1 % to the pole", "P11 texel centres", "P12 a thousand numbers"):
        assert "ties" in [f.name for f in findings if not f.ok]


def test_the_sentences_name_the_bug():
    def sentence(name):
        return first_wrong(check_sampler(*WRONG[name][:3])).sentence

    assert "0.5 instead of 1 everywhere" in sentence("P3 phi up to pi")
    assert "0.9 instead of 1 everywhere" in sentence("P10 pdf off by a constant")
    assert "one number for two" in sentence("P5 one number for two")


def test_a_hole_in_the_support_is_found():
    """82: dim directions are never sampled though they shine."""
    z0 = 0.2
    sample = lambda u: lift(z0 + (1 - z0) * u[:, 0], 2 * PI * u[:, 1])  # noqa: E731
    pdf = lambda w: np.where(w[:, 2] >= z0, 0.5 / PI / (1 - z0), 0.0)  # noqa: E731
    assert first_wrong(check_sampler(sample, pdf, UP)) is None
    wrong = first_wrong(check_sampler(sample, pdf, UP, integrand=cosine_pdf))
    assert wrong.name == "support"
    assert wrong.number == pytest.approx(z0, abs=0.1)


# --- bad samplers ---


def good(u):
    return lift(np.sqrt(u[:, 0]), 2 * PI * u[:, 1])


def forgetful(calls=[0]):  # noqa: B006
    def sample(u):
        calls[0] += 1
        return good((u + 0.1 * calls[0]) % 1.0)

    return sample


def changes_its_argument(u):
    u[:] = 0.5 * u
    return good(u)


@pytest.mark.parametrize(
    ("sample", "pdf", "name", "words"),
    [
        (lambda u: good(u)[:, :2], cosine_pdf, "range", "expected (2064, 3)"),
        (lambda u: (good(u), np.ones(3)), cosine_pdf, "range", "densities (3,)"),
        (good, lambda w: 1.0, "range", "pdf() returned an array ()"),
        (forgetful(), cosine_pdf, "range", "other points"),
        (changes_its_argument, cosine_pdf, "range", "changed the random numbers"),
        (good, lambda w: w[:, 0], "range", "negative"),
        (lambda u: np.where(u[:, :1] == 0.0, np.nan, good(u)), cosine_pdf, "range", "u = (0"),
        (lambda u: good(u) / np.where(u[:, :1] == 0.0, 0.0, 1.0), lambda w: np.ones(len(w)), "finiteness", "u = (0"),
        (lambda u: 1.001 * good(u), cosine_pdf, "unit length", "1.001"),
        (lambda u: good(u) * [1, 1, -1], flat_pdf, "domain", "outside the hemisphere"),
    ],
)
@pytest.mark.filterwarnings("ignore:(divide|invalid)")
def test_bad_samplers_are_named(sample, pdf, name, words):
    wrong = first_wrong(check_sampler(sample, pdf, UP))
    assert wrong.name == name
    assert words in wrong.sentence


def test_a_sample_may_be_none_if_it_says_so():
    """Rejection: directions of the whole sphere, those below the horizon with p = 0."""

    def sample(u):
        w = lift(1 - 2 * u[:, 0], 2 * PI * u[:, 1])
        return w, np.where(w[:, 2] > 0.0, 0.25 / PI, 0.0)

    def pdf(w):
        return np.where(w[:, 2] > 0.0, 0.25 / PI, 0.0)

    findings = check_sampler(sample, pdf, UP, may_miss=True, one_to_one=False)
    assert first_wrong(findings) is None, findings
    doubled = check_sampler(
        lambda u: (sample(u)[0], 2 * sample(u)[1]), lambda w: 2 * pdf(w), UP, may_miss=True, one_to_one=False
    )
    assert first_wrong(doubled).name == "counts"  # the pdf integrates to 1, but half of the samples are none


# --- what is written differently is not wrong ---

SAME = {
    "sqrt(1 - u)": (lambda u: lift(np.sqrt(1 - u[:, 0]), 2 * PI * u[:, 1]), cosine_pdf, UP),
    "left-handed frame": (lambda u: lift(np.sqrt(u[:, 0]), -2 * PI * u[:, 1]), cosine_pdf, UP),
    "swapped vertices": (lambda u: s_triangle(u)[:, ::-1], triangle_pdf, triangle()),
    "reflected square": (
        lambda u: np.where(u.sum(axis=1, keepdims=True) > 1, 1 - u, u), triangle_pdf, triangle()),
    "Malley": (lambda u: malley(np.sqrt(u[:, 0]), 2 * PI * u[:, 1]), cosine_pdf, UP),
    "abs of what is not negative": (lambda u: lift(np.abs(np.sqrt(u[:, 0])), 2 * PI * u[:, 1]), cosine_pdf, UP),
}  # fmt: skip


def s_triangle(u):
    root = np.sqrt(u[:, 0])
    return np.stack([root * (1 - u[:, 1]), root * u[:, 1]], axis=1)


@pytest.mark.parametrize("name", SAME)
def test_equivalent_samplers_do_not_fail(name):
    one_to_one = name != "reflected square"
    for _ in range(3):
        findings = check_sampler(*SAME[name], phi2=2e-3, one_to_one=one_to_one)
        assert first_wrong(findings) is None, findings


def test_false_alarms_are_as_rare_as_promised():
    """At alpha = 0.2 more than `limit` of 60 right samplers fail with probability 1e-6 at most."""
    limit = binom.isf(1e-6, 60, 0.2)
    failed = sum(first_wrong(check_sampler(*SAME["sqrt(1 - u)"], phi2=0.1, alpha=0.2)) is not None for _ in range(60))
    assert failed <= limit


def test_cells_are_about_equally_probable():
    cells = cells_of(cosine_pdf, UP)
    assert len(cells.p) == 128
    assert cells.p.sum() == pytest.approx(1.0, abs=1e-12)
    assert cells.p.max() < 2.0 * cells.p.min()


@pytest.mark.parametrize("shape", ["wave", "cell", "noise"])
def test_the_evidence_sees_what_it_is_said_to_see(shape):
    """At N phi^2 = ENOUGH at least 99 of 100 alternatives are refuted, however the difference is spread."""
    cells, phi2, runs, rng = 128, 2e-3, 300, np.random.default_rng()
    p = np.full(cells, 1.0 / cells)
    off = {"wave": np.cos(np.arange(cells) * 2 * PI / cells), "cell": np.eye(cells)[0], "noise": rng.normal(size=cells)}
    e = off[shape] - off[shape].mean()
    q = p * (1.0 + e * math.sqrt(phi2 / (p * e * e).sum()))
    missed = 0
    for _ in range(runs):
        test = Counts(p)
        test.n[:cells] = rng.multinomial(int(ENOUGH / phi2), q)
        missed += test.log_evidence() < -math.log(3.3e-9 / 2)
    assert missed <= binom.isf(1e-6, runs, 0.01)
