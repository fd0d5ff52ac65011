"""Messages: what Python and the compiler say, in the words of somebody who knows the lecture.

The compiler's complaints about types are first put as Python would put them, so that one table (`raylab.submission.
words`) serves both; the rest has a table of its own. What no row knows keeps its line, gets a sentence of its own, and
the raw text stays under `detail`.
"""

from __future__ import annotations

import ast
import re
from typing import Any

from raylab.submission import allowed
from raylab.submission.finding import Problem
from raylab.submission.source import FILE, Source
from raylab.submission.words import PYTHON, Row, in_words, parts_of

_OPERATORS = {
    "add": "+", "iadd": "+=", "sub": "-", "isub": "-=", "mul": "*", "imul": "*=", "truediv": "/", "itruediv": "/=",
    "floordiv": "//", "mod": "%", "pow": "**", "ipow": "**", "matmul": "@", "imatmul": "@",
}  # fmt: skip
_COMPARISONS = {"gt": ">", "lt": "<", "ge": ">=", "le": "<=", "eq": "==", "ne": "!="}
_LOOP = "Write a for loop that adds up: result += ..."

COMPILER: tuple[Row, ...] = (
    (
        r"Can't unify return type from the following types: (?P<types>.*)",
        "the function returns different things: {types}.",
        "Each way through it must return a Vec3: black, not 0 and not None.",
    ),
    (
        r"returns Optional",
        "some way through the function ends without `return`: an if has no else.",
        "Each way through it must end with: return result",
    ),
    (r"returns .* generator", "generators cannot be compiled.", _LOOP),
    (r"returns (?P<a>\S.*)$", "it returns {a} where something else is due.", "A colour is a Vec3."),
    (
        r"Cannot unify (?P<a>.*) and (?P<b>.*) for '(?P<name>\w+)[.\d]*'",
        "`{name}` is {a} in one place and {b} in another ({lines}).",
        "Keep one kind: begin with black, Vec3(...) or 0.0, or use two names.",
    ),
    (
        r"(Cannot infer the type of variable '(?P<name>\w+)[.\d]*'.*list\(undefined\)|"
        r"untyped list|imprecise type: list)",
        "the list is empty, so its kind is not known.",
        "Add up in a variable instead, or use np.zeros(n).",
    ),
    (r"Type of variable '(?P<name>[\w$.]+)' cannot be determined", "the kind of a value cannot be found.",
     "Write each step on a line of its own."),
    (
        r"Untyped global name '(?P<name>\w+)': .*<class 'type'>",
        "`{name}` is a class.", "Use numbers, tuples and Vec3 instead of classes.",
    ),
    (
        r"Untyped global name '(?P<name>\w+)'|Cannot determine Numba type of (?P<a><.*>)",
        "`{name}` cannot be used in compiled code.",
        "Call only functions of your file, raylab.lecture, math and numpy.",
    ),
    (r"NameError: name '(?P<name>\w+)' is not defined", "`{name}` is not defined.", "Check how it is written."),
    (r"recursion|Recursion", "functions call each other in a circle.", "Write a loop."),
    (r"default_rng|numpy\.random|Unknown attribute 'random'", "np.random cannot be used.",
     "Use the numbers that you are given: rng.number() and rng.square()."),
    (r"yield|GET_ITER_YIELD|generator", "generators cannot be compiled.", _LOOP),
    (r"Exception matching is limited|SETUP_EXCEPT|CHECK_EXC_MATCH", "this kind of `except` cannot be compiled.",
     "Test before dividing instead of catching."),
    (r"f-string|FORMAT_VALUE|FORMAT_SIMPLE", "a number cannot be formatted in compiled code.",
     "Print it without :.3f."),
    (r"STORE_GLOBAL", "globals cannot be changed.", "A sample must depend on its arguments only."),
    (r"IMPORT_NAME|IMPORT_FROM", "an import stands inside the function.", "Move it to the top of the file."),
    (r"context manager|BEFORE_WITH|EnterWith|'with'", "`with` cannot be compiled; files cannot be opened.", ""),
    (r"LOAD_BUILD_CLASS", "a class cannot be made inside a function.", "Use numbers, tuples and Vec3."),
    (r"unsupported opcode.*\((?P<a>\w+)\)|Use of unsupported opcode", "the compiler does not know this kind of line.",
     "Write it in simpler steps."),
    (r"Int value is too large", "the whole number is too large for 64 bits.", "Write it with a point: 1e20."),
    (r">>> dot\(", "np.dot is for arrays of floats.", "For two Vec3 write dot(a, b) of raylab.lecture."),
    (
        r">>> (?P<f>norm|cross|sum|sqrt|abs|sin|cos|exp|log|max|min|maximum|minimum|clip)\(.*Vec3",
        "`{f}` is given a Vec3, and is for numbers.",
        "Take the components one by one, or dot, length, cross, absolute of raylab.lecture.",
    ),
    (
        r"No implementation of function Function\(<(built-in )?(function|class|ufunc) '?(?P<f>[\w.]+)",
        "`{f}` cannot be called with these values.",
        "Look at the kinds of its arguments.",
    ),
    (r"No definition for lowering (?P<a>\w+)\.(?P<name>\w+) =", "this line changes `.{name}` of {a}.",
     "Make a new vector: Vec3(x, y, z)."),
    (r"Unknown attribute '(?P<name>\w+)' of type Module", "`{name}` is not known to it.",
     "Use another function, or write it out."),
    (r"getiter with parameters \(Tuple\(", "the elements of this tuple are not all of one kind.",
     "Write all of them as floats: (1.0, 2.0)."),
    (r"key.*dict|Dict", "dictionaries cannot be compiled.", "Use variables or tuples."),
    (r"unable to broadcast|broadcast", "the arrays on this line have different sizes.", ""),
)  # fmt: skip


def explain_python(error: Exception, source: Source, line: int) -> Problem:
    """An exception of the function in plain Python."""
    raw = f"{type(error).__name__}: {error}"
    sentence, advice = _look_up(PYTHON, raw, source) or (f"This line raises {raw}.", "")
    name = getattr(error, "name", None) or "".join(re.findall(r"local variable '(\w+)'", raw))
    if isinstance(error, UnboundLocalError) and _is_word(name, source):
        lines = " and ".join(str(n) for n in _lines_of(source, name))
        sentence = f"`{name}` is a function, and line {lines} makes a variable of that name."
        advice = f"Call the variable something else, such as {name}_1."
    return Problem(sentence, advice, line, _with_locals(raw, error))


def _is_word(name: str, source: Source) -> bool:
    return name in source.names or name in source.functions or name in allowed.BUILT_INS


def _with_locals(raw: str, error: Exception) -> str:
    """The raw text, and the values of the student's variables where it happened."""
    values: dict[str, Any] = {}
    trace = error.__traceback__
    while trace:
        if trace.tb_frame.f_code.co_filename == FILE:
            values = trace.tb_frame.f_locals
        trace = trace.tb_next
    shown = {n: repr(v) for n, v in values.items() if type(v).__name__ in ("int", "float", "Vec3", "bool", "NoneType")}
    return "\n".join([raw, *(f"    {name} = {value}" for name, value in shown.items())])


def explain_compiler(error: BaseException, source: Source) -> Problem:
    """What the compiler cannot handle, though plain Python could run it."""
    raw = _cleaned(str(error))
    as_python = _as_python(raw)
    found = _look_up(PYTHON, as_python, source) if as_python else None
    if found:
        reason = found[0] if found[0].startswith("Vec3") else found[0][0].lower() + found[0][1:]
    elif found := _look_up(COMPILER, raw, source):
        reason = found[0]
    else:
        return Problem(
            "Your Python is fine, but the compiler cannot handle this line, for a reason that has no name here.",
            "Write it in simpler steps; the compiler's own words are in the details.", line_of(raw, source), raw,
        )  # fmt: skip
    return Problem(f"Your Python is fine; the compiler cannot handle it: {reason}", found[1], line_of(raw, source), raw)


def line_of(raw: str, source: Source) -> int:
    """The last line of the student's file that the compiler names, 0 if none."""
    named = re.findall(rf'File "{re.escape(FILE)}", line (\d+)|{re.escape(FILE)} \((\d+)\)', raw)
    return int(named[-1][0] or named[-1][1]) if named else 0


def _cleaned(raw: str) -> str:
    """Without what concerns the machine and raylab's own frames."""
    kept = [line for line in raw.splitlines() if not re.search(r"raised from|<raylab>|REPL/exec|^\s*$", line)]
    text = re.sub(r"<module '(\w+)'[^>]*>", r"\1", "\n".join(kept))
    return re.sub(r"<function (\w+) at 0x\w+>", r"\1", re.sub(r"(/[\w.+-]+)+/(\w+\.py)", r"\2", text))


def _as_python(raw: str) -> str:
    """Python's words for the same fault; empty if it has none."""
    if found := re.search(r">>> (\w+)\((.*)\)\s*$", raw, re.M):
        name, arguments = found[1], [_python_type(t) for t in _split(found[2])]
        if name in _OPERATORS and len(arguments) == 2:
            return f"unsupported operand type(s) for {_OPERATORS[name]}: '{arguments[0]}' and '{arguments[1]}'"
        if name in _COMPARISONS and len(arguments) == 2:
            return f"'{_COMPARISONS[name]}' not supported between instances of '{arguments[0]}' and '{arguments[1]}'"
        if name == "getitem":
            return f"'{arguments[0]}' object is not subscriptable"
        if name == "setitem":
            return f"'{arguments[0]}' object does not support item assignment"
        if name == "Vec3":
            return "Vec3() takes"
    rewritten = (
        (
            r"Unknown attribute '(\w+)' of type (?!Module)(\w+)",
            lambda m: f"'{_python_type(m[2])}' object has no attribute '{m[1]}'",
        ),
        (r"tuple index out of range", lambda m: "IndexError: tuple index"),
        (r"expected (\d+), got (\d+)", lambda m: f"not enough values to unpack (expected {m[1]}, got {m[2]})"),
        (r"failed to unpack (\w+)", lambda m: f"cannot unpack non-iterable {m[1]}"),
        (
            r"Cannot bind 'args=.*missing a required argument: '(\w+)'(?s:.*?callee type: \S*Dispatcher\((\w+))?",
            lambda m: f"{m[2] or 'function'}() missing 1 required positional argument: '{m[1]}'",
        ),
        (r"Cannot bind 'args=.*too many positional", lambda m: "function() takes fewer values than are given"),
        (r"getiter with parameters \((?!Tuple)(.*)\)", lambda m: f"'{_python_type(m[1])}' object is not iterable"),
        (r"Invalid use of (?!getiter)(\w+).* with parameters", lambda m: f"'{m[1]}' object is not callable"),
    )  # fmt: skip
    for pattern, words in rewritten:
        if found := re.search(pattern, raw):
            return words(found)
    return ""


def _split(arguments: str) -> list[str]:
    """The parts of a list of types, whose brackets may nest."""
    parts, depth = [""], 0
    for character in arguments:
        depth += (character in "([<") - (character in ")]>")
        if character == "," and depth == 0:
            parts.append("")
        else:
            parts[-1] += character
    return [part.strip() for part in parts]


def _python_type(name: str) -> str:
    for pattern, python in (
        (r"u?int\d*|Literal\[int\].*", "int"), (r"float\d*", "float"), (r"none", "NoneType"), (r"Point.*", "Point"),
        (r"(Uni)?Tuple.*", "tuple"), (r"(reflected )?list.*", "list"), (r"(readonly )?array.*", "ndarray"),
        (r"unicode_type|Literal\[str\].*", "str"), (r"BoundFunction.*", "method"),
    ):  # fmt: skip
        if re.match(pattern, name):
            return python
    return re.split(r"[(<]", name)[0]


def _look_up(table: tuple[Row, ...], raw: str, source: Source) -> tuple[str, str] | None:
    for pattern, sentence, advice in table:
        if found := re.search(pattern, raw):
            words = {key: text or "" for key, text in found.groupdict().items()}
            words["parts"] = parts_of(words.get("a", ""))
            lines = _lines_of(source, words.get("name", ""))
            words["lines"] = f"line{'s' * (len(lines) > 1)} {' and '.join(str(n) for n in lines)}"
            words["types"] = " and ".join(in_words(t) for t in _split(words.get("types", "")))
            for key in ("a", "b"):
                words[key] = in_words(words.get(key, ""))
            words["raw"] = raw.split(": ", 1)[-1]
            made = sentence.format(**words)
            return made[0].upper() + made[1:] if table is PYTHON else made, advice.format(**words)
    return None


def _lines_of(source: Source, name: str) -> list[int]:
    """Where a variable is given a value."""
    nodes = [node for function in source.functions.values() for node in ast.walk(function)]
    return sorted(
        {n.lineno for n in nodes if isinstance(n, ast.Name) and n.id == name and isinstance(n.ctx, ast.Store)}
    )
