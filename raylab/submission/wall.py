"""Wall: the allow-list once more, of what numba is about to compile; here every name has become an object."""

from __future__ import annotations

import re
import types
import warnings
from collections.abc import Callable
from typing import Any

from numba.core import config, ir
from numba.core.compiler import run_frontend
from numba.core.errors import NumbaWarning
from numba.core.ssa import reconstruct_ssa

from raylab.submission import allowed
from raylab.submission.allowed import Unavailable
from raylab.submission.finding import Problem


def wall(function: Callable[..., Any], own: Callable[[Any], bool]) -> None:
    """Raise a Problem if `function`, as numba reads it, holds an object or an attribute that is not allowed."""
    held: dict[str, Any] = {}
    for block in run_frontend(function).blocks.values():
        for statement in block.body:
            value = getattr(statement, "value", None)
            if isinstance(statement, ir.EnterWith):
                raise Problem("`with` cannot be used in graded functions.", "", statement.loc.line)
            if isinstance(value, ir.Global | ir.FreeVar):
                held[statement.target.name] = value.value
                if not (own(value.value) or allowed.permitted(value.value)):
                    raise _refused(value)
            if isinstance(value, ir.Expr) and value.op == "getattr":
                owner = held.get(value.value.name)
                if isinstance(owner, types.ModuleType):
                    held[statement.target.name] = found = allowed.member(owner, value.attr)
                    if isinstance(found, Unavailable):
                        raise Problem(found.sentence, found.advice, statement.loc.line)
                elif value.attr not in allowed.ATTRIBUTES:
                    raise Problem(f"`.{value.attr}` is not known here.", "", statement.loc.line)


def _refused(named: Any) -> Problem:
    if isinstance(named.value, Unavailable):
        return Problem(named.value.sentence, named.value.advice, named.loc.line)
    if named.value is ir.UNDEFINED:
        return Problem(f"`{named.name}` is not defined.", "Check how it is written.", named.loc.line)
    return Problem(f"`{named.name}` cannot be used in graded functions.", "", named.loc.line)


def may_be_unset(function: Callable[..., Any]) -> list[tuple[int, str]]:
    """Lines and variables that have no value on some way through the function; compiled, they are 0 there."""
    before, config.ALWAYS_WARN_UNINIT_VAR = config.ALWAYS_WARN_UNINIT_VAR, 1
    try:
        with warnings.catch_warnings(record=True) as heard:
            warnings.simplefilter("always", NumbaWarning)
            reconstruct_ssa(run_frontend(function))
    finally:
        config.ALWAYS_WARN_UNINIT_VAR = before
    found = [re.search(r"uninitialized variable (\w+)(?s:.*), line (\d+)", str(one.message)) for one in heard]
    return sorted({(int(one[2]), one[1]) for one in found if one})
