"""How raylab compiles: numba in IEEE arithmetic, without the GIL, and a file cache that cannot go stale.

numba's own file cache does not notice an edited function in another file, so kernels are cached in a folder that
is named by everything they are made of: the sources of the package, the versions of numba and numpy, the CPU.
Student code is never cached.
"""

from __future__ import annotations

import contextlib
import functools
import hashlib
import os
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numba
import numpy as np
from llvmlite import binding as llvm
from numba import types
from numba.core import config
from numba.core.compiler import Compiler
from numba.core.registry import CPUDispatcher
from numba.extending import typeof_impl
from numba.misc.appdirs import AppDirs

# Division by zero gives inf as in C, NaN stays NaN (fastmath would delete every test for it), no GIL while running.
OPTIONS: dict[str, Any] = {"error_model": "numpy", "fastmath": False, "nogil": True}

# A process that may not write, such as the one that runs a submission, compiles everything anew.
CACHE = os.environ.get("RAYLAB_CACHE") != "off"


class Compiled:
    """A function for two callers: compiled code links its machine code in, Python calls it like any numba function.

    numba makes a Python entry point for each function it compiles. Here only those get one that Python calls, which
    halves the time to compile a kernel. `py_func` is the plain Python function.
    """

    in_python = False  # see `interpreted`

    def __init__(self, function: Callable[..., Any], options: dict[str, Any] = OPTIONS) -> None:
        functools.update_wrapper(self, function)
        self.py_func = function
        self._outer = numba.njit(**options)(function)
        self.inner = _InnerDispatcher(
            function, targetoptions=options | {"nopython": True, "forceinline": True}, pipeline_class=_InnerCompiler
        )

    def __call__(self, *arguments: Any, **named: Any) -> Any:
        if Compiled.in_python:
            return self.py_func(*arguments, **named)
        # numba takes every Python int for 64 bits with a sign
        return self._outer(*(np.uint64(a) if type(a) is int and a >= 1 << 63 else a for a in arguments), **named)


class _InnerCompiler(Compiler):
    def define_pipelines(self) -> Any:
        flags = self.state.flags
        flags.no_cpython_wrapper = flags.no_cfunc_wrapper = flags.no_compile = True
        return super().define_pipelines()


class _InnerDispatcher(CPUDispatcher):
    def add_overload(self, compiled: Any) -> None:
        compiled = compiled._replace(entry_point=object())  # nobody calls it, but numba finds the code by it
        self.targetctx.insert_user_function(compiled.entry_point, compiled.fndesc, [compiled.library])
        self.overloads[tuple(compiled.signature.args)] = compiled


@typeof_impl.register(Compiled)
def _typeof(value: Compiled, context: Any) -> types.Type:
    return types.Dispatcher(value.inner)


def njit(function: Callable[..., Any]) -> Any:
    """Compile `function` when it is needed; with NUMBA_DISABLE_JIT=1 it stays plain Python."""
    return function if config.DISABLE_JIT else Compiled(function)


@contextlib.contextmanager
def interpreted() -> Iterator[None]:
    """Within, all that `njit` has made runs as plain Python when Python calls it: at once, and under a debugger.

    For one thread; kernels that run meanwhile do not notice.
    """
    before, Compiled.in_python = Compiled.in_python, True
    try:
        yield
    finally:
        Compiled.in_python = before


def entry_point(dispatcher: Any, arguments: tuple[Any, ...]) -> Callable[..., Any]:
    """The compiled function for arguments of these types, compiled or loaded now if need be.

    Calling it skips numba's look at the types of the arguments, which takes half a millisecond for a scene.
    """
    if config.DISABLE_JIT:
        return dispatcher
    dispatcher = getattr(dispatcher, "_outer", dispatcher)
    signature = tuple(numba.typeof(argument) for argument in arguments)
    dispatcher.compile(signature)
    return dispatcher.overloads[signature].entry_point


def cached_njit(function: Callable[..., Any]) -> Any:
    """`njit`, and keep the machine code on disk for the next process."""
    return in_cache_folder(lambda: numba.njit(cache=CACHE, **OPTIONS)(function))


def in_cache_folder(decorate: Callable[[], Any]) -> Any:
    """Call `decorate()`, which sets up a cached numba function, with numba's cache folder set to ours."""
    theirs, config.CACHE_DIR = config.CACHE_DIR, str(cache_folder()) if CACHE else ""
    try:
        return decorate()
    finally:
        config.CACHE_DIR = theirs


@functools.cache
def cache_folder() -> Path:
    """The user's cache folder for exactly this code, these versions and this CPU."""
    content = hashlib.sha256()
    for source in sorted(Path(__file__).parent.glob("*.py")):  # folders below hold no kernels
        content.update(source.read_bytes())
    content.update(repr((numba.__version__, np.__version__, llvm.get_host_cpu_name())).encode())
    content.update(llvm.get_host_cpu_features().flatten().encode())
    return Path(AppDirs("raylab", False).user_cache_dir) / content.hexdigest()[:16]
