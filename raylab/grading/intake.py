"""Intake: the files of a submission as bytes, or a sentence about what was found instead. Standard library only.

Only the names that are asked for are opened, and only regular files; nothing is unpacked, executed or parsed. A zip
archive is read like a folder, in memory.
"""

from __future__ import annotations

import os
import stat
import zipfile
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path, PurePosixPath

SIZE_LIMIT = 256 << 10  # bytes of one file
LINE_LIMIT = 10_000  # bytes of one line
ENTRY_LIMIT = 2000  # names that are looked at
SIGNATURES = {  # how files begin that are no Python source
    b"PK\x03\x04": "a zip archive", b"\x7fELF": "a compiled program", b"\x89PNG": "a picture",
    b"\xff\xfe": "text in UTF-16", b"\xfe\xff": "text in UTF-16", b"%PDF": "a PDF document", b"\x1f\x8b": "an archive",
    b"\x80\x04\x95": "a pickle", b"\x93NUMPY": "a numpy array",
}  # fmt: skip
ADVICE = "save it as UTF-8 text"


@dataclass(frozen=True)
class Intake:
    """The files that were asked for, sentences about those that cannot be used, and the names of all others."""

    files: dict[str, bytes]
    problems: list[str]
    ignored: list[str]


@dataclass(frozen=True)
class Entry:
    """A name, what kind of thing has it, and how many bytes are in it."""

    name: str
    kind: str  # "a file", "a folder", "a symbolic link", "no regular file"
    size: int


class Folder:
    """A folder on disk."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def entries(self) -> Iterator[Entry]:
        """All names, those of this folder first; links are not followed."""
        waiting = [PurePosixPath()]
        while waiting:
            below = waiting.pop(0)
            with os.scandir(self.path / below) as found:
                for each in found:
                    status = each.stat(follow_symlinks=False)
                    yield Entry(str(below / each.name), _kind(status.st_mode), status.st_size)
                    if stat.S_ISDIR(status.st_mode) and len(below.parts) < 4:
                        waiting.append(below / each.name)

    def read(self, name: str, limit: int) -> bytes:
        """At most `limit` bytes of a regular file; OSError if it has become something else."""
        handle = os.open(self.path / name, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
        with os.fdopen(handle, "rb") as file:
            if not stat.S_ISREG(os.fstat(handle).st_mode):
                raise OSError("no regular file")
            return file.read(limit)


class Archive:
    """A zip archive, read like a folder."""

    def __init__(self, path: Path) -> None:
        self.zip = zipfile.ZipFile(path)

    def entries(self) -> Iterator[Entry]:
        for member in self.zip.infolist():
            mode = member.external_attr >> 16
            kind = "a folder" if member.is_dir() else _kind(mode) if stat.S_IFMT(mode) else "a file"
            yield Entry(member.filename.rstrip("/"), kind, member.file_size)

    def read(self, name: str, limit: int) -> bytes:
        """At most `limit` bytes, whatever size the archive claims."""
        try:
            with self.zip.open(name) as file:
                return file.read(limit)
        except (zipfile.BadZipFile, RuntimeError, NotImplementedError, ValueError) as error:
            raise OSError(str(error)) from None


def collect(path: Path, wanted: Sequence[str] = ("shade.py",)) -> Intake:
    """The wanted files of a submission: a folder, a zip archive, or a Python file that is all of it."""
    if not path.is_dir() and not path.is_file():
        return Intake({}, [f"{path.name}: expected a folder, a zip archive or a Python file"], [])
    if path.suffix == ".py" and path.is_file() and len(wanted) == 1:
        return _alone(path, wanted[0])
    try:
        source = Folder(path) if path.is_dir() else Archive(path)
        entries = list(islice(source.entries(), ENTRY_LIMIT))
    except (OSError, zipfile.BadZipFile) as error:
        return Intake({}, [f"{path.name}: expected a folder, a zip archive or a Python file; {error}"], [])
    files, problems = {}, []
    for name in wanted:
        problem = complaint(name, entries)
        if not problem:
            try:
                content = source.read(name, SIZE_LIMIT + 1)
            except OSError as error:
                problem = f"{name} cannot be read: {error.strerror or error}"
            else:
                problem = content_complaint(name, content)
        if problem:
            problems.append(problem)
        else:
            files[name] = content
    return Intake(files, problems, [entry.name for entry in entries if entry.name not in wanted][:50])


def _alone(path: Path, name: str) -> Intake:
    with open(path, "rb") as file:
        content = file.read(SIZE_LIMIT + 1)
    problem = content_complaint(path.name, content)
    return Intake({}, [problem], []) if problem else Intake({name: content}, [], [])


def complaint(name: str, entries: Sequence[Entry]) -> str:
    """What is wrong with what stands under a name, if anything."""
    here = [entry for entry in entries if entry.name == name]
    if len(here) > 1:
        return f"{name} is there {len(here)} times; expected one file of this name"
    if not here:
        return missing(name, entries)
    if here[0].kind != "a file":
        return f"{name} is {here[0].kind}; expected a file of Python text"
    if here[0].size > SIZE_LIMIT:
        return f"{name} has {here[0].size} bytes; expected at most {SIZE_LIMIT}"
    return ""


def missing(name: str, entries: Sequence[Entry]) -> str:
    """There is no file of this name: what there is instead, the likeliest first."""
    stem = name.rpartition(".")[0].lower()
    files = [entry.name for entry in entries if entry.kind != "a folder"]
    found = next((other for other in files if other.lower() == name.lower()), "")
    if found:
        return f"expected a file {name}, found {found}: rename it (capital letters count)"
    real = [other for other in files if "__MACOSX" not in other]
    found = next((other for other in real if PurePosixPath(other).name.lower() == name.lower()), "")
    if found:
        return f"expected a file {name}, found {found}: hand in the file itself, without its folder"
    found = next((other for other in real if other.endswith(".ipynb")), "")
    if found:
        return f"expected a file {name}, found the notebook {found}: copy its functions into {name}"
    found = next((other for other in real if PurePosixPath(other).name.lower().startswith(stem)), "")
    if found:
        return f"expected a file {name}, found {_shown(found)}: rename it to {name}"
    found = next((other for other in real if other.lower().endswith((".zip", ".gz", ".rar", ".7z"))), "")
    if found:
        return f"expected a file {name}, found the archive {_shown(found)}: hand in the file itself"
    listed = ", ".join(map(_shown, files[:5])) or "nothing"
    return f"expected a file {name}, found {listed}{' and more' if len(files) > 5 else ''}"


def content_complaint(name: str, content: bytes) -> str:
    """What is wrong with bytes that should be Python text, as far as that can be seen without parsing."""
    if len(content) > SIZE_LIMIT:
        return f"{name} has more than {SIZE_LIMIT} bytes; expected less"
    if not content.strip():
        return f"{name} is empty"
    for start, what in SIGNATURES.items():
        if content.startswith(start):
            return f"{name} is {what}; expected Python text: {ADVICE if 'text' in what else 'hand in the source'}"
    if b"\0" in content:
        at = content.index(b"\0")
        return f"{name} has a NUL byte at offset {at} (line {_line(content, at)}), so it is no Python text: {ADVICE}"
    try:
        content.decode("utf-8")
    except UnicodeDecodeError as error:
        at = error.start
        return f"{name} is not UTF-8: byte 0x{content[at]:02x} at offset {at} (line {_line(content, at)}): {ADVICE}"
    if content.lstrip().startswith(b"{") and b'"cells"' in content:
        return f"{name} is a notebook; copy its functions into a file of Python text"
    longest = max(content.replace(b"\r", b"\n").split(b"\n"), key=len)
    if len(longest) > LINE_LIMIT:
        at = content.index(longest)
        return f"{name} has a line of {len(longest)} bytes (line {_line(content, at)}); expected at most {LINE_LIMIT}"
    return ""


def _line(content: bytes, at: int) -> int:
    return content.count(b"\n", 0, at) + 1


def _shown(name: str) -> str:
    """A name that is fit to be printed."""
    return name if name.isprintable() and len(name) < 100 else ascii(name)[:100]


def _kind(mode: int) -> str:
    kinds = {stat.S_IFREG: "a file", stat.S_IFDIR: "a folder", stat.S_IFLNK: "a symbolic link"}
    return kinds.get(stat.S_IFMT(mode), "no regular file")
