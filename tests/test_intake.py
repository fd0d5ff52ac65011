"""What students hand in, and what is said about it: bad input gets a sentence with what was found and expected."""

from __future__ import annotations

import json
import os
import re
import zipfile

import pytest

from raylab.grading.intake import LINE_LIMIT, SIZE_LIMIT, collect

GOOD = b"def shade(x, k_d, N, scene, rng):\n    return k_d\n"


def put(folder, files):
    for name, content in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    return folder


BAD = {
    "nothing": ({}, "found nothing"),
    "empty": ({"shade.py": b""}, "shade.py is empty"),
    "only white": ({"shade.py": b" \r\n\t\n"}, "shade.py is empty"),
    "capital": ({"Shade.py": GOOD}, r"expected a file shade\.py, found Shade\.py: rename it"),
    "in a folder": ({"a1/shade.py": GOOD}, r"found a1/shade\.py: hand in the file itself, without its folder"),
    "of a Macintosh": ({"__MACOSX/._shade.py": GOOD}, r"expected a file shade\.py, found __MACOSX/\._shade\.py"),
    "second download": ({"shade (1).py": GOOD}, r"found shade \(1\)\.py: rename it to shade\.py"),
    "hidden extension": ({"shade.py.txt": GOOD}, r"found shade\.py\.txt: rename it"),
    "notebook": ({"shade.ipynb": b"{}"}, r"found the notebook shade\.ipynb: copy its functions"),
    "notebook called .py": ({"shade.py": b'{"cells": []}'}, "is a notebook"),
    "zipped": ({"handin.zip": b"PK\x03\x04"}, r"found the archive handin\.zip"),
    "zip called .py": ({"shade.py": b"PK\x03\x04..."}, "is a zip archive"),
    "other files": ({"a.py": GOOD, "b.py": GOOD}, r"expected a file shade\.py, found "),
    "UTF-16": ({"shade.py": GOOD.decode().encode("utf-16")}, "is text in UTF-16; .* save it as UTF-8"),
    "UTF-16 without mark": ({"shade.py": GOOD.decode().encode("utf-16-le")}, r"NUL byte at offset 1 \(line 1\)"),
    "Latin-1": ({"shade.py": GOOD + "# Lösung".encode("latin-1")}, r"not UTF-8: byte 0xf6 at offset 52 \(line 3\)"),
    "NUL": ({"shade.py": GOOD + b"\0"}, r"NUL byte at offset 49 \(line 3\)"),
    "binary": ({"shade.py": b"\x7fELF\x02"}, "is a compiled program"),
    "huge": ({"shade.py": b"#" * (SIZE_LIMIT + 1)}, f"has {SIZE_LIMIT + 1} bytes; expected at most {SIZE_LIMIT}"),
    "long line": ({"shade.py": GOOD + b"#" * (LINE_LIMIT + 1)}, rf"line of {LINE_LIMIT + 1} bytes \(line 3\)"),
    "odd name": ({"\x1b[2J.py": GOOD}, r"found '\\x1b\[2J\.py'"),
}


@pytest.mark.parametrize(("files", "sentence"), BAD.values(), ids=BAD)
def test_bad_input_gets_a_sentence(tmp_path, files, sentence):
    found = collect(put(tmp_path, files))
    assert found.files == {}
    assert len(found.problems) == 1
    assert re.search(sentence, found.problems[0])


@pytest.mark.parametrize("content", [GOOD, b"\xef\xbb\xbf" + GOOD.replace(b"\n", b"\r\n"), GOOD + "# ö €".encode()])
def test_good_input_is_taken_as_it_is(tmp_path, content):
    assert collect(put(tmp_path, {"shade.py": content})).files == {"shade.py": content}


def test_other_files_are_named_and_not_opened(tmp_path):
    others = ["conftest.py", "numpy.py", "__pycache__/shade.cpython-311.pyc", ".numba_config.yaml", "shade/__init__.py"]
    put(tmp_path, dict.fromkeys(others, b"raise SystemExit"))
    put(tmp_path, {"shade.py": GOOD})
    found = collect(tmp_path)
    assert found.files == {"shade.py": GOOD}
    assert set(others) <= set(found.ignored)


def test_no_link_folder_or_pipe_is_opened(tmp_path):
    for make, kind in (
        (lambda path: path.symlink_to("/etc/passwd"), "a symbolic link"),
        (os.mkfifo, "no regular file"),
        (os.mkdir, "a folder"),
    ):
        folder = tmp_path / kind.replace(" ", "")
        folder.mkdir()
        make(folder / "shade.py")
        assert collect(folder).problems == [f"shade.py is {kind}; expected a file of Python text"]
    os.mkfifo(tmp_path / "pipe")
    assert collect(tmp_path / "pipe").problems == ["pipe: expected a folder, a zip archive or a Python file"]


def archive(path, *members):
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as file:
        for name, content, mode in members:
            info = zipfile.ZipInfo(name)
            info.external_attr, info.compress_type = mode << 16, zipfile.ZIP_DEFLATED
            file.writestr(info, content)
    return path


def test_an_archive_is_read_like_a_folder(tmp_path):
    path = archive(tmp_path / "a.zip", ("shade.py", GOOD, 0o100644), ("../../run_autograder", b"evil", 0o100755))
    found = collect(path)
    assert (found.files, found.problems) == ({"shade.py": GOOD}, [])
    assert [entry.name for entry in tmp_path.iterdir()] == ["a.zip"]


@pytest.mark.filterwarnings("ignore:Duplicate name")
def test_bad_archives_get_a_sentence(tmp_path):
    cases = {
        "link": ((("shade.py", b"/etc/passwd", 0o120777),), "is a symbolic link"),
        "twice": ((("shade.py", GOOD, 0o100644), ("shade.py", b"x", 0o100644)), "is there 2 times"),
        "absolute": ((("/shade.py", GOOD, 0o100644),), "without its folder"),
        "up": ((("../shade.py", GOOD, 0o100644),), "without its folder"),
        "bomb": ((("shade.py", b"\0" * 50_000_000, 0o100644),), "has 50000000 bytes"),
    }
    for name, (members, sentence) in cases.items():
        found = collect(archive(tmp_path / f"{name}.zip", *members))
        assert found.files == {}
        assert sentence in found.problems[0]
    (tmp_path / "broken.zip").write_bytes(b"PK\x03\x04 and no more")
    assert "expected a folder, a zip archive" in collect(tmp_path / "broken.zip").problems[0]


def test_a_bomb_that_lies_about_its_size_is_read_no_further_than_the_limit(tmp_path):
    path = archive(tmp_path / "a.zip", ("shade.py", b"#" * 50_000_000, 0o100644))
    data = bytearray(path.read_bytes())
    at = data.index(b"PK\x01\x02") + 24  # the size in the table of contents
    data[at : at + 4] = (100).to_bytes(4, "little")
    path.write_bytes(data)
    assert all(len(content) <= SIZE_LIMIT for content in collect(path).files.values())


def test_a_hundred_thousand_names_are_not_looked_at(tmp_path):
    for number in range(3000):
        (tmp_path / f"{number:04}.txt").touch()
    found = collect(tmp_path)
    assert len(found.ignored) == 50
    assert json.dumps(found.problems)


def test_a_python_file_alone_may_have_any_name(tmp_path):
    put(tmp_path, {"alice.py": GOOD})
    assert collect(tmp_path / "alice.py").files == {"shade.py": GOOD}
