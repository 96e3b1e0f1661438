"""Compiled code made ready: from the cache, or on two processor cores where it is not there yet."""

import gc
import os
import subprocess
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib import import_module
from typing import Any

from coilspring.solver.bundles import bundled, compiled_bundle
from coilspring.solver.continuation.follower import compiled_follow
from coilspring.solver.equilibrium.newton import compiled_equilibrium
from coilspring.solver.interface import SIGNATURES, Kernels

# About half the work, Newton's method included; a child has the others and the follower.
PARENTS = ("assemble", "retract", "work", "rotate", "displacement_bound")


@cache
def ready(kernels: Kernels) -> tuple[Callable, Any]:
    """The compiled path follower and the bundle of kernels that it takes, compiled or read from the cache.

    The first time half of it is compiled in a child, which leaves it in the on-disk cache. A child
    that fails costs time only, since this process then compiles by itself.
    """
    others = [getattr(kernels, name) for name in kernels._fields if name not in PARENTS]
    if not all(other._cache.stored for other in others):
        places = [_place(other) for other in others]
        with background(f"from coilspring.solver.startup import compile_others; compile_others({places})"):
            compile_kernels(kernels, PARENTS)
            compile_newton()
    return compiled_follow(), kernel_bundle(kernels)


def kernel_bundle(kernels: Kernels) -> Any:
    """The bundle of kernels that path followers take, compiled or read from the cache."""
    compile_kernels(kernels)
    return bundled(kernels, compile_newton())


def stored(kernels: Kernels) -> bool:
    """Whether the disk holds a model's kernels, whatever it holds of what all models share; else they are
    compiled first."""
    return all(kernel._cache.stored for kernel in kernels)


@cache
def store(kernels: Kernels) -> None:
    """Compile the kernels that the disk does not hold: on all cores once, not in each process to come.

    What cannot be compiled, as a user's law may be, is left to what solves with it, which says so.
    """
    with suppress(Exception):  # numba has many kinds
        if not stored(kernels):
            ready(kernels)


def _roomy(function: Callable) -> Callable:
    """Give a function so large a frame that CPython makes room for all that it calls at once.

    Else the compiler's deep recursion maps and unmaps a piece of the interpreter's stack each time it crosses
    its end: a sixth of the time of compiling.
    """
    function.__code__ = function.__code__.replace(co_stacksize=1 << 16)
    return function


@_roomy
def compile_kernels(kernels: Kernels, names: tuple[str, ...] = Kernels._fields) -> None:
    """Compile a model's kernels, or read them from the cache, for the types `follow` calls with."""
    with _no_collection():
        for name in names:
            getattr(kernels, name).compile(getattr(SIGNATURES, name).args)


@_roomy
def compile_newton() -> Any:
    """Newton's method, and what puts it together with kernels, compiled or read from the cache."""
    with _no_collection():
        compiled_bundle()
        return compiled_equilibrium()


@_roomy
def compile_others(places: list[tuple[str, str]]) -> None:
    """The child's part: the follower, and the kernels at (module, name)."""
    with _no_collection():
        compiled_follow()
        for module, name in places:
            getattr(import_module(module), name).compile(getattr(SIGNATURES, name).args)


def background(code: str) -> subprocess.Popen:
    """Run a line of Python in a child that finds the packages where this process does."""
    places = os.pathsep.join(place or os.getcwd() for place in sys.path)
    return subprocess.Popen(
        [sys.executable, "-c", code],
        env=os.environ | {"PYTHONPATH": places},
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


@contextmanager
def _no_collection() -> Iterator[None]:
    """Hold back the garbage collector, which takes a sixth of the time of compiling."""
    on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if on:
            gc.enable()


def _place(kernel: Callable) -> tuple[str, str]:
    return kernel.__module__, kernel.__name__
