"""Stub: what students get instead of a solution, and the check that nothing of a solution is left in it.

A solution is a function of the package whose decorator carries the comment `# exercise ID`. Students get its name, its
arguments and its docstring, which is the slide's formula.
"""

from __future__ import annotations

import ast
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from pathlib import Path

import raylab
from raylab.grading.assignment import Assignment
from raylab.submission.task import Task

PACKAGE = Path(raylab.__file__).parent
MARK = re.compile(r"# exercise ([\w.]+)")
NOTHING = {"result = black", "return result", "return black", "pass"}  # lines that give nothing away


@dataclass(frozen=True)
class Solution:
    """A marked function: of which task, where, and its source."""

    task: str
    module: str
    name: str
    text: str

    @property
    def node(self) -> ast.FunctionDef:
        found = ast.parse(self.text).body[0]
        assert isinstance(found, ast.FunctionDef)
        return found

    @property
    def doc(self) -> str:
        return ast.get_docstring(self.node) or ""


def solutions() -> dict[str, Solution]:
    """All marked functions of the package, by task."""
    found = {}
    for path in sorted(PACKAGE.glob("*.py")):
        source = path.read_text("utf-8")
        if not MARK.search(source):
            continue
        lines = source.splitlines()
        for node in functions(ast.parse(source)):
            top = min([node.lineno, *(d.lineno for d in node.decorator_list)])
            if node.decorator_list and (mark := MARK.search(lines[top - 1])):
                text = "\n".join(lines[node.lineno - 1 : node.end_lineno])
                found[mark[1]] = Solution(mark[1], path.stem, node.name, text)
    return found


def functions(tree: ast.AST) -> Iterator[ast.FunctionDef]:
    return (node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef))


# --- what students get ---


def student_file(assignment: Assignment) -> str:
    """The file that students complete."""
    known = solutions()
    used = sorted(set().union(*(words(known[task.id], task) for task in assignment.tasks)))
    parts = [
        f'"""Assignment {assignment.id}: {assignment.title}. Slide "{assignment.slide}".\n\n'
        "Write each function below as on its slide; handout.md says what is asked and how it is graded. Helper\n"
        f'functions are welcome. Try it with `raylab check {assignment.id}`, or `pytest`.\n"""\n',
        f"from raylab.lecture import {', '.join(used)}\n" if used else "import math\n",
    ]
    stubs = (function_stub(task, assignment.docs[task.id] or known[task.id].doc) for task in assignment.tasks)
    return "\n".join(parts) + "".join(f"\n\n{stub}" for stub in stubs)


def words(solution: Solution, task: Task) -> set[str]:
    """What the solution needs of the lecture's words, as hints for the imports."""
    from raylab import lecture

    names = {node.id for node in ast.walk(solution.node) if isinstance(node, ast.Name)}
    return (names | ({"Vec3"} if "vector" in task.gives else set())) & set(lecture.__all__) - set(task.withheld)


def function_stub(task: Task, doc: str) -> str:
    """One function without its body."""
    doc = doc.replace("\n", "\n    ").replace("    \n", "\n")
    end = "\n    " if "\n" in doc else ""
    return (
        f"def {task.function}({', '.join(task.arguments)}):\n"
        f'    """{doc}{end}"""\n'
        f"    # Your code here (task {task.id}).\n"
        f'    raise NotImplementedError("{task.id} is not written yet")\n'
    )


# --- what must not get out ---


def squeezed(text: str) -> str:
    """Without spaces, brackets and comments: what is left of a statement however it is broken into lines."""
    return re.sub(r"[\s()]+", "", re.sub(r"#[^\n]*", "", text))


def telling(node: ast.FunctionDef) -> set[str]:
    """The statements of a function that say something, in one way of writing."""
    lines = {ast.unparse(n) for n in ast.walk(node) if isinstance(n, ast.Assign | ast.AugAssign | ast.Return | ast.If)}
    lines |= {f"if {ast.unparse(n.test)}:" for n in ast.walk(node) if isinstance(n, ast.If)}
    return {line for line in lines if line not in NOTHING and not line.startswith('"""')}


def leaks(text: str, solved: Iterable[Solution]) -> list[str]:
    """The statements of solutions that a Python source holds, whatever its spaces, brackets and comments."""
    secret = set().union(*(telling(s.node) for s in solved))
    whole = squeezed(text)
    if not any(squeezed(line) in whole for line in secret):
        return []
    try:
        tree = ast.parse(text)
    except SyntaxError:  # a page, not a program: line by line
        lines = {squeezed(line) for line in text.splitlines()}
        return sorted(s for s in secret if squeezed(s.splitlines()[0]) in lines)
    found = {line for node in functions(tree) for line in telling(node)}
    return sorted(found & secret)
