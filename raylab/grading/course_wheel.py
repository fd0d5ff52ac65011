"""Course wheel: the raylab that students install, without the solutions of some assignments.

The marked functions become stubs, and so does every other function that holds a statement of one of them: the same
lines stand in other estimators. What only the staff needs stays out. Built by setuptools, without the network.
"""

from __future__ import annotations

import ast
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from pathlib import Path

import raylab
from raylab.errors import UserError
from raylab.grading.assignment import Assignment
from raylab.grading.begin import KEPT
from raylab.grading.stub import Solution, functions, leaks, solutions, squeezed, student_file, telling

SOURCE = Path(raylab.__file__).parents[1]
STAFF = (
    "grading/variant.py", "grading/variants.py", "grading/lamp_variants.py", "grading/sky_variants.py",
    "grading/map_variants.py", "grading/stub.py", "grading/course_wheel.py", "grading/course.py",
    "grading/dashboard.py", "grading/one.py", "commands_staff.py",
)  # fmt: skip
BUILD = """
[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"
"""


def without(source: str, solved: Sequence[Solution], module: str, why: str) -> tuple[str, list[str]]:
    """A module's text with stubs in the place of all that gives one of the solutions away, and their names."""
    secret, whole = set().union(*(telling(s.node) for s in solved)), squeezed(source)
    names = {s.name for s in solved if s.module == module}
    if not names and not any(squeezed(line) in whole for line in secret):
        return source, []
    lines, changed = source.splitlines(keepends=True), []
    for node in sorted(functions(ast.parse(source)), key=lambda n: -n.lineno):
        if not (node.name in names and node.col_offset == 0) and not telling(node) & secret:
            continue
        first = node.body[0]
        documented = isinstance(first, ast.Expr) and isinstance(first.value, ast.Constant) and len(node.body) > 1
        start = node.body[1].lineno if documented else first.lineno
        below = " " * (node.col_offset + 4)
        text = (
            f"{below}for _ in range(1):  # always; compiled, there must be a way to the end\n"
            f'{below}    raise NotImplementedError("{why}")\n{below}return {_nothing(node)}\n'
        )
        lines[start - 1 : node.end_lineno] = [text]
        changed.append(node.name)
    return "".join(lines), changed


def _nothing(node: ast.FunctionDef) -> str:
    """A value of the type that the function returns: the zeroth power of its last result would do as well."""
    found = [n.value for n in ast.walk(node) if isinstance(n, ast.Return) and n.value is not None]
    text = ast.unparse(found[-1]) if found else ""
    if isinstance(found[-1], ast.Tuple):
        return "(" + ", ".join("0.0" for _ in found[-1].elts) + ")"
    if node.name.startswith("pdf_") or node.name in ("balance", "power", "shutter_time"):
        return "0.0"
    return (
        "N" if node.name.startswith("sample_") and "N" in text else "R" if node.name.startswith("sample_") else "black"
    )


def strip(package: Path, assignments: Sequence[Assignment]) -> dict[str, list[str]]:
    """Take the solutions out of a copy of the package; which functions became stubs, by module."""
    known = solutions()
    solved = [known[task.id] for a in assignments for task in a.tasks]
    needed = {name: a.id for a in assignments for name in a.needs}
    for own in solved:
        name = f"{own.module}:{own.name}"
        if name in needed:
            raise UserError(
                f"{needed[name]} needs {name}, which {own.task} asks for: build one wheel for each of the two"
            )
    for name in STAFF:
        (package / name).unlink()
    ids = ", ".join(a.id for a in assignments)
    changed = {}
    for path in sorted(package.rglob("*.py")):
        text, names = without(
            path.read_text("utf-8"),
            solved,
            path.stem if path.parent == package else "",
            f"this is for you to write: {ids}",
        )
        if names:
            path.write_text(text, "utf-8")
            changed[path.relative_to(package).as_posix()] = names
    left = leaking(package.rglob("*"), solved)
    if left:
        raise UserError(f"a solution would be in the wheel: {left[0]}")
    return changed


def leaking(paths: Iterable[Path], solved: Sequence[Solution]) -> list[str]:
    """Files with statements of solutions in them."""
    found = []
    for path in sorted(paths):
        if path.is_file() and path.suffix in (".py", ".md", ".xml", ".toml", ".txt"):
            found += [f"{path.name}: {line}" for line in leaks(path.read_text("utf-8"), solved)]
    return found


def stripped(assignments: Sequence[Assignment], folder: Path) -> dict[str, list[str]]:
    """The package `folder`/raylab with stubs in the place of the solutions; which functions became stubs."""
    package = folder / "raylab"
    shutil.copytree(SOURCE / "raylab", package, ignore=shutil.ignore_patterns("__pycache__", "assignments"))
    changed = strip(package, assignments)
    cli = package / "cli.py"
    text = cli.read_text("utf-8").replace("commands_staff, ", "").replace("*commands_staff.COMMANDS, ", "")
    cli.write_text(text, "utf-8")
    return changed


def stage(assignments: Sequence[Assignment], folder: Path) -> dict[str, list[str]]:
    """Everything that is built, in a folder."""
    package, changed = folder / "raylab", stripped(assignments, folder)
    for assignment in assignments:
        own = package / "assignments" / assignment.id
        (own / "variants").mkdir(parents=True)
        for path in assignment.folder.iterdir():
            if path.suffix in KEPT or path.name == "assignment.toml":
                shutil.copyfile(path, own / path.name)
        for path in sorted((assignment.folder / "variants").glob("*.npz")):
            shutil.copyfile(path, own / "variants" / path.name)
        (own / "stub.py").write_text(student_file(assignment), "utf-8")
    project = (SOURCE / "pyproject.toml").read_text("utf-8")
    project = project.replace('"**/*.html"', '"assignments/**/*", "**/*.html"')
    (folder / "pyproject.toml").write_text(project, "utf-8")
    shutil.copyfile(SOURCE / "LICENSE", folder / "LICENSE")
    ids = ", ".join(a.id for a in assignments)
    (folder / "README.md").write_text(f"raylab for a course: {ids} are for you to write. Begin with `raylab new`.\n")
    return changed


def build(assignments: Sequence[Assignment], out: Path) -> Path:
    """The wheel's path; UserError with the builder's words when it cannot be built."""
    if not (SOURCE / "pyproject.toml").is_file():
        raise UserError("a course wheel is built from raylab's source tree, and this is an installed package")
    with tempfile.TemporaryDirectory() as temporary:
        stage(assignments, Path(temporary))
        out.mkdir(parents=True, exist_ok=True)
        command = [sys.executable, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--no-index", "--quiet"]
        ran = subprocess.run(
            [*command, "--disable-pip-version-check", "-w", str(out), temporary], capture_output=True, text=True
        )
        if ran.returncode:
            raise UserError(f"the wheel could not be built (it needs setuptools 77 or later):\n{ran.stderr.strip()}")
    return max(out.glob("raylab-*.whl"), key=lambda path: path.stat().st_mtime)
