"""Trials under skies: a gradient, an image, a ball in the way, surfaces with a lobe. x is the origin, its normal +z.

Bounds of one sample, f the largest f_r, L the largest radiance of the channel:

    uniform hemisphere: 2 pi f L          cosine: pi f L          BRDF: see `raylab.trials.lights`
    brightness, p = lum(w) / M:  f M max(L_c / lum)  over what shines
    gradient by brightness over the sphere, M = 4 pi a:  no more than  f 4 pi a max L_c / min lum
    glossy jitters: k_s L;  Phong's lobe by itself: k_s L (n + 2) / (n + 1)
"""

from __future__ import annotations

import math

import numpy as np

from raylab import description as d
from raylab.closed_forms import glossy as jitters
from raylab.closed_forms import irradiance as forms
from raylab.closed_forms import phong
from raylab.trials.lights import by_brdf
from raylab.trials.trial import BLACK, LUMINANCE, Answer, Array, Trial, Z, affine, colour, stage, unit

COMBINED = ("direct", "mis_balance", "mis_power")
# From the coordinates of an image to those of `forms.texels`: pole +z, longitude from +x.
TO_POLE = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def diffuse_answers(truth: Array, reflectance: Array, brightest: Array, by_brightness: Array) -> dict[str, Answer]:
    """Answers of all techniques for a diffuse surface; those that combine two add their bounds."""
    cosine = reflectance * brightest
    return {
        "env_uniform": Answer.of(truth, 2.0 * cosine),
        "env_cosine": Answer.of(truth, cosine),
        "env_brdf": Answer.of(truth, cosine),
        "env_brightness": Answer.of(truth, by_brightness),
    } | {name: Answer.of(truth, cosine + by_brightness) for name in COMBINED}


def random_gradient(rng: np.random.Generator) -> tuple[Array, Array]:
    """Radiance a (3,) and slopes (3, 3), one row for each channel, no longer than 0.8 a."""
    a, rows = colour(rng, 0.5, 3.0), rng.normal(size=(3, 3))
    rows *= (a * rng.uniform(0.5, 0.8, 3) / np.linalg.norm(rows, axis=1))[:, None]
    return a, rows


def spans(a: Array, rows: Array) -> tuple[Array, Array, float]:
    """Of L(w) = a + rows . w: the largest radiance, M = 4 pi lum(a), and the least luminance."""
    steepest = float(np.linalg.norm(LUMINANCE @ rows))
    return a + np.linalg.norm(rows, axis=1), 4.0 * math.pi * (LUMINANCE @ a), float(LUMINANCE @ a) - steepest


def _under(name, rng, material, a, rows, ball, view, answers) -> Trial:
    return stage(
        name, rng, answers, material=material, shapes=(ball,),
        sky=lambda turn: d.GradientEnvironment(a, rows @ turn.T), view=view,
    )  # fmt: skip


def _ball(centre: Array, radius: float) -> d.Sphere:
    return d.Sphere(center=centre, radius=radius, front=None)


def gradient_sky(rng: np.random.Generator) -> Trial:
    """L(w) = a + b . w with another b for each channel; a ball below the horizon changes nothing."""
    reflectance = colour(rng)
    a, rows = random_gradient(rng)
    truth = reflectance / math.pi * np.array([forms.gradient_sky(a[c], rows[c]) for c in range(3)])
    brightest, total, least = spans(a, rows)
    answers = diffuse_answers(truth, reflectance, brightest, reflectance / math.pi * brightest * total / least)
    ball = _ball(np.array([0.5, 0.3, -1.6]), 0.6)
    return _under("gradient_sky", rng, d.Diffuse(reflectance), a, rows, ball, unit(50, rng.uniform(0, 360)), answers)


def ball_before_sky(rng: np.random.Generator) -> Trial:
    """A constant sky, part of it hidden by a ball that is cut by the horizon."""
    reflectance, a = colour(rng), colour(rng, 0.5, 3.0)
    radius, distance, elevation = rng.uniform(0.5, 0.8), rng.uniform(1.2, 1.8), rng.uniform(5, 25)
    hidden = forms.sphere_before_sky(radius, distance, math.sin(math.radians(elevation)))
    truth = reflectance / math.pi * a * float(hidden)
    answers = diffuse_answers(truth, reflectance, a, reflectance * a * 4.0)
    turn = rng.uniform(0, 360)
    ball, view = _ball(distance * unit(elevation, turn), radius), unit(50, turn + 150)
    return _under("ball_before_sky", rng, d.Diffuse(reflectance), a, np.zeros((3, 3)), ball, view, answers)


def image_sky(rng: np.random.Generator) -> Trial:
    """Texels around a pole up to 18 degrees off the normal, dark below 72 degrees from it, one like a sun."""
    reflectance, pixels = colour(rng), np.zeros((10, 16, 3))
    pixels[:4] = rng.random((4, 16, 3)) ** 2 + 0.02
    pixels[rng.integers(1, 3), rng.integers(16)] = colour(rng, 5.0, 20.0)
    pole = unit(90.0 - rng.uniform(8, 18), rng.uniform(0, 360))
    across = np.cross(Z, pole) / np.linalg.norm(np.cross(Z, pole))
    frame = np.stack([across, np.cross(pole, across), pole], axis=1)  # columns: the sky's x, y and pole
    v, solid_angles = forms.texels(10, 16)
    truth = reflectance / math.pi * np.einsum("ijc,ijk,k->c", pixels, v, frame.T @ Z)
    luminance = pixels @ LUMINANCE
    ratio = np.max(pixels[:4] / luminance[:4, :, None], axis=(0, 1))
    by_brightness = reflectance / math.pi * float((luminance * solid_angles).sum()) * ratio
    answers = diffuse_answers(truth, reflectance, pixels.max(axis=(0, 1)), by_brightness)
    return stage(
        "image_sky", rng, answers, material=d.Diffuse(reflectance), view=unit(55, rng.uniform(0, 360)),
        sky=lambda turn: d.ImageEnvironment(pixels, affine(turn @ frame @ TO_POLE, BLACK), "nearest"),
    )  # fmt: skip


def glossy_sky(rng: np.random.Generator) -> Trial:
    """A surface with a lobe of odd exponent, seen askew, so that the horizon cuts the lobe, under a constant sky."""
    diffuse, specular, n = colour(rng, 0.1, 0.5), colour(rng, 0.1, 0.5), int(2 * rng.integers(1, 5) + 1)
    a, view = colour(rng, 0.5, 3.0), unit(rng.uniform(20, 50), rng.uniform(0, 360))
    lobe, cosine = a * specular, float(view[2])
    answers = _glossy(diffuse, specular, n, a, np.zeros((3, 3)), a * diffuse + lobe * phong.constant_sky(n, cosine))
    answers["glossy_phong"] = Answer.of(lobe * phong.constant_sky(n, cosine), lobe * (n + 2) / (n + 1))
    answers["glossy_jitter"] = Answer.of(lobe * jitters.jitter_constant_sky(2.0 / math.sqrt(n + 3.0), cosine), lobe)
    answers["glossy_normal"] = Answer.of(lobe * jitters.normal_constant_sky(4.0 * n + 1.0, cosine), lobe)
    ball, material = _ball(np.array([0.5, 0.3, -1.6]), 0.6), d.Phong(diffuse, specular, float(n))
    return _under("glossy_sky", rng, material, a, np.zeros((3, 3)), ball, view, answers)


def glossy_gradient(rng: np.random.Generator) -> Trial:
    """A surface with a lobe seen along its normal under a gradient, of which the lobe's symmetry leaves b . n."""
    diffuse, specular, n = colour(rng, 0.1, 0.5), colour(rng, 0.1, 0.5), int(2 * rng.integers(1, 5) + 1)
    a, rows = random_gradient(rng)
    up = rows @ Z
    below = np.array([forms.gradient_sky(a[c], rows[c]) for c in range(3)]) / math.pi
    lobe = specular * phong.gradient_sky(n, a, up)  # type: ignore[arg-type]
    answers = _glossy(diffuse, specular, n, a, rows, diffuse * below + lobe)
    brightest = spans(a, rows)[0] * specular
    radius, e = 2.0 / math.sqrt(n + 3.0), 4.0 * n + 1.0
    jitter = [jitters.jitter_gradient_sky(radius, *pair) for pair in zip(a, up, strict=True)]
    normal = [jitters.normal_gradient_sky(e, *pair) for pair in zip(a, up, strict=True)]
    answers["glossy_phong"] = Answer.of(lobe, brightest * (n + 2) / (n + 1))
    answers["glossy_jitter"] = Answer.of(specular * np.array(jitter), brightest)
    answers["glossy_normal"] = Answer.of(specular * np.array(normal), brightest)
    ball, material = _ball(np.array([0.5, 0.3, -1.6]), 0.6), d.Phong(diffuse, specular, float(n))
    return _under("glossy_gradient", rng, material, a, rows, ball, Z, answers)


def _glossy(diffuse: Array, specular: Array, n: int, a: Array, rows: Array, truth: Array) -> dict[str, Answer]:
    brightest, total, least = spans(a, rows)
    largest = diffuse / math.pi + specular * (n + 2) / (2.0 * math.pi)
    by_brightness = largest * brightest * total / least
    lobe = by_brdf(brightest, diffuse, specular, n)
    return {
        "env_brightness": Answer.of(truth, by_brightness),
        "env_brdf": Answer.of(truth, lobe),
    } | {name: Answer.of(truth, lobe + by_brightness) for name in COMBINED}
