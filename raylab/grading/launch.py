"""Launch: the first process to start for a submission; closes the jail around itself, then becomes the worker.

python -I launch.py '{"rules": {...}, "library": ..., "requests": fd, "replies": fd}'

Before the jail is closed only the standard library is imported: no thread may have started, since Landlock and
seccomp bind the thread that asks for them and those that it starts.
"""

from __future__ import annotations

import faulthandler
import json
import sys
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import Any


def close(rules: dict[str, Any]) -> dict[str, Any]:
    """Close the jail; the package raylab itself, which starts numba, is not imported for it."""
    folder = Path(__file__).resolve().parent
    for name, place in (("raylab", folder.parent), ("raylab.grading", folder)):
        sys.modules[name] = ModuleType(name)
        sys.modules[name].__path__ = [str(place)]
    from raylab.grading import jail

    return jail.close(jail.Rules(**rules)).as_json()


def import_raylab(folder: Path) -> None:
    """Import raylab out of this folder, wherever else there is one, and without a look at what stands beside it."""
    for name in [name for name in sys.modules if name.split(".")[0] == "raylab"]:
        del sys.modules[name]
    spec = spec_from_file_location("raylab", folder / "__init__.py", submodule_search_locations=[str(folder)])
    assert spec
    assert spec.loader
    sys.modules["raylab"] = module_from_spec(spec)
    spec.loader.exec_module(sys.modules["raylab"])


def main(order: dict[str, Any]) -> None:
    record = close(order["rules"])
    faulthandler.enable()  # a crash says in which line of Python
    sys.dont_write_bytecode = True
    sys.stdout.reconfigure(line_buffering=True, errors="replace")  # type: ignore[union-attr]
    if not order["ladder"]:
        import_raylab(Path(order["library"]) / "raylab")
    from raylab.grading.worker import serve

    serve(order["requests"], order["replies"], record, order["ladder"])


if __name__ == "__main__":
    main(json.loads(sys.argv[1]))
