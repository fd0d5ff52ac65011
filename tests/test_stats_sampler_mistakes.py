"""Samplers that are wrong, in numpy: each planted bug is named by the check that should see it, and nothing else is."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.stats import binom

from raylab.stats import Counts
from raylab.stats.cells import cells_of
from raylab.stats.domains import hemisphere, sphere, texels, triangle
from raylab.stats.sampler_check import ENOUGH, check_sampler, first_wrong

PI = math.pi


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
