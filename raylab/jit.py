"""How raylab compiles: numba in IEEE arithmetic, without the GIL, and a file cache that cannot go stale.

numba's own file cache does not notice an edited function in another file, so kernels are cached in a folder that
is named by everything they are made of: all sources of the package, the versions of numba and numpy, the CPU.
Student code is never cached.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba
import numpy as np
from llvmlite import binding as llvm
from numba.core import config
from numba.misc.appdirs import AppDirs

# Division by zero gives inf as in C, NaN stays NaN (fastmath would delete every test for it), no GIL while running.
OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": False, "nogil": True}


def njit(function: Callable[..., Any]) -> Any:
    """Compile `function` on its first call; with NUMBA_DISABLE_JIT=1 it stays plain Python."""
    return numba.njit(**OPTIONS)(function)


def cached_njit(function: Callable[..., Any]) -> Any:
    """`njit`, and keep the machine code on disk for the next process."""
    return in_cache_folder(lambda: numba.njit(cache=True, **OPTIONS)(function))


def in_cache_folder(decorate: Callable[[], Any]) -> Any:
    """Call `decorate()`, which sets up a cached numba function, with numba's cache folder set to ours."""
    theirs, config.CACHE_DIR = config.CACHE_DIR, str(cache_folder())
    try:
        return decorate()
    finally:
        config.CACHE_DIR = theirs


@cache
def cache_folder() -> Path:
    """The user's cache folder for exactly this code, these versions and this CPU."""
    content = hashlib.sha256()
    for source in sorted(Path(__file__).parent.rglob("*.py")):
        content.update(source.read_bytes())
    content.update(repr((numba.__version__, np.__version__, llvm.get_host_cpu_name())).encode())
    content.update(llvm.get_host_cpu_features().flatten().encode())
    return Path(AppDirs("raylab", False).user_cache_dir) / content.hexdigest()[:16]
