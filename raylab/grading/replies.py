"""Replies: what a worker sends in words, made harmless: flat, short, and in our own sentences."""

from __future__ import annotations

from typing import Any

from raylab.grading.faults import Fault
from raylab.grading.protocol import ProtocolError, unpack_words

KEYS = ("stage", "task", "kind", "line", "text", "sentence", "advice", "detail")  # of a finding
ERRORS = {
    "ZeroDivisionError": "the function divided by zero",
    "IndexError": "the function used an index that is out of range",
    "MemoryError": "the function asked for more memory than there is",
    "OverflowError": "a number became too large",
    "RecursionError": "the function called itself too often",
    "LookupError": "the function could not be compiled",
    "TypeError": "the function returned something else than it should",
    "TypingError": "the function could not be compiled",
}
LONGEST = 4000  # characters of a text that a worker sends


def fault_of(words: Any, output: str) -> Fault:
    """What went wrong, in our words: those of the program could tell what it was asked."""
    if not isinstance(words, dict):
        raise ProtocolError("no account of an error")
    sentence = ERRORS.get(str(words.get("error")), "the function raised an error")
    return Fault("error", sentence, f"{_short(words.get('error'))}: {_short(words.get('text'))}\n{output}")


def findings_of(reply: bytes) -> list[dict[str, Any]]:
    """Findings as a list of flat objects, whoever has sent them."""
    words = unpack_words(reply)
    if not isinstance(words, list) or not all(isinstance(finding, dict) for finding in words):
        raise ProtocolError("no list of findings")
    return [{key: _short(finding.get(key)) for key in KEYS} for finding in words[:200]]


def _short(value: Any) -> Any:
    return value[:LONGEST] if isinstance(value, str) else value if isinstance(value, int) else None
