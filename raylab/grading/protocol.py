"""Protocol: what the grader and the worker say to each other, as frames of bytes. Standard library only.

    magic (4) | number of the request (u64) | length (u64) | kind (u8) | payload

Little-endian. Numbers are raw float64 of a length that the grader knows beforehand; words are a short JSON object.
No pickle, no object is ever made from what a student's process has sent.
"""

from __future__ import annotations

import json
import struct
from enum import IntEnum
from typing import Any, BinaryIO

MAGIC = b"rayl"
HEADER = struct.Struct("<4sQQB")
WORDS_LIMIT = 1 << 18  # bytes


class Kind(IntEnum):
    """What a frame holds. A fault is words about why there are no numbers."""

    WORDS = 1
    NUMBERS = 2
    FAULT = 3


class ProtocolError(Exception):
    """The other side does not keep to the protocol."""


def pack(number: int, kind: Kind, payload: bytes) -> bytes:
    return HEADER.pack(MAGIC, number, len(payload), kind) + payload


def pack_words(number: int, words: Any, kind: Kind = Kind.WORDS) -> bytes:
    return pack(number, kind, json.dumps(words).encode())


def unpack_header(header: bytes, number: int, expected: int | None) -> tuple[Kind, int]:
    """Kind and length of the frame that answers request `number`; `expected` bytes of numbers, None for words."""
    magic, answered, length, kind = HEADER.unpack(header)
    if magic != MAGIC or kind not in tuple(Kind):
        raise ProtocolError("bytes that are no reply")
    if answered != number:
        raise ProtocolError(f"a reply to request {answered}; expected one to {number}")
    if kind == Kind.NUMBERS and length != expected:
        raise ProtocolError(f"{length} bytes of numbers; expected {expected}")
    if kind != Kind.NUMBERS and length > WORDS_LIMIT:
        raise ProtocolError(f"{length} bytes of words; expected at most {WORDS_LIMIT}")
    if kind == Kind.WORDS and expected is not None:
        raise ProtocolError("words; expected numbers")
    return Kind(kind), length


def unpack_words(payload: bytes) -> Any:
    try:
        return json.loads(payload.decode())
    except (ValueError, RecursionError) as error:
        raise ProtocolError("words that are no JSON") from error


def receive(stream: BinaryIO) -> tuple[int, dict[str, Any], bytes] | None:
    """The worker's side: the next request, as its number, what is asked, and bytes that come with it; None at the end.

    A request is two frames of the same number.
    """
    parts = []
    for _ in range(2):
        header = stream.read(HEADER.size)
        if len(header) < HEADER.size:
            return None
        _, number, length, _ = HEADER.unpack(header)
        parts.append(stream.read(length))
    return number, json.loads(parts[0]), parts[1]
