"""Interpret: the function in plain Python on a few samples, watched line by line.

Python knows the line of each fault, which compiled code does not. A trace counts the lines of the student's file, so
that a loop without end is stopped and named, and remembers the last one.
"""

from __future__ import annotations

import io
import math
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, redirect_stdout
from types import FrameType
from typing import Any

import numpy as np

from raylab.plain import Plain
from raylab.submission.finding import Problem
from raylab.submission.messages import explain_python
from raylab.submission.shape import unfinished
from raylab.submission.source import FILE, Source
from raylab.submission.task import Task
from raylab.submission.words import in_words
from raylab.vec3 import Vec3

STEPS = 1_000_000  # of the interpreter in the student's file, in one sample: about a second


class EndlessError(BaseException):
    """A sample has taken more than STEPS steps."""


class Trace:
    """Watches the frames of the student's file: steps taken, the last line, and where a local went wrong."""

    def __init__(self, wrong: Callable[[Any], bool] | None = None) -> None:
        self.steps, self.last, self.wrong, self.first_wrong = 0, 0, wrong, (0, "")

    @contextmanager
    def watching(self) -> Iterator[Trace]:
        before = sys.gettrace()
        sys.settrace(self._call)
        try:
            yield self
        finally:
            sys.settrace(before)

    def _call(self, frame: FrameType, event: str, argument: Any) -> Any:
        if frame.f_code.co_filename != FILE:
            return None
        frame.f_trace_opcodes = True  # `while True: pass` has but one line event
        return self._line

    def _line(self, frame: FrameType, event: str, argument: Any) -> Any:
        self.steps += 1
        if self.steps > STEPS:
            raise EndlessError
        if event == "opcode":
            return self._line
        if self.wrong and not self.first_wrong[0]:
            for name, value in frame.f_locals.items():
                if self.wrong(value):
                    self.first_wrong = self.last, name
        if event == "line":
            self.last = frame.f_lineno
        return self._line


def run(source: Source, task: Task, call: Callable[[], Any], quiet: bool = True) -> tuple[Any, int]:
    """What `call` returns and the last line that ran; a Problem if it raises or does not end."""
    trace, screen = Trace(), io.StringIO() if quiet else sys.stdout
    try:
        with redirect_stdout(screen), np.errstate(divide="raise", invalid="raise"), trace.watching():
            return call(), trace.last
    except NotImplementedError:
        raise unfinished(task.function, trace.last) from None
    except EndlessError:
        raise Problem(
            f"The loop around this line does not end: one sample has taken {STEPS} steps.",
            "Check that the condition of the loop becomes false.",
            trace.last,
        ) from None
    except RecursionError:
        raise Problem("Functions call each other without end.", "Write a loop.", trace.last) from None
    except Exception as error:
        raise explain_python(error, source, trace.last) from None


def is_nan(value: Any) -> bool:
    if isinstance(value, Vec3):
        return any(is_nan(v) for v in value)
    return isinstance(value, float) and not math.isfinite(value)


def interpret_shade(
    source: Source, task: Task, shade: Callable[..., Any], plain: Plain, samples: int
) -> tuple[list[list[float]], list[Problem]]:
    """The values of the first samples, and what is odd about them; a Problem if there are none."""
    values: list[list[float]] = []
    odd: dict[str, Problem] = {}
    before = plain.state()
    for number in range(samples):
        value, last = run(source, task, lambda n=number: plain.call(shade, n), number > 0)  # type: ignore[misc]
        if plain.state() != before:
            raise Problem(f"`{task.function}` changes its arguments.", "Make new values instead.", last)
        values.append(colour(task.function, value, last))
        if not all(math.isfinite(v) for v in values[-1]):
            odd.setdefault("nan", _nan(task, lambda n=number: plain.call(shade, n), number, values[-1]))  # type: ignore[misc]
        elif min(values[-1]) < 0.0:
            odd.setdefault("negative", _negative(number, values[-1], last))
    again = run(source, task, lambda: plain.call(shade, 0))[0]
    if repr(colour(task.function, again, 0)) != repr(values[0]):
        raise Problem(
            f"`{task.function}` gives another result when it is called again with the same numbers.",
            "A sample must depend on the arguments only.",
        )
    return values, list(odd.values())


def colour(function: str, value: Any, line: int) -> list[float]:
    """The three numbers of a colour; a Problem if it is none."""
    if isinstance(value, Vec3):
        return [float(value.x), float(value.y), float(value.z)]
    if value is None:
        raise Problem(
            f"`{function}` ends without `return`, after this line.",
            "Each way through the function must end with: return result", line,
        )  # fmt: skip
    raise Problem(
        f"`{function}` returns {_what(value)}; a colour (Vec3) is expected.",
        "Return black, or Vec3(r, g, b)." if not isinstance(value, np.ndarray) else "Return Vec3(c[0], c[1], c[2]).",
        line,
    )


def _what(value: Any) -> str:
    if isinstance(value, int | float) and not isinstance(value, bool):
        return f"the number {value:g}"
    if isinstance(value, np.ndarray):
        return f"an array of shape {value.shape}"
    if isinstance(value, tuple | list):
        return f"a {type(value).__name__} of {len(value)}"
    return in_words(type(value).__name__)


def _nan(task: Task, call: Callable[[], Any], number: int, values: list[float]) -> Problem:
    """Say in which line the first value became infinite or not a number."""
    trace = Trace(is_nan)
    with redirect_stdout(io.StringIO()), trace.watching():
        call()
    line, name = trace.first_wrong
    where = f"`{name}` becomes infinite or not a number" if name else f"`{task.function}` returns {values}"
    return Problem(
        f"{where} (sample {number}).", "Look for a division by zero, or a square root of a negative number.",
        line or trace.last, f"{task.function} returned {values}", "warning",
    )  # fmt: skip


def _negative(number: int, values: list[float], line: int) -> Problem:
    return Problem(
        f"The result is negative: {tuple(round(v, 6) for v in values)} (sample {number}); light never is.",
        "A surface is lit from above only: write max(0.0, dot(...)) for each cosine.", line, kind="warning",
    )  # fmt: skip


# --- kind "map" ---


def interpret_map(
    source: Source, task: Task, function: Callable[..., Any], rows: np.ndarray
) -> tuple[np.ndarray, list[Problem]]:
    """The results for the rows of inputs, and what is odd about them."""
    results = np.empty((len(rows), task.columns[1]))
    odd: dict[str, Problem] = {}
    for number, row in enumerate(rows):
        arguments = tuple(unpack(task.takes, row))
        value, last = run(source, task, lambda a=arguments: function(*a), number > 0)  # type: ignore[misc]
        results[number] = flatten(task, value, last)
        if not np.isfinite(results[number]).all():
            odd.setdefault("nan", _nan(task, lambda a=arguments: function(*a), number, results[number].tolist()))  # type: ignore[misc]
    return results, list(odd.values())


def unpack(takes: tuple[str, ...], row: np.ndarray) -> Iterator[Any]:
    """The arguments that a row of numbers stands for."""
    first = 0
    for kind in takes:
        if kind == "vector":
            yield Vec3(*row[first : first + 3])
            first += 3
        elif kind == "pair":
            yield float(row[first]), float(row[first + 1])
            first += 2
        else:
            yield float(row[first])
            first += 1


def flatten(task: Task, value: Any, line: int) -> list[float]:
    """The numbers of a result; a Problem if it is not what the task `gives`."""
    parts = (value,) if len(task.gives) == 1 else value
    wanted = " and ".join({"number": "a number", "pair": "a pair", "vector": "a Vec3"}[g] for g in task.gives)
    if value is None:
        raise Problem(f"`{task.function}` ends without `return`.", f"It must return {wanted}.", line)
    if not isinstance(parts, tuple) or len(parts) != len(task.gives):
        raise Problem(f"`{task.function}` returns {_what(value)}; {wanted} is expected.", "", line)
    numbers: list[float] = []
    for kind, part in zip(task.gives, parts, strict=True):
        if kind == "vector" and isinstance(part, Vec3):
            numbers += part
        elif kind == "pair" and isinstance(part, tuple) and len(part) == 2:
            numbers += [float(p) for p in part]
        elif kind == "number" and isinstance(part, int | float | np.floating):
            numbers.append(float(part))
        else:
            raise Problem(f"`{task.function}` returns {_what(part)} where {wanted} is expected.", "", line)
    return numbers
