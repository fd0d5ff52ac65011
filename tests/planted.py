"""Planted: mistakes in what students write, each with the causes that would be right to name.

The right answers, in many manners, are those of tests/submissions; a row is an edit of one of them (`old` must occur in
the function or in its helpers). `python planted.py` (PYTHONPATH=..:.) diagnoses all of them in plain Python and writes
docs/diagnosis.md.
"""

from __future__ import annotations

import re
import sys
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np

from raylab.grading import assignment, diagnosis
from raylab.grading.diagnosis import Diagnosis
from raylab.grading.source import Interpreted
from raylab.grading.table import Table, path_of

HERE = Path(__file__).parent
FOR_MEANS = 1 << 9  # samples of each scene, in plain Python


@dataclass(frozen=True)
class Planted:
    """A mistake: in which manner of writing, what is right to say of it, and the edits."""

    task: str
    style: str
    causes: tuple[str, ...]
    edits: tuple[tuple[str, str], ...]

    @property
    def name(self) -> str:
        return f"{self.style}: {self.edits[0][0]} -> {self.edits[0][1]}"


STYLES = {
    "a1.diffuse": ("area_diffuse.py", ("slide", "with_helpers", "early_ends", "by_hand", "by_index", "with_while", "other_numbers")),
    "a2.area": ("others.py", ("area_slide", "area_keywords", "area_sum")),
    "a3.uniform": ("others.py", ("uniform_slide", "uniform_own", "uniform_rejected")),
    "a3.cosine": ("others.py", ("cosine_slide", "cosine_sphere")),
    "a4.brdf": ("others.py", ("brdf_slide",)),
    "a4.brightness": ("others.py", ("brightness_slide",)),
    "a5.shade": ("others.py", ("phong_slide", "phong_own")),
    "a7.shade": ("others.py", ("mis_slide", "mis_by_hand")),
}  # fmt: skip
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
)  # fmt: skip
TASK_OF = {style: (task, file) for task, (file, styles) in STYLES.items() for style in styles}


def corpus() -> list[Planted]:
    return [
        Planted(TASK_OF[style][0], style, tuple(causes.split("|")), tuple(zip(rest[::2], rest[1::2], strict=True)))
        for style, causes, *rest in ROWS
    ]


@cache
def text_of(file: str) -> str:
    return re.sub(r"(?m)^(import matplotlib|@).*\n", "", (HERE / "submissions" / file).read_text())


def parts(text: str, style: str) -> Iterator[tuple[int, int]]:
    """Where the function and its helpers stand: from its own `def` to the next comment or rule at the margin."""
    start = text.index(f"def {style}(")
    end = re.compile(r"^#|^def (?!one|geometry|clamped|visible|gather|sample_light)", re.M).search(text, start + 4)
    yield start, end.start() if end else len(text)


def function(task: str, style: str, edits: tuple[tuple[str, str], ...] = ()) -> Any:
    """The function, with its mistake; LookupError when an edit does not fit."""
    text = text_of(TASK_OF[style][1])
    for old, new in edits:
        (start, end), *_ = parts(text, style)
        if old not in text[start:end]:
            raise LookupError(f"{style}: {old!r} does not occur")
        text = text[:start] + text[start:end].replace(old, new) + text[end:]
    space: dict[str, Any] = {"__name__": "submission"}
    exec(compile(text, f"<{task}>", "exec"), space)
    return space[style]


@cache
def table(task: str) -> Table:
    return Table.read(path_of(assignment.load(task.partition(".")[0]).folder, task))


def diagnosed(task: str, found: Any, n: int = FOR_MEANS) -> list[Diagnosis]:
    """What is said of a function, all of it in plain Python."""
    before, diagnosis.FOR_MEANS = diagnosis.FOR_MEANS, n
    try:
        with np.errstate(all="ignore"):
            return diagnosis.diagnose(table(task), Interpreted({task: found}), task)
    finally:
        diagnosis.FOR_MEANS = before


def main(out: Path) -> None:
    start, rows, first, among = time.time(), [], Counter(), Counter()
    for planted in corpus():
        named = [d.cause for d in diagnosed(planted.task, function(planted.task, planted.style, planted.edits))]
        right = [cause in planted.causes for cause in named]
        first[planted.task] += bool(right[:1] == [True])
        among[planted.task] += any(right)
        if right[:1] != [True]:
            rows.append(
                f"| {planted.task} | `{planted.name}` | {planted.causes[0]} | {', '.join(named) or 'nothing'} |".replace(
                    "\n", " "
                )
            )
            print(rows[-1], flush=True)
    accused = [s for task, (_, styles) in STYLES.items() for s in styles if diagnosed(task, function(task, s))]
    total, count = Counter(p.task for p in corpus()), len(corpus())
    lines = [
        "# Naming the mistake", "",
        "`cd tests && PYTHONPATH=.. python planted.py` plants mistakes in right answers that are written in many manners",
        "(tests/planted.py), compares them in plain Python with the tables of variants, and writes this page.", "",
        f"- {count} planted mistakes: the right cause is named first in {sum(first.values())} "
        f"({100 * sum(first.values()) / count:.1f} %), among three in {sum(among.values())} ({100 * sum(among.values()) / count:.1f} %).",
        f"- {sum(len(s) for _, s in STYLES.values())} right answers: {len(accused)} accused.", "",
        "| task | planted | named first | among three |", "|---|---|---|---|",
        *(f"| {t} | {n} | {first[t]} | {among[t]} |" for t, n in sorted(total.items())), "",
        "Where the right cause is not named first:", "", "| task | planted | cause | named |", "|---|---|---|---|", *rows, "",
    ]  # fmt: skip
    out.write_text("\n".join(lines))
    print("\n".join(lines[:9]), f"{time.time() - start:.0f} s; accused: {accused}")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else HERE.parent / "docs" / "diagnosis.md")
