"""Planted: mistakes in what students write, each with the causes that would be right to name.

The right answers, in many manners, are those of tests/manners.py; a row is an edit of one of them (`old` must occur in
the function or in its helpers). `python planted.py` (PYTHONPATH=..:.) diagnoses all of them in plain Python and writes
docs/diagnosis.md.
"""

from __future__ import annotations

import sys
import time
from collections import Counter
from contextlib import redirect_stdout
from dataclasses import dataclass
from functools import cache
from io import StringIO
from pathlib import Path
from typing import Any

import manners
import numpy as np
from manners import Right

from raylab.grading import assignment
from raylab.grading.diagnosis import diagnose
from raylab.grading.evidence import Diagnosis
from raylab.grading.source import Interpreted
from raylab.grading.table import Table, path_of

HERE = Path(__file__).parent
FOR_MOMENTS = 1 << 10  # samples of each scene, in plain Python
TASKS = tuple(task.id for name in assignment.NAMES for task in assignment.load(name).tasks)
RIGHT: dict[str, Right] = {right.style: right for task in TASKS for right in manners.of_task(task)}


@dataclass(frozen=True)
class Planted:
    """A mistake in a right answer, and what is right to say of it."""

    right: Right
    causes: tuple[str, ...]
    edits: tuple[tuple[str, str], ...]

    @property
    def name(self) -> str:
        return f"{self.right.style}: {self.edits[0][0]} -> {self.edits[0][1]}".replace("\n", " ")

    def function(self) -> Any:
        return self.right.function(self.edits)


# style, causes with | between, and pairs of old and new text
ROWS: tuple[tuple[str, ...], ...] = (
    # --- a1: with helpers ---
    ("with_helpers", "distance missing", "/ (r * r)", ""),
    ("with_helpers", "distance power", "/ (r * r)", "/ r"),
    ("with_helpers", "distance power", "/ (r * r)", "* (r * r)"),
    ("with_helpers", "light cosine missing", " * clamped(-dot(d, y.n) / r)", ""),
    ("with_helpers", "receiver cosine missing", "clamped(dot(d, N) / r) * ", ""),
    ("with_helpers", "distance power|distance missing", "dot(d, N) / r)", "dot(d, N))"),
    ("with_helpers", "distance power|distance missing", "-dot(d, y.n) / r)", "-dot(d, y.n))"),
    ("with_helpers", "black", "clamped(-dot(d, y.n)", "clamped(dot(d, y.n)"),
    ("with_helpers", "black", "clamped(dot(d, N)", "clamped(-dot(d, N)"),
    ("with_helpers", "no shadow test", "return 0.0 if shadow(scene, x, y) else 1.0", "return 1.0"),
    ("with_helpers", "shadow inverted", "0.0 if shadow(scene, x, y) else 1.0", "1.0 if shadow(scene, x, y) else 0.0"),
    ("with_helpers", "receiver cosine not clamped", "    if c > 0:\n        return c\n    return 0.0", "    return c"),
    ("with_helpers", "receiver cosine absolute", "    if c > 0:\n        return c\n    return 0.0", "    return abs(c)"),
    ("with_helpers", "k_d missing", "light.radiance * k_d", "light.radiance"),
    ("with_helpers", "radiance missing", "light.radiance * k_d", "k_d"),
    ("with_helpers", "pdf missing", " / p)", ")"),
    ("with_helpers", "pdf multiplied", " / p)", " * p)"),
    ("with_helpers", "last light only", "total = total + one", "total = one"),
    ("with_helpers", "first light only", "    return total", "        return total\n    return total"),
    ("with_helpers", "same numbers for all lights", "    total = DARK", "    total, u = DARK, rng.square()", "rng.square())\n    return", "u)\n    return"),
    ("with_helpers", "receiver cosine power", "clamped(dot(d, N) / r) *", "clamped(dot(d, N) / r) ** 2 *"),
    ("with_helpers", "light cosine power", "clamped(-dot(d, y.n) / r)", "clamped(-dot(d, y.n) / r) ** 2"),
    ("with_helpers", "factor", "/ (r * r)", "/ (r * r) * math.pi"),
    ("with_helpers", "factor", "/ (r * r)", "/ (4 * math.pi * r * r)"),
    # --- a1: early ends ---
    ("early_ends", "receiver cosine not clamped", "        if cos_x <= 0.0:\n            continue\n", ""),
    ("early_ends", "no shadow test", "        if shadow(scene, x, y):\n            continue\n", ""),
    ("early_ends", "shadow inverted", "if shadow(scene, x, y):", "if not shadow(scene, x, y):"),
    ("early_ends", "black", "cos_y = -dot(L, y.n)", "cos_y = dot(L, y.n)"),
    ("early_ends", "black", "L = normalize(y - x)", "L = normalize(x - y)"),
    ("early_ends", "normal of the triangle", "cos_x = dot(L, N)", "cos_x = dot(L, x.n)"),
    ("early_ends", "light cosine missing", "cos_x * cos_y", "cos_x"),
    ("early_ends", "receiver cosine missing", "cos_x * cos_y", "cos_y"),
    ("early_ends", "distance missing", "(dist_sqr(x, y) * p_y)", "p_y"),
    ("early_ends", "pdf missing", "(dist_sqr(x, y) * p_y)", "dist_sqr(x, y)"),
    ("early_ends", "pdf multiplied", "(dist_sqr(x, y) * p_y)", "dist_sqr(x, y) * p_y"),
    ("early_ends", "distance power", "(dist_sqr(x, y) * p_y)", "dist_sqr(x, y) / p_y * dist_sqr(x, y) * dist_sqr(x, y)"),
    ("early_ends", "last light only", "result = result + light", "result = light"),
    ("early_ends", "epsilon", "(dist_sqr(x, y) * p_y)", "((dist_sqr(x, y) + 0.001) * p_y)"),
    ("early_ends", "first light only", "    return result", "        return result\n    return result"),
    ("early_ends", "counted twice|factor", "    return result", "    return result + result"),
    # --- a1: by hand ---
    ("by_hand", "distance power|distance missing", "f = cx * cy / d2 / p_y", "f = cx * cy / d / p_y"),
    ("by_hand", "distance missing", "f = cx * cy / d2 / p_y", "f = cx * cy / p_y"),
    ("by_hand", "pdf missing", "/ d2 / p_y", "/ d2"),
    ("by_hand", "area for pdf", "/ d2 / p_y", "/ d2 * light.area"),
    ("by_hand", "light cosine missing", "f = cx * cy", "f = cx"),
    ("by_hand", "receiver cosine missing", "f = cx * cy", "f = cy"),
    ("by_hand", "no shadow test", " and not shadow(scene, x, y)", ""),
    ("by_hand", "shadow inverted", "and not shadow", "and shadow"),
    ("by_hand", "last light only", "r += ", "r = ", "g += ", "g = ", "b += ", "b = "),
    ("by_hand", "receiver cosine not clamped", "cx > 0 and cy > 0 and not", "not"),
    ("by_hand", "normal of the triangle", "dx * N.x + dy * N.y + dz * N.z", "dx * x.n.x + dy * x.n.y + dz * x.n.z"),
    ("by_hand", "distance power", "math.sqrt(d2)", "d2"),
    ("by_hand", "factor", "f = cx * cy", "f = 2 * math.pi * cx * cy"),
    ("by_hand", "k_d power", "* f\n            g", "* k_d.x * f\n            g", "k_d.y * f", "k_d.y * k_d.y * f", "k_d.z * f", "k_d.z * k_d.z * f"),
    ("by_hand", "black", "cy = -(dx", "cy = (dx"),
    # --- a1: an index ---
    ("by_index", "pdf of another light", "/ p_y *", "* scene.lights[0].area *"),
    ("by_index", "last light only", "result += scene", "result = scene"),
    ("by_index", "receiver cosine absolute", " * (dot(L, N) > 0)", ""),
    ("by_index", "shadow inverted", "== False", "== True"),
    ("by_index", "radiance missing", "scene.lights[i].radiance * k_d", "k_d"),
    ("by_index", "divided by the lights", "    return result", "    return result / len(scene.lights)"),
    ("by_index", "not random", "rng.square()", "(0.5, 0.5)"),
    ("by_index", "light cosine missing", " * max(0.0, dot(-L, y.n))", ""),
    ("by_index", "pdf power", "/ p_y *", "/ (p_y * p_y) *"),
    # --- a1: while; other numbers ---
    ("with_while", "one random number for two", "(u1, u2)", "(u1, u1)"),
    ("with_while", "last light only", "result += light", "result = light"),
    ("with_while", "distance missing", "(p_y * dist_sqr(x, y))", "p_y"),
    ("with_while", "light cosine missing", " * max(0, dot(-L, y.n))", ""),
    ("with_while", "other normal at the light", "max(0, dot(-L, y.n))", "max(0, dot(L, N))"),
    ("with_while", "factor", "    return result", "    return result / math.pi"),
    ("with_while", "no shadow test", "if not shadow(scene, x, y):", "if p_y > 0:"),
    ("other_numbers", "distance missing|distance power", "dot(w, w) ** 2", "dot(w, w)"),
    ("other_numbers", "distance power", "dot(w, w) ** 2", "dot(w, w) ** 1.5"),
    ("other_numbers", "pdf missing", " / p_y)", ")"),
    ("other_numbers", "light cosine missing", "max(0.0, -dot(w, y.n)) / dot(w, w) ** 2", "1.0 / dot(w, w) ** 1.5"),
    ("other_numbers", "receiver cosine missing", "max(0.0, dot(w, N)) * max(0.0, -dot(w, y.n)) / dot(w, w) ** 2", "max(0.0, -dot(w, y.n)) / dot(w, w) ** 1.5"),
    ("other_numbers", "no shadow test", "if not shadow(scene, x, y):", "if True:"),
    ("other_numbers", "shadow inverted", "if not shadow(scene, x, y):", "if shadow(scene, x, y):"),
    ("other_numbers", "last light only", "result += light", "result = light"),
    ("other_numbers", "factor", "    return result", "    return result * math.pi"),
    ("other_numbers", "factor|counted twice", "    return result", "    return 2 * result"),
    ("other_numbers", "receiver cosine not clamped", "max(0.0, dot(w, N))", "dot(w, N)"),
    # --- a2 ---
    ("area_keywords", "V and L reversed", "brdf.eval(eye, L)", "brdf.eval(-eye, L)"),
    ("area_keywords", "V and L reversed", "brdf.eval(eye, L)", "brdf.eval(eye, -L)"),
    ("area_keywords", "only diffuse", "brdf.eval(eye, L)", "brdf.k_d"),
    ("area_keywords", "N for V", "brdf.eval(eye, L)", "brdf.eval(normal, L)"),
    ("area_keywords", "pdf missing", " / p_y)", ")"),
    ("area_keywords", "receiver cosine missing", "max(0.0, dot(L, normal)) * ", ""),
    ("area_keywords", "no shadow test", "if not shadow(scene, point, y):", "if True:"),
    ("area_keywords", "last light only", "result += light", "result = light"),
    ("area_keywords", "receiver cosine absolute", "max(0.0, dot(L, normal))", "abs(dot(L, normal))"),
    ("area_keywords", "normal of the triangle", "dot(L, normal)", "dot(L, point.n)"),
    ("area_sum", "last light only", "total += e", "total = e"),
    ("area_sum", "divided by the lights", "    return total", "    return total / len(E)"),
    ("area_sum", "f_r missing", " * brdf.eval(V, L)", ""),
    ("area_sum", "shadow inverted", "if shadow(scene, x, y):", "if not shadow(scene, x, y):"),
    ("area_sum", "light cosine missing", " * max(0.0, dot(-L, y.n))", ""),
    ("area_sum", "distance missing", "(dist_sqr(x, y) * p_y)", "p_y"),
    ("area_sum", "pdf missing", "(dist_sqr(x, y) * p_y)", "dist_sqr(x, y)"),
    ("area_sum", "receiver cosine not clamped", "max(0.0, dot(L, N))", "dot(L, N)"),
    ("area_sum", "not random", "rng.square()", "(0.5, 0.5)"),
    ("area_sum", "factor", "return light.radiance", "return 3.141592653589793 * light.radiance"),
    ("area_sum", "receiver cosine power", "(max(0.0, dot(L, N))", "(max(0.0, dot(L, N)) ** 2"),
    # --- a3 ---
    ("uniform_own", "pdf missing|factor", " * (z / p_w)", " * z"),
    ("uniform_own", "pdf multiplied|factor", "(z / p_w)", "(z * p_w)"),
    ("uniform_own", "factor", "p_w = 1.0 / (2.0 * math.pi)", "p_w = 1.0 / math.pi"),
    ("uniform_own", "factor|counted twice", "p_w = 1.0 / (2.0 * math.pi)", "p_w = 1.0 / (4.0 * math.pi)"),
    ("uniform_own", "receiver cosine missing", "(z / p_w)", "(1.0 / p_w)"),
    ("uniform_own", "no shadow test", "    if shadow_toward(scene, x, w):\n        return black\n    p_w", "    p_w"),
    ("uniform_own", "shadow inverted", "if shadow_toward(scene, x, w):\n        return black\n    p_w", "if not shadow_toward(scene, x, w):\n        return black\n    p_w"),
    ("uniform_own", "cosine for uniform", "z = 2.0 * math.pi * u1, u2", "z = 2.0 * math.pi * u1, math.sqrt(u2)"),
    ("uniform_own", "k_d missing", "eval(w) * k_d * (z", "eval(w) * (z"),
    ("uniform_own", "radiance of another direction", "return scene.environment.eval(w) * k_d * (z", "return scene.environment.eval(N) * k_d * (z"),
    ("uniform_own", "receiver cosine power", "(z / p_w)", "(z * z / p_w)"),
    ("uniform_slide", "factor|counted twice", "* (2.0 * PI)", "* (4.0 * PI)"),
    ("uniform_slide", "factor|other technique", "* (2.0 * PI)", "* PI"),
    ("uniform_rejected", "no shadow test", "    if shadow_toward(scene, x, w):\n        return black\n    return scene.environment.eval(w) * k_d * dot(w, N) * 2 * PI", "    return scene.environment.eval(w) * k_d * dot(w, N) * 2 * PI"),
    ("uniform_rejected", "factor", "* 2 * PI", "* PI"),
    ("uniform_rejected", "receiver cosine missing", "k_d * dot(w, N) * 2", "k_d * 2"),
    ("cosine_slide", "receiver cosine power", "k_d * PI", "k_d * PI * dot(w, N)"),
    ("cosine_slide", "factor|counted twice", "k_d * PI", "k_d * 2 * PI"),
    ("cosine_slide", "factor", "k_d * PI", "k_d"),
    ("cosine_slide", "uniform for cosine", "sample_cos_hemisphere", "sample_hemisphere"),
    ("cosine_sphere", "no shadow test", "black if shadow_toward(scene, x, w) else ", ""),
    ("cosine_sphere", "factor", "k_d * np.pi", "k_d / np.pi"),
    ("cosine_sphere", "k_d missing", "* k_d * np.pi", "* np.pi"),
    ("cosine_sphere", "receiver cosine power", "k_d * np.pi", "k_d * np.pi * dot(w, N)"),
    ("cosine_sphere", "radiance missing", "scene.environment.eval(w) * k_d * np.pi", "k_d * np.pi"),
    ("cosine_sphere", "radiance of another direction", "else scene.environment.eval(w)", "else scene.environment.eval(N)"),
    # --- a4 ---
    ("brdf_slide", "receiver cosine missing", "(dot(w, N) / p_w)", "(1.0 / p_w)"),
    ("brdf_slide", "pdf missing", "dot(w, N) / p_w", "dot(w, N)"),
    ("brdf_slide", "pdf multiplied", "dot(w, N) / p_w", "dot(w, N) * p_w"),
    ("brdf_slide", "f_r missing", " * brdf.eval(V, w)", ""),
    ("brdf_slide", "no shadow test", "shadow_toward(scene, x, w) or ", ""),
    ("brdf_slide", "receiver cosine not clamped", " or dot(w, N) <= 0.0", ""),
    ("brdf_slide", "other technique", "brdf.sample(V, N, rng.square())", "scene.environment.sample(N, rng.square())"),
    ("brdf_slide", "only diffuse", "brdf.eval(V, w)", "brdf.k_d"),
    ("brdf_slide", "radiance of another direction", "scene.environment.eval(w)", "scene.environment.eval(-w)"),
    ("brightness_slide", "other technique", "sky.sample(N, rng.square())", "brdf.sample(V, N, rng.square())"),
    ("brightness_slide", "no shadow test", "not shadow_toward(scene, x, w) and ", ""),
    ("brightness_slide", "shadow inverted", "if not shadow_toward", "if shadow_toward"),
    ("brightness_slide", "receiver cosine missing", " * max(0.0, dot(w, N))", ""),
    ("brightness_slide", "receiver cosine absolute", "max(0.0, dot(w, N))", "abs(dot(w, N))"),
    ("brightness_slide", "pdf missing", " / p_w\n    return", "\n    return"),
    ("brightness_slide", "N for V", "brdf.eval(V, w)", "brdf.eval(N, w)"),
    ("brightness_slide", "radiance power", "sky.eval(w) * brdf", "sky.eval(w) * sky.eval(w) * brdf"),
    # --- a5 ---
    ("phong_own", "exponent off by one", "f = (n + 2)", "f = (n + 1)"),
    ("phong_own", "exponent off by one", "p = (n + 1)", "p = (n + 2)"),
    ("phong_own", "receiver cosine missing", "f * max(0.0, dot(w, N)) / p", "f / p"),
    ("phong_own", "lobe around N", "R = 2.0 * dot(V, N) * N - V", "R = N"),
    ("phong_own", "not mirrored", "R = 2.0 * dot(V, N) * N - V", "R = V"),
    ("phong_own", "exponent off by one", "(1.0 / (n + 1.0))", "(1.0 / n)"),
    ("phong_own", "k_d missing", "light_from(scene, x, w, N) * k_s", "light_from(scene, x, w, N)"),
    ("phong_own", "factor|counted twice", "f = (n + 2) / (2 * PI)", "f = (n + 2) / PI"),
    ("phong_own", "pdf missing", " / p)", ")"),
    ("phong_slide", "exponent off by one", "(n + 2.0) / (n + 1.0)", "(n + 1.0) / (n + 2.0)"),
    ("phong_slide", "no shadow test", "light_from(scene, x, w, N)", "scene.environment.eval(w)"),
    ("phong_slide", "V and L reversed|black", "reflect(V, N)", "reflect(-V, N)"),
    # --- a7 ---
    ("mis_slide", "weights missing", " * balance(p_y, p_b)", ""),
    ("mis_slide", "weights missing", " * balance(p_w, p_l)", ""),
    ("mis_slide", "measure of the weight", " * to_area(x, y)", ""),
    ("mis_slide", "weights exchanged", "balance(p_w, p_l)", "balance(p_l, p_w)"),
    ("mis_slide", "no shadow test", "if not shadow(scene, x, y):", "if True:"),
    ("mis_slide", "BRDF samples only", "    w, p_w = brdf.sample(V, N, rng.square())", "    result = black\n    w, p_w = brdf.sample(V, N, rng.square())"),
    ("mis_slide", "light samples only", "        result += L_i * brdf", "        L_i * brdf"),
    ("mis_slide", "receiver cosine missing", " * max(0.0, dot(L, N))", ""),
    ("mis_slide", "weights of one half", " * balance(p_y, p_b)", " * 0.5", " * balance(p_w, brdf.pdf(V, w, N))", " * 0.5", " * balance(p_w, p_l)", " * 0.5"),
    ("mis_by_hand", "weights missing", "(p_as_direction + brdf.pdf(V, L, N))", "p_as_direction"),
    ("mis_by_hand", "light samples only", "total = L * brdf.eval(V, w) * dot(w, N) / (p_w + p)", "total = black"),
    ("mis_by_hand", "measure of the weight", "p_as_direction = p_y * d2 / cos_y", "p_as_direction = p_y"),
    # --- a3: samplers ---
    ("a3.hemisphere_slide", "cosine for uniform", "math.sqrt(1.0 - u[0] * u[0])", "math.sqrt(1.0 - u[0])", "phi), u[0])", "phi), math.sqrt(u[0]))"),
    ("a3.hemisphere_slide", "not of unit length", "math.sqrt(1.0 - u[0] * u[0])", "math.sqrt(u[0])"),
    ("a3.hemisphere_slide", "half a turn", "2.0 * PI * u[1]", "PI * u[1]"),
    ("a3.hemisphere_slide", "not turned to the axis", "from_frame(N, r * math.cos(phi), r * math.sin(phi), u[0])", "Vec3(r * math.cos(phi), r * math.sin(phi), u[0])"),
    ("a3.hemisphere_turned", "sine for cosine", "s * (r * math.cos(phi)) + t * (r * math.sin(phi)) + N * z", "s * (z * math.cos(phi)) + t * (z * math.sin(phi)) + N * r"),
    ("a3.hemisphere_turned", "not of unit length", "1.0 - z * z", "1.0 - z"),
    ("a3.hemisphere_turned", "half a turn", "TWO_PI * u[0]", "PI * u[0]"),
    ("a3.hemisphere_mirrored", "below the horizon", "cos_theta)\n", "-cos_theta)\n"),
    ("a3.hemisphere_mirrored", "cosine for uniform", "cos_theta = 1.0 - u[0]", "cos_theta = math.sqrt(u[0])"),
    ("a3.hemisphere_angles", "angle for height", "math.acos(1.0 - u[0])", "0.5 * PI * u[0]"),
    ("a3.hemisphere_angles", "sine for cosine", "math.acos(1.0 - u[0])", "math.asin(1.0 - u[0])"),
    ("a3.hemisphere_angles", "whole sphere", "math.acos(1.0 - u[0])", "math.acos(1.0 - 2.0 * u[0])"),
    ("a3.hemisphere_own_frame", "one random number for two", "math.cos(TWO_PI * u[1])", "math.cos(TWO_PI * u[0])", "math.sin(TWO_PI * u[1])", "math.sin(TWO_PI * u[0])"),
    ("a3.hemisphere_own_frame", "not of unit length", "normalize(cross(a, n))", "cross(a, n)"),
    ("a3.hemisphere_sphere", "whole sphere", "    if dot(w, N) < 0.0:\n        w = -w\n", ""),
    ("a3.hemisphere_sphere", "below the horizon", "dot(w, N) < 0.0", "dot(w, N) > 0.0"),
    ("a3.hemisphere_by_hand", "not random", "z, phi = u[0]", "z, phi = 0.5"),
    ("a3.hemisphere_reflected", "cosine for uniform", "u[0] * (2.0 - u[0])", "u[0]", "1.0 - u[0])", "math.sqrt(1.0 - u[0]))"),
    ("a3.cos_hemisphere_slide", "no square root", "r, phi = math.sqrt(u[0])", "r, phi = u[0]", "math.sqrt(1.0 - u[0])", "math.sqrt(1.0 - u[0] * u[0])"),
    ("a3.cos_hemisphere_slide", "uniform for cosine", "r, phi = math.sqrt(u[0])", "r, phi = math.sqrt(1.0 - u[0] * u[0])", "math.sqrt(1.0 - u[0]))", "u[0])"),
    ("a3.cos_hemisphere_slide", "not of unit length", "math.sqrt(1.0 - u[0])", "1.0 - u[0]"),
    ("a3.cos_hemisphere_turned", "not of unit length", "r, phi = math.sqrt(u[1])", "r, phi = u[1]"),
    ("a3.cos_hemisphere_turned", "half a turn", "TWO_PI * u[0]", "u[0]"),
    ("a3.cos_hemisphere_angles", "angle for height", "math.asin(math.sqrt(u[0]))", "0.5 * PI * u[0]"),
    ("a3.cos_hemisphere_angles", "uniform for cosine", "math.asin(math.sqrt(u[0]))", "math.acos(u[0])"),
    ("a3.cos_hemisphere_angles", "not turned to the axis", "from_frame(N, ", "Vec3("),
    ("a3.cos_hemisphere_own_frame", "no square root", "r = math.sqrt(u[0])", "r = u[0]"),
    ("a3.cos_hemisphere_own_frame", "axes exchanged", "return x * s + y * t + z * n", "return z * s + x * t + y * n"),
    ("a3.cos_hemisphere_sphere", "not of unit length", "return normalize(w)", "return w"),
    ("a3.cos_hemisphere_sphere", "whole sphere", "w = N + on_sphere(u)", "w = on_sphere(u)"),
    ("a3.cos_hemisphere_disk", "square for disk", "    x, y = disk(u)\n", "    x, y = 2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0\n"),
    ("a3.cos_hemisphere_by_hand", "one random number for two", "phi = TWO_PI * u[1]", "phi = TWO_PI * u[0]"),
    ("a3.cos_hemisphere_mirrored", "another power of the cosine", "math.sqrt(u[0])", "u[0] ** (1.0 / 3.0)", "math.sqrt(1.0 - u[0])", "math.sqrt(1.0 - u[0] ** (2.0 / 3.0))"),
    # --- a3: shades with wrong samplers in them ---
    ("a3.uniform_turned", "half a turn", "TWO_PI * u[0]", "PI * u[0]"),
    ("a3.uniform_angles", "angle for height", "math.acos(1.0 - u[0])", "0.5 * PI * u[0]"),
    ("a3.uniform_slide", "cosine for uniform", "math.sqrt(1.0 - u[0] * u[0])", "math.sqrt(1.0 - u[0])", "phi), u[0])", "phi), math.sqrt(u[0]))"),
    ("a3.uniform_sphere", "whole sphere", "    if dot(w, N) < 0.0:\n        w = -w\n", ""),
    ("a3.cosine_turned", "uniform for cosine", "r, phi = math.sqrt(u[1])", "r, phi = math.sqrt(1.0 - u[1] * u[1])", "math.sqrt(1.0 - u[1])", "u[1]"),
    ("a3.cosine_slide", "no square root", "r, phi = math.sqrt(u[0])", "r, phi = u[0]", "math.sqrt(1.0 - u[0])", "math.sqrt(1.0 - u[0] * u[0])"),
    ("a3.cosine_mirrored", "below the horizon|black", "cos_theta)\n", "-cos_theta)\n"),
    ("a3.cosine_angles", "not turned to the axis", "from_frame(N, ", "Vec3("),
    # --- a5: lobe and density ---
    ("a5.lobe_slide", "exponent off by one", "1.0 / (n + 1.0)", "1.0 / n"),
    ("a5.lobe_slide", "power for root", "1.0 / (n + 1.0)", "n + 1.0"),
    ("a5.lobe_turned", "exponent off by one", "1.0 / (1.0 + n)", "1.0 / (2.0 + n)"),
    ("a5.lobe_turned", "not of unit length", "math.sqrt(max(0.0, 1.0 - z * z))", "1.0 - z"),
    ("a5.lobe_mirrored", "exponent missing", "u[0] ** (1 / (n + 1))", "u[0]"),
    ("a5.lobe_f_over_p", "sine for cosine", "math.acos((1.0 - u[0])", "math.asin((1.0 - u[0])"),
    ("a5.lobe_logarithms", "exponent off by one", "(n + 1.0)", "n"),
    ("a5.lobe_own_frame", "half a turn", "TWO_PI * u[1]", "PI * u[1]"),
    ("a5.lobe_numpy", "not turned to the axis", "s, t = frame(R)", "s, t, R = Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(0, 0, 1)"),
    ("a5.pdf_slide", "lobe behind R", "max(0.0, dot(R, w)) ** n", "dot(R, w) ** n"),
    ("a5.pdf_slide", "normalisation missing", "(n + 1.0) / (2.0 * PI) * ", ""),
    ("a5.pdf_mirrored", "factor", "/ (2 * math.pi)", "/ math.pi"),
    ("a5.pdf_turned", "exponent off by one", "(n + 1.0) / TWO_PI", "(n + 2.0) / TWO_PI"),
    ("a5.pdf_turned", "lobe behind R", "c = dot(R, w)", "c = abs(dot(R, w))"),
    ("a5.pdf_f_over_p", "exponent off by one", "norm = (n + 1)", "norm = n"),
    ("a5.pdf_helpers", "factor", "(n + m) / TWO_PI", "(n + m)"),
    ("a5.pdf_numpy", "normalisation missing|factor", "(n + 1) / (2 * np.pi)", "1.0 / (2 * np.pi)"),
    ("a5.pdf_own_frame", "exponent missing", "c**n * (n + 1)", "(n + 1)"),
    ("a5.shade_slide", "exponent off by one", "1.0 / (n + 1.0)", "1.0 / n"),
    # --- a6 ---
    ("a6.aperture_slide", "no square root", "a * math.sqrt(u[0])", "a * u[0]"),
    ("a6.aperture_turned", "no square root", "math.sqrt(u[1])", "u[1]"),
    ("a6.aperture_turned", "radius missing", "a * r * math.sin(phi), a * r * math.cos(phi)", "r * math.sin(phi), r * math.cos(phi)"),
    ("a6.aperture_by_hand", "half a turn", "u[1] * 2 * math.pi", "u[1] * math.pi"),
    ("a6.aperture_squares", "square for disk", "return a * r * math.cos(phi), a * r * math.sin(phi)", "return a * x, a * y"),
    ("a6.aperture_mirrored", "on the rim", "a * math.sqrt(1.0 - u[0])", "a"),
    ("a6.aperture_helpers", "radius power", "x * a, y * a", "x * a * a, y * a * a"),
    ("a6.aperture_degrees", "factor", "math.sqrt(u[0]) * a", "math.sqrt(u[0]) * a / 2"),
    ("a6.lens_slide", "focus sphere", "toward * f", "normalize(toward) * f"),
    ("a6.lens_slide", "z is not 1", "(focus - Vec3(px, py, 0.0)) / f", "focus - Vec3(px, py, 0.0)"),
    ("a6.lens_turned", "lens point added", "f * toward - Vec3", "f * toward + Vec3"),
    ("a6.lens_turned", "focus sphere", "f * toward", "f * normalize(toward)"),
    ("a6.lens_by_hand", "not divided by f", "px / f", "px", "py / f", "py"),
    ("a6.lens_by_hand", "lens point ignored", " - px / f", "", " - py / f", ""),
    ("a6.lens_helpers", "axes exchanged", "(q.x - px) / q.z, (q.y - py)", "(q.x - py) / q.z, (q.y - px)"),
    ("a6.lens_mirrored", "backwards", "return -to_lens / f", "return to_lens"),
    ("a6.lens_early_ends", "z is not 1", " * (length(toward * f - Vec3(px, py, 0.0)) / f)", ""),
    ("a6.time_slide", "opening missing", "open + (close", "(close"),
    ("a6.time_turned", "reversed", "(1.0 - u) * open + u * close", "u * open + (1.0 - u) * close"),
    ("a6.time_by_hand", "shutter not scaled", "t += u * length", "t += u"),
    ("a6.time_quarters", "not random", "(2.0 * u - 1.0) * half", "0.0"),
    ("a6.time_degrees", "interval for end", "dt = close - open", "dt = close"),
    ("a6.motion_slide", "not clamped", "    s = min(1.0, max(0.0, s))\n", ""),
    ("a6.motion_slide", "velocity for position", "p0 + (p1 - p0) * s", "p0 + p1 * s"),
    ("a6.motion_turned", "reversed", "p0 * (t1 - t) + p1 * (t - t0)", "p1 * (t1 - t) + p0 * (t - t0)"),
    ("a6.motion_by_hand", "not clamped", "    elif s > 1:\n        s = 1.0\n", ""),
    ("a6.motion_by_hand", "beginning missing", "(t - t0) / (t1 - t0)", "t / (t1 - t0)"),
    ("a6.motion_squares", "time not scaled", "(t - t0) / (t1 - t0)", "t - t0"),
    ("a6.motion_helpers", "jumps", "between(p0, p1, clamped((t - t0) / (t1 - t0)))", "p0 if t < t1 else p1"),
    ("a6.motion_quarters", "time not scaled", "(p1 - p0) / (t1 - t0)", "p1 - p0"),
    # --- a7: weights ---
    ("a7.balance_slide", "weights exchanged", "p / (p + q)", "q / (p + q)"),
    ("a7.balance_slide", "sum missing", "p / (p + q)", "p / q"),
    ("a7.balance_sum", "other heuristic", "return p / total", "return p * p / (p * p + q * q)"),
    ("a7.balance_ratio", "weights exchanged", "q / p", "p / q"),
    ("a7.balance_index", "weights of one half", "return weights[0] / (weights[0] + weights[1])", "return 0.5"),
    ("a7.balance_numpy", "squares", "both[0] / np.sum(both)", "both[0] ** 2 / np.sum(both)"),
    ("a7.power_slide", "other heuristic", "r * r", "r"),
    ("a7.power_sum", "overflow", "p / largest, q / largest", "p, q"),
    ("a7.power_ratio", "weights exchanged", "q / p", "p / q"),
    ("a7.power_index", "squares", "return a * a / (a * a + b * b)", "return a * a"),
    ("a7.power_numpy", "other heuristic", "both[0] ** 2 / np.sum(both * both)", "both[0] / np.sum(both)"),
    ("a7.power_early_ends", "weights exchanged", "return b * b", "return c * c"),
)  # fmt: skip


def corpus() -> list[Planted]:
    return [
        Planted(RIGHT[style], tuple(causes.split("|")), tuple(zip(rest[::2], rest[1::2], strict=True)))
        for style, causes, *rest in ROWS
    ]


@cache
def table(task: str) -> Table:
    return Table.read(path_of(assignment.load(task.partition(".")[0]).folder, task))


def diagnosed(right: Right, function: Any, n: int = FOR_MOMENTS) -> list[Diagnosis]:
    """What is said of a function, all of it in plain Python."""
    with np.errstate(all="ignore"), redirect_stdout(StringIO()):  # some print on the way
        source = Interpreted({right.task: function}, {right.task: right.asked})
        return diagnose(table(right.task), source, right.task, n=n)


def main(out: Path) -> None:
    start, rows, first, among = time.time(), [], Counter(), Counter()
    for planted in corpus():
        named = [d.cause for d in diagnosed(planted.right, planted.function())]
        right = [cause in planted.causes for cause in named]
        first[planted.right.task] += right[:1] == [True]
        among[planted.right.task] += any(right)
        if right[:1] != [True]:
            rows.append(
                f"| {planted.right.task} | `{planted.name}` | {planted.causes[0]} | {', '.join(named) or 'nothing'} |"
            )
            print(rows[-1], flush=True)
    accused = [style for style, right in RIGHT.items() if diagnosed(right, right.function())]
    total, count = Counter(p.right.task for p in corpus()), len(corpus())
    lines = [
        "# Naming the mistake", "",
        "`cd tests && PYTHONPATH=.. python planted.py` plants mistakes in right answers that are written in many manners",
        "(tests/planted.py), compares them in plain Python with the tables of variants, and writes this page.", "",
        f"- {count} planted mistakes: the right cause is named first in {first.total()} "
        f"({100 * first.total() / count:.1f} %), among three in {among.total()} ({100 * among.total() / count:.1f} %).",
        f"- {len(RIGHT)} right answers: {len(accused)} accused.", "",
        "| task | planted | named first | among three |", "|---|---|---|---|",
        *(f"| {t} | {n} | {first[t]} | {among[t]} |" for t, n in sorted(total.items())), "",
        "Where the right cause is not named first:", "", "| task | planted | cause | named |", "|---|---|---|---|", *rows, "",
    ]  # fmt: skip
    out.write_text("\n".join(lines))
    print("\n".join(lines[:9]), f"{time.time() - start:.0f} s; accused: {accused}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parent / "docs" / "diagnosis.md")
