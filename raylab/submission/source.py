"""Source: what a student's file says, without running it.

At the top level stand imports, functions, and names of constants; the constants are worked out here, from numbers,
tuples, vectors and arithmetic. Decorators and annotations are dropped: everything is compiled anyway.
"""

from __future__ import annotations

import ast
import copy
import linecache
import operator
import types
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

from raylab import lecture
from raylab.submission import allowed
from raylab.submission.allowed import Unavailable
from raylab.submission.finding import Problem
from raylab.submission.text import decode, parse
from raylab.vec3 import Vec3

FILE = "shade.py"  # as messages call it


def _power(a: float, b: float) -> float:
    return float(a) ** b if isinstance(b, float) or b < 0 or abs(b) > 64 else a**b


_OPERATIONS: dict[type, Callable[..., Any]] = {
    ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
    ast.FloorDiv: operator.floordiv, ast.Mod: operator.mod, ast.Pow: _power,
    ast.USub: operator.neg, ast.UAdd: operator.pos,
}  # fmt: skip


@dataclass
class Source:
    """A file that was read: its `lines`, the trees of its functions, its other names, and remarks (line, sentence)."""

    lines: list[str]
    functions: dict[str, ast.FunctionDef] = field(default_factory=dict)
    names: dict[str, Any] = field(default_factory=dict)
    remarks: list[tuple[int, str]] = field(default_factory=list)

    def line(self, number: int) -> str:
        return self.lines[number - 1] if 0 < number <= len(self.lines) else ""

    def namespace(self, extra: str = "", silent: bool = False) -> dict[str, Any]:
        """Run the definitions, and those of `extra`: a new namespace of plain functions; `silent` ones do not print."""
        # numpy looks for __import__ in the caller's builtins; the student's own text may not name it
        known = allowed.BUILT_INS | allowed.ERRORS | {"__import__": __import__}
        space = {"__builtins__": known, "__name__": "submission", **self.names}
        tree = ast.Module(body=list(self.functions.values()), type_ignores=[])
        exec(compile(_Silence().visit(copy.deepcopy(tree)) if silent else tree, FILE, "exec"), space)
        exec(compile(extra, "<raylab>", "exec"), space)
        return space


class _Silence(ast.NodeTransformer):
    """Takes away the lines that print: compiled functions run a million times."""

    def visit_Expr(self, node: ast.Expr) -> ast.stmt:
        call = node.value
        if isinstance(call, ast.Call) and isinstance(call.func, ast.Name) and call.func.id == "print":
            return ast.copy_location(ast.Pass(), node)
        return node


def read(data: bytes) -> Source:
    """A Source, or a Problem."""
    text = decode(data)
    source = Source(text.split("\n"))
    linecache.cache[FILE] = (len(text), None, [line + "\n" for line in source.lines], FILE)
    for number, statement in enumerate(parse(text).body):
        _take(source, statement, first=number == 0)
    return source


def _take(source: Source, node: ast.stmt, first: bool) -> None:
    """One statement of the top level."""
    if isinstance(node, ast.FunctionDef):
        _take_function(source, node)
    elif isinstance(node, ast.Import | ast.ImportFrom):
        _take_import(source, node)
    elif isinstance(node, ast.Assign) and all(isinstance(t, ast.Name) for t in node.targets):
        value = constant(source, node.value)
        source.names.update({t.id: value for t in node.targets if isinstance(t, ast.Name)})
    elif isinstance(node, ast.AnnAssign) and isinstance(node.target, ast.Name) and node.value:
        source.names[node.target.id] = constant(source, node.value)
    elif isinstance(node, ast.ClassDef):
        raise Problem("Classes cannot be used in graded code.", "Use functions, numbers, tuples and Vec3.", node.lineno)
    elif isinstance(node, ast.AsyncFunctionDef):
        raise Problem("This function is async.", "Write def.", node.lineno)
    elif not (isinstance(node, ast.Pass) or _is_main(node) or (_is_constant(node))):
        raise Problem(
            "This line would run as soon as the file is loaded; graded files only define.",
            "Keep imports, functions and constants at the left margin, and put the rest under "
            'if __name__ == "__main__":, where it is left out.',
            node.lineno,
        )


def _is_constant(node: ast.stmt) -> bool:
    return isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant)


def _is_main(node: ast.stmt) -> bool:
    return isinstance(node, ast.If) and "__name__" in {n.id for n in ast.walk(node.test) if isinstance(n, ast.Name)}


def _take_function(source: Source, node: ast.FunctionDef) -> None:
    if node.name in source.functions:
        before = source.functions[node.name].lineno
        source.remarks.append(
            (node.lineno, f"`{node.name}` is defined twice; the one on line {before} does not count.")
        )
    elif node.name in source.names:
        source.remarks.append((node.lineno, f"`{node.name}` was the name of something else above."))
        del source.names[node.name]
    for decorator in node.decorator_list:
        said = ast.unparse(decorator)
        if said not in ("njit", "jit", "numba.njit", "numba.jit", "nb.njit", "njit()"):
            source.remarks.append((decorator.lineno, f"@{said} has no effect: graded functions are compiled for you."))
    node.decorator_list, node.returns = [], None
    if node.args.vararg or node.args.kwarg:
        raise Problem(f"`{node.name}` takes any number of arguments.", "Name them one by one.", node.lineno)
    if node.args.kwonlyargs:
        raise Problem(f"`{node.name}` has a * among its arguments.", "Leave out the *.", node.lineno)
    for argument in (*node.args.posonlyargs, *node.args.args):
        argument.annotation = None
    node.args.defaults = [_value(constant(source, d), d) for d in node.args.defaults]
    source.functions[node.name] = node


def _value(value: Any, node: ast.expr) -> ast.expr:
    if not isinstance(value, int | float | None):
        raise Problem("A default must be a number.", "", node.lineno)
    return ast.copy_location(ast.Constant(value), node)


def _take_import(source: Source, node: ast.Import | ast.ImportFrom) -> None:
    """Names are looked up in `allowed`; nothing is imported."""
    for alias in node.names:
        bound = alias.asname or alias.name.split(".")[0]
        if isinstance(node, ast.Import):
            plain = "." not in alias.name or alias.asname
            value = allowed.whole_module(alias.name if plain else bound)
        elif alias.name == "*":
            _take_all(source, node)
            continue
        else:
            value = allowed.from_import("." * node.level + (node.module or ""), alias.name)
        source.functions.pop(bound, None)
        source.names[bound] = value


def _take_all(source: Source, node: ast.ImportFrom) -> None:
    name = node.module or ""
    of_raylab = name.startswith("raylab.") and name.removeprefix("raylab.") not in allowed.OWN_SOLUTIONS
    module = lecture if of_raylab else allowed.whole_module(name)
    if isinstance(module, Unavailable):
        source.remarks.append((node.lineno, module.sentence))
        return
    names = lecture.__all__ if module is lecture else [n for n in vars(module) if not n.startswith("_")]
    found = {name: allowed.member(module, name) for name in names}
    source.names.update({name: value for name, value in found.items() if not isinstance(value, Unavailable)})


def constant(source: Source, node: ast.expr) -> Any:
    """The value of a constant expression: numbers, text, tuples, Vec3, arithmetic, functions of math."""
    if isinstance(node, ast.Constant) and isinstance(node.value, int | float | str | None):
        return node.value
    if isinstance(node, ast.Tuple):
        return tuple(constant(source, e) for e in node.elts)
    if isinstance(node, ast.Name) and node.id in source.names:
        return source.names[node.id]
    if isinstance(node, ast.Attribute):
        owner = constant(source, node.value)
        if isinstance(owner, types.ModuleType):
            return allowed.member(owner, node.attr)
    if isinstance(node, ast.BinOp | ast.UnaryOp | ast.Call):
        try:
            return _computed(source, node)
        except (ArithmeticError, ValueError, TypeError) as error:
            raise Problem(f"This constant cannot be worked out: {error}.", "", node.lineno) from None
    raise Problem(
        "The value of a constant must be made of numbers, tuples, Vec3(...) and arithmetic.",
        "Work out anything else inside the function that needs it.",
        node.lineno,
    )


def _computed(source: Source, node: ast.BinOp | ast.UnaryOp | ast.Call) -> Any:
    if isinstance(node, ast.BinOp):
        operands = [constant(source, node.left), constant(source, node.right)]
    elif isinstance(node, ast.UnaryOp):
        operands = [constant(source, node.operand)]
    else:
        function = constant(source, node.func)
        operands = [constant(source, a) for a in node.args]
        if (function is Vec3 or getattr(function, "__module__", "") == "math") and not node.keywords:
            return function(*(_number(o) for o in operands))
        raise TypeError("only Vec3 and functions of math may be called here")
    if type(node.op) not in _OPERATIONS:
        raise TypeError("only + - * / // % and ** are known here")
    return _OPERATIONS[type(node.op)](*(o if isinstance(o, Vec3) else _number(o) for o in operands))


def _number(value: Any) -> int | float:
    if not isinstance(value, int | float) or (isinstance(value, int) and abs(value) > 2**63):
        raise TypeError(f"{str(value)[:40]} is not a number")
    return value
