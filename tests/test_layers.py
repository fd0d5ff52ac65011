"""Imports go one way: in reading order, a module imports only from those above it."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest

PACKAGE = Path(__file__).parents[1] / "raylab"

# The reading path, top to bottom; then what stands beside it.
ORDER = [
    "_version", "errors", "atomic", "description", "jit", "vec3", "view", "record", "pose", "rng", "lanes", "sobol",
    "samplers", "sampling", "solid_angle", "mis", "fresnel", "brdf", "microfacet", "smooth", "rough", "kinds", "point",
    "light_shapes", "lights", "light_choice",
    "environment", "materials", "quadrics", "callbacks", "motion", "embree", "packet", "surface", "shadow",
    "shade", "beyond", "glossy", "direct", "basic", "lecture", "lens", "camera", "keyframes", "triangles",
    "defects", "geometry", "order", "emitters", "clockwork", "palette", "sky", "sensor", "scene", "strategies",
    "pixels", "image", "plan", "schedule", "stopping", "checkpoint", "run", "pixel_sample", "progress", "render",
    "probe", "plain", "ladders", "closed_forms", "io", "__init__", "slides", "explain", "stats",
    "study", "figures", "demo", "trials", "submission", "estimator_check", "estimator_watch", "metamorphic", "testing",
    "pytest_plugin", "grading", "stress", "options", "commands_student",
    "commands_render", "commands_staff", "cli",
]  # fmt: skip
NUMBA_INTERNALS = {"jit", "vec3", "view", "record", "rng", "embree", "packet", "callbacks"}
NUMBA_INTERNALS |= {"submission/compile", "submission/wall"}
NUMBA_INTERNALS |= {"stress/semantics"}  # shows what numba does where it is used as usual
SYSTEM_CALLS = {"grading/kernel", "grading/landlock", "grading/seccomp"}  # they need ctypes


def modules() -> dict[str, Path]:
    return {path.relative_to(PACKAGE).as_posix()[:-3]: path for path in PACKAGE.rglob("*.py")}


def layer(name: str) -> int:
    return ORDER.index(name.split("/")[0])


def imported(path: Path) -> set[str]:
    """The raylab modules that a file imports, at any depth of its code."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "raylab":
            parts = node.module.split(".")[1:]
            found |= {"/".join(parts)} if parts else {alias.name for alias in node.names}
        elif isinstance(node, ast.Import):
            found |= {"/".join(a.name.split(".")[1:]) for a in node.names if a.name.startswith("raylab.")}
    return found - {""}


def test_every_module_has_its_place():
    assert {name.split("/")[0] for name in modules()} == set(ORDER)


@pytest.mark.parametrize("name", sorted(modules()))
def test_imports_go_one_way(name):
    own = layer(name)
    if name == "__init__":
        own = layer("pytest_plugin")  # the front door may open every room
    for other in imported(modules()[name]):
        known = other if other.split("/")[0] in ORDER else "__init__"  # `from raylab import load`
        assert layer(known) <= own, f"{name} imports {other}, which stands below it"


def test_statistics_know_of_no_rendering():
    stats = [path for name, path in modules().items() if name.startswith("stats/")]
    assert {other.split("/")[0] for path in stats for other in imported(path)} == {"stats"}


@pytest.mark.parametrize("name", sorted(modules()))
def test_numba_internals_stay_in_their_files(name):
    if name in NUMBA_INTERNALS | SYSTEM_CALLS:
        return
    tree = ast.parse(modules()[name].read_text())
    used = {alias.name for node in ast.walk(tree) if isinstance(node, ast.Import) for alias in node.names}
    used |= {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module}
    assert not {u for u in used if u.split(".")[0] in ("numba", "llvmlite", "ctypes", "embreex")}


@pytest.mark.parametrize("name", sorted(modules()))
def test_no_fastmath_and_no_plain_cache(name):
    source = modules()[name].read_text()
    assert "fastmath=True" not in source
    assert "cache=True" not in source or name in ("jit", "callbacks")
