"""Messages: what Python and the compiler say, in the words of somebody who knows the lecture.

Two tables of rows: a pattern of the raw text, a sentence, an advice; {name} is what the pattern caught, put into
words. What no row knows keeps its line, gets a sentence of its own, and the raw text stays under `detail`.
"""

from __future__ import annotations

import re
from typing import Any

from raylab.submission import allowed
from raylab.submission.finding import Problem
from raylab.submission.source import FILE, Source

Row = tuple[str, str, str]

PYTHON: tuple[Row, ...] = (
    (
        r"ZeroDivisionError: .*",
        "This line divides by zero.",
        "Test before dividing; a squared distance of 0 means that the sample on the light is x itself.",
    ),
)

COMPILER: tuple[Row, ...] = ()


def explain_python(error: Exception, source: Source, line: int) -> Problem:
    """An exception of the function in plain Python."""
    raw = f"{type(error).__name__}: {error}"
    found = _look_up(PYTHON, raw)
    sentence, advice = found or (f"This line raises {raw}.", "")
    return Problem(sentence, advice, line, raw)


def explain_compiler(error: BaseException, source: Source) -> Problem:
    """What numba says when it cannot compile, though plain Python could run."""
    raw = str(error)
    found = _look_up(COMPILER, raw)
    sentence, advice = found or ("Your Python is fine, but the compiler cannot handle this line.", "")
    return Problem(sentence, advice, line_of(error, source), raw)


def line_of(error: BaseException, source: Source) -> int:
    """The last line of the student's file that the compiler names, 0 if none."""
    named = re.findall(rf'File "{re.escape(FILE)}", line (\d+)', str(error))
    if named:
        return int(named[-1])
    loc: Any = getattr(error, "loc", None)
    return loc.line if loc is not None and loc.filename == FILE else 0


def _look_up(table: tuple[Row, ...], raw: str) -> tuple[str, str] | None:
    for pattern, sentence, advice in table:
        if found := re.search(pattern, raw):
            caught = {name: in_words(text or "") for name, text in found.groupdict().items()}
            return sentence.format(**caught), advice.format(**caught)
    return None


_WORDS = (
    (r"^(u?int\d*|float\d*|Literal\[int\].*)$", "a number"),
    (r"^Vec3$", "a Vec3"),
    (r"^(bool|boolean)$", "True or False"),
    (r"^none$", "None"),
    (r"^(Uni)?Tuple\(.*", "a tuple"),
    (r"^(readonly )?array\(.*", "an array"),
    (r"^(reflected )?list\(.*", "a list"),
    (r"^(unicode_type|Literal\[str\].*)$", "text"),
    (r"^Optional|^OptionalType", "a value or None"),
)


def in_words(numba_type: str) -> str:
    """A type of numba's as students call it; other text as it is."""
    return next((word for pattern, word in _WORDS if re.match(pattern, numba_type)), numba_type)


__all__ = ["COMPILER", "PYTHON", "allowed", "explain_compiler", "explain_python", "in_words", "line_of"]
