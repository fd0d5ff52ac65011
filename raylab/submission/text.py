"""Text: from bytes to a syntax tree, or a sentence that says why not."""

from __future__ import annotations

import ast
import re
import unicodedata

from raylab.submission.finding import Problem

LARGEST = 256 * 1024
LONGEST = 2000  # characters of one line
_NO_TEXT = {
    b"PK\x03\x04": "a zip file", b"\x7fELF": "a compiled program", b"%PDF": "a PDF document", b"\x89PNG": "a picture",
    b"\x1f\x8b": "a gzip file", b"\xff\xd8\xff": "a picture", b"{\\rtf": "an RTF document",
}  # fmt: skip
_QUOTES = {"\u2018": "'", "\u2019": "'", "\u201c": '"', "\u201d": '"', "\u201e": '"', "\u00ab": '"', "\u00bb": '"'}
_LOOKALIKES = {"\u2212": "-", "\u2013": "-", "\u2014": "-", "\u00d7": "*", "\u00b7": "*", "\u00f7": "/"}
_TURNING = set("\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069\u200e\u200f\u061c")  # bidirectional controls
_SYNTAX_ADVICE = (
    (r"expected ':'", "A line that begins with def, if, else, for or while ends with a colon."),
    (r"was never closed|unmatched '|closing parenthesis", "Count the brackets: each one that opens must close."),
    (r"unterminated .*string", "A quotation mark is missing at the end of the text."),
    (r"unexpected indent", "This line begins further right than the one above it; align them."),
    (r"unindent does not match", "No line above begins at this column; align it with one of them."),
    (r"expected an indented block", "The line above ends with a colon, so indent this one by four spaces."),
    (r"inconsistent use of tabs", "Some lines begin with tabs and others with spaces; use spaces only."),
    (r"cannot assign to|Maybe you meant '=='", "= gives a name to a value; to compare two values write ==."),
    (r"Missing parentheses in call to 'print'", "Write print(...)."),
    (r"forgot a comma", "Perhaps a comma or a * is missing."),
    (r"'return' outside function", "This return stands outside of the function: indent it by four spaces."),
    (r"invalid decimal literal", "A name cannot begin with a digit, and a product needs a *: 2 * r, not 2r."),
)  # fmt: skip


def decode(data: bytes) -> str:
    """The text of a file with plain line ends, or a Problem."""
    if len(data) > LARGEST:
        raise Problem(f"The file has {len(data)} bytes; at most {LARGEST} are read.", "Hand in the Python source only.")
    if not data.strip(b" \t\r\n\x00\xef\xbb\xbf"):
        raise Problem("The file is empty.", "Begin with the file that the assignment gives you.")
    for magic, name in _NO_TEXT.items():
        if data.startswith(magic):
            raise Problem(f"The file is {name}, not Python source.", "Hand in the .py file itself.")
    if data[:2] in (b"\xff\xfe", b"\xfe\xff"):
        raise Problem("The file is saved as UTF-16.", "Save it as UTF-8: most editors offer it under Save As.")
    if b"\x00" in data:
        line = data[: data.index(b"\x00")].count(b"\n") + 1
        raise Problem("The file contains a NUL byte, so it is not text.", "Save it as UTF-8 text.", line)
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        line = data[: error.start].count(b"\n") + 1
        raise Problem(
            f"The file is not UTF-8: byte {error.start} is 0x{data[error.start]:02x}.", "Save it as UTF-8.", line
        ) from None
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if re.match(r'\s*\{\s*"(cells|metadata|nbformat)"', text):
        raise Problem("The file is a notebook.", "Copy your functions into a .py file and hand that in.")
    for number, line_text in enumerate(text.split("\n"), start=1):
        if len(line_text) > LONGEST:
            raise Problem(f"This line has {len(line_text)} characters.", f"At most {LONGEST} are read.", number)
        for column, character in enumerate(line_text, start=1):
            if character in _TURNING:
                raise Problem(
                    f"Column {column} holds the invisible character {_named(character)}, which makes text look "
                    "different from what it is.", "Delete it, or type the line anew.", number,
                )  # fmt: skip
    return text


def parse(text: str) -> ast.Module:
    """The syntax tree, or a Problem in words."""
    try:
        tree = ast.parse(text)
    except SyntaxError as error:
        raise _syntax(error, text) from None
    except (RecursionError, MemoryError, ValueError) as error:
        raise Problem("The file is nested too deeply to be read.", detail=f"{type(error).__name__}: {error}") from None
    for node in ast.walk(tree):
        for name in (getattr(node, "id", None), getattr(node, "name", None), getattr(node, "arg", None)):
            for character in name if isinstance(name, str) else "":
                if "CYRILLIC" in unicodedata.name(character, ""):
                    raise Problem(
                        f"The name `{name}` contains {_named(character)}, which looks like a Latin letter and is "
                        "another one.", "Type the name anew.", getattr(node, "lineno", 0),
                    )  # fmt: skip
    return tree


def _syntax(error: SyntaxError, text: str) -> Problem:
    line, column = error.lineno or 0, error.offset or 0
    lines = text.split("\n")
    shown = lines[line - 1] if 0 < line <= len(lines) else ""
    detail = f"{shown}\n{' ' * max(0, column - 1)}^" if shown and column else ""
    for position, character in enumerate(shown, start=1):
        instead = _QUOTES.get(character) or _LOOKALIKES.get(character)
        if instead or character in "\u00a0\u200b\u2003\ufeff" or unicodedata.category(character) == "Cf":
            advice = f"Type {instead} instead." if instead else "Replace it by an ordinary space."
            sentence = f"Column {position} holds {_named(character)}, which Python does not read."
            return Problem(sentence, f"{advice} Such characters come from word processors and web pages.", line, detail)
    said = error.msg or "invalid syntax"
    advice = next((advice for pattern, advice in _SYNTAX_ADVICE if re.search(pattern, said)), "")
    if not advice:
        advice = "Look at the marked place, and at the end of the line above: a bracket or a colon is often missing."
    return Problem(f"Python cannot read this line: {said}.", advice, line, detail)


def _named(character: str) -> str:
    return f"U+{ord(character):04X} ({unicodedata.name(character, 'no name').lower()})"
