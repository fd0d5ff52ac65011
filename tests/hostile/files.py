"""1 to 18: files that are not what they should be, and files beside the one that is."""

from __future__ import annotations

import os
import zipfile

from hostile.case import Case, beside, honest, only
from hostile.toy import FULL, HONEST

STUB = 'def warp(u):\n    raise NotImplementedError("not written yet")\n\n\ndef square(a):\n    pass\n'
DEEP = "def warp(u):\n    return " + "(" * 100_000 + "1.0" + ")" * 100_000 + "\n"
ELIF = "def warp(u):\n    if u[0] == 0:\n        pass\n" + "".join(
    f"    elif u[0] == {i}:\n        pass\n" for i in range(4000)
)
EVIL = b"raise SystemExit(0)\nimport os; os._exit(0)\n"


def link(folder):
    (folder / "shade.py").symlink_to("/etc/shadow")


def link_to_hidden(folder):
    (folder / "shade.py").symlink_to(folder.parent / "source" / "expected.npz")


def pipe(folder):
    os.mkfifo(folder / "shade.py")


def archive(folder):
    with zipfile.ZipFile(folder / "handin.zip", "w") as file:
        file.writestr("../../run_autograder", EVIL)
        file.writestr("shade.py", HONEST)


CASES = [
    Case(1, "empty file", only(b""), 0.0, says="shade.py is empty"),
    Case(2, "stub", only(STUB.encode()), 0.0),
    Case(3, "missing", beside({}), 0.0, says="found nothing"),
    Case(3, "wrong case", beside({"Shade.py": honest()}), 0.0, says="found Shade.py: rename it"),
    Case(3, "in a folder", beside({"a1/shade.py": honest()}), 0.0, says="found a1/shade.py"),
    Case(3, "of a Macintosh", beside({"__MACOSX/._shade.py": honest()}), 0.0, says="expected a file shade.py"),
    Case(4, "BOM, CRLF, tabs", only(b"\xef\xbb\xbf" + honest().replace(b"    ", b"\t").replace(b"\n", b"\r\n")), FULL),
    Case(5, "UTF-16", only(HONEST.encode("utf-16")), 0.0, says="save it as UTF-8"),
    Case(5, "Latin-1", only("# Lösung\n".encode("latin-1") + honest()), 0.0, says="offset 3"),
    Case(6, "NUL byte", only(honest() + b"\0"), 0.0, says="NUL byte"),
    Case(7, "smart quotes", only("x = “a”\n".encode() + honest()), 0.0),
    Case(7, "no-break space", only("x =\u00a01\n".encode() + honest()), 0.0),
    Case(7, "text that runs backwards", only("# \u202e evil\n".encode() + honest()), 0.0, walls=("ladder",)),
    Case(8, "50 MB", only(b"#" * 50_000_000), 0.0, says="expected at most"),
    Case(8, "a long line", only(b"#" * 200_000), 0.0, says="has a line of 200000 bytes"),
    Case(9, "nested parentheses", only(DEEP.encode().replace(b"return ", b"return \\\n") + honest()), 0.0),
    Case(9, "many elif", only(ELIF.encode()), 0.0),
    Case(10, "link to /etc/shadow", link, 0.0, says="is a symbolic link"),
    Case(10, "link to hidden data", link_to_hidden, 0.0, says="is a symbolic link"),
    Case(10, "named pipe", pipe, 0.0, says="is no regular file"),
    Case(11, "zip with a way out", archive, 0.0, says="found the archive handin.zip"),
    Case(12, "settings of pytest", beside({
        "shade.py": honest(), "conftest.py": EVIL, "pytest.ini": b"[pytest]\naddopts = -p evil\n", "evil.py": EVIL,
        "tox.ini": b"[pytest]\n", "setup.cfg": b"[tool:pytest]\naddopts=-p evil\n", "pyproject.toml": b"[tool.ruff]\n",
    }), FULL),
    Case(13, "modules of other names", beside({
        "shade.py": honest(), "numpy.py": EVIL, "numba.py": EVIL, "raylab/__init__.py": EVIL, "math.py": EVIL,
        "sitecustomize.py": EVIL, "evil.pth": b"import os; os._exit(0)\n",
    }), FULL),
    Case(14, "a package and a library", beside({
        "shade.py": honest(), "shade/__init__.py": EVIL, "shade.cpython-311-x86_64-linux-gnu.so": b"\x7fELF",
    }), FULL),
    Case(15, "compiled file", beside({"shade.py": honest(), "__pycache__/shade.cpython-311.pyc": b"evil"}), FULL),
    Case(16, "cache of numba", beside({"shade.py": honest(), "__pycache__/a.py311.nbi": b"\x80\x04."}), FULL),
    Case(17, "settings of numba", beside({"shade.py": honest(), ".numba_config.yaml": b"disable_jit: 1\n"}), FULL),
    Case(18, "pickles", beside({"shade.py": honest(), ".OTTER_LOG": b"\x80\x04.", "a.npy": b"\x93NUMPY"}), FULL),
]  # fmt: skip
