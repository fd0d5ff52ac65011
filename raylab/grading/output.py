"""Output: what a worker prints, of which only so much is kept."""

from __future__ import annotations

HEAD, TAIL = 48 << 10, 16 << 10  # bytes kept from the beginning and from the end


class Output:
    """What a process prints: the beginning and the end of it."""

    def __init__(self) -> None:
        self.head, self.tail, self.size = b"", b"", 0

    def add(self, printed: bytes) -> None:
        room = HEAD - len(self.head)
        self.head, self.tail = self.head + printed[:room], (self.tail + printed[room:])[-TAIL:]
        self.size += len(printed)

    def __str__(self) -> str:
        gap = self.size - len(self.head) - len(self.tail)
        middle = f"\n[... {gap} bytes left out ...]\n".encode() if gap else b""
        return (self.head + middle + self.tail).decode("utf-8", "replace")
