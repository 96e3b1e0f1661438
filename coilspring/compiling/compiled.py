"""How the kernels are compiled, in one place."""

from collections.abc import Callable
from itertools import groupby
from typing import Any

import numpy as np
from numba import njit, types
from numba.core import cgutils, ir
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler
from numba.core.compiler_machinery import FunctionPass, PassManager, register_pass
from numba.core.untyped_passes import TranslateByteCode
from numba.extending import intrinsic, overload, register_jitable

from coilspring.compiling.kernelcache import OPTIONS, KernelCache


class _NoEnvironment:
    """Stands for the code generator where a part's environment would be set, which is for Python objects."""

    def set_env(self, name: str, environment: Any) -> None:
        """Nothing to set: the part is not in memory."""


class _PartLibrary(JITCodeLibrary):
    codegen = _NoEnvironment()  # type: ignore[assignment]

    def _optimize_functions(self, ll_module: Any) -> None:
        ll_module.data_layout = self._codegen._data_layout

    def _optimize_final_module(self) -> None:
        pass

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Address zero, numba's "not defined": nobody calls a part from outside."""
        self._ensure_finalized()
        return 0


@register_pass(mutates_CFG=False, analysis_only=False)
class SortPhis(FunctionPass):
    """Put what a block hands on to later ones in the order of its names.

    numba collects it in sets of names, whose order changes from process to process, and with it the order in
    which the compiler adds: two installations would differ in the last digits.
    """

    _name = "sort_phis"

    def __init__(self) -> None:
        super().__init__()

    def run_pass(self, state: Any) -> bool:
        """Sort; whether anything may have changed."""
        for block in state.func_ir.blocks.values():
            runs = groupby(block.body, lambda line: _phi(line) != "")
            block.body = [line for _, run in runs for line in sorted(run, key=_phi)]
        return True


def _phi(line: Any) -> str:
    """Name of what a line of a block hands on; empty of any other line."""
    handed = isinstance(line, ir.Assign) and line.target.name.startswith("$phi")
    return line.target.name if handed else ""


class KernelCompiler(Compiler):
    """numba's compiler, made to give the same code in each process."""

    def define_pipelines(self) -> list[PassManager]:
        """Its pipelines, with one more pass."""
        found = super().define_pipelines()
        for pipeline in found:
            pipeline.add_pass_after(SortPhis, TranslateByteCode)
            pipeline.finalize()
        return found


class PartCompiler(KernelCompiler):
    """That compiler, with a library that is kept as it is lowered and only linked into others.

    numba optimises and emits each function that another one calls, although the caller inlines it and is
    optimised as a whole: half the time of compiling. It has no option for that.
    """

    def __init__(self, typingctx: Any, targetctx: Any, library: Any, *rest: Any) -> None:
        super().__init__(typingctx, targetctx, _PartLibrary(targetctx.codegen(), "part"), *rest)


# Division by zero gives inf or nan ("numpy"): checking for it would cost a branch at each division.
KERNEL = {"error_model": "numpy", "pipeline_class": KernelCompiler}
ENTRY = KERNEL | {"no_cfunc_wrapper": True}
PART = ENTRY | {"pipeline_class": PartCompiler}
INLINED = PART | {"forceinline": True}
ARITHMETIC = INLINED | {"fastmath": {"contract", "reassoc", "nsz", "arcp"}}


def kernel(function: Callable) -> Any:
    """A function that Python calls or that is handed to the path follower: compiled once, stored on disk."""
    return _stored(function, KERNEL)


def signed(function: Callable, *arguments: Any) -> Any:
    """A kernel for arguments of these types alone, compiled or read from the disk here and now.

    It does not look at their types, which takes longer than a small spring to solve, and lets threads run.
    """
    return _stored(function, ENTRY | {"nogil": True}).compile(arguments)


def typed(function: Callable, signature: Any) -> Any:
    """A kernel compiled for one signature, to be handed to another one as a first-class function."""
    dispatcher = _stored(function, KERNEL)
    dispatcher.compile(signature.args)
    return dispatcher


def _stored(function: Callable, options: dict[str, Any]) -> Any:
    dispatcher = njit(**options)(function)
    setattr(function, OPTIONS, options)
    dispatcher._cache = KernelCache(function)
    return dispatcher


def _part(options: dict[str, Any]) -> Callable[[Callable], Any]:
    def mark(function: Callable) -> Any:
        setattr(function, OPTIONS, options)
        return register_jitable(**options)(function)

    return mark


# A part of kernels, compiled into them alone: without what Python would need to call it, and optimised with
# the kernel only. Called from Python it is plain Python.
part = _part(PART)

# The same, put wherever it is called: a call hands over each array as ten numbers or so, and counts it, which
# takes longer than a row of a matrix. Not for what the path follower is made of, which would take minutes to
# compile.
inlined = _part(INLINED)

# Inlined plain arithmetic: sums may be reordered and multiplied on the fly.
arithmetic = _part(ARITHMETIC)


def overloaded(function: Callable) -> Any:
    """Decorator: gives for types of arguments the part that compiled code runs where it calls `function`."""
    return overload(function, jit_options=PART, strict=False)  # type: ignore[arg-type]


def lent(given: Any) -> Any:
    """An array, or a tuple of arrays and numbers, as its caller holds it: views of it are not counted.

    numba counts every view of an array that may own its memory, in calls that cost as much as a row of a
    matrix. What compiled code is given belongs to its caller until it returns.
    """
    return given


def _unowned(typingctx, given):
    def lowered(context: Any, builder: Any, signature: Any, values: Any) -> Any:
        return _without_owners(context, builder, given, values[0])

    return given(given), lowered


def _without_owners(context: Any, builder: Any, kind: Any, value: Any) -> Any:
    """The value of an array or tuple, lowered, with arrays that nobody owns."""
    if isinstance(kind, types.BaseTuple):
        for i, each in enumerate(kind.types):  # type: ignore[attr-defined]
            item = _without_owners(context, builder, each, builder.extract_value(value, i))
            value = builder.insert_value(value, item, i)
    elif isinstance(kind, types.Array):
        array = context.make_array(kind)(context, builder, value=value)
        for owner in ("meminfo", "parent"):
            setattr(array, owner, cgutils.get_null_value(getattr(array, owner).type))
        value = array._getvalue()
    return value


_without_owner: Any = intrinsic(_unowned)


@overloaded(lent)
def _lent(given: Any) -> Callable:
    return lambda given: _without_owner(given)


@inlined
def shaped(flat, shape):
    """`flat.reshape(shape)` of what is lent: numba does not see that it has no owner either."""
    return lent(lent(flat).reshape(shape))


@inlined
def clear(vector):
    """vector[:] = 0; slice assignment compiles seconds of error messages."""
    for i in range(vector.size):
        vector[i] = 0.0


@inlined
def clear_table(table):
    """table[:] = 0."""
    for i in range(table.shape[0]):
        for j in range(table.shape[1]):
            table[i, j] = 0.0


@inlined
def copy(source, target):
    """target[:] = source for vectors."""
    for i in range(source.size):
        target[i] = source[i]


@inlined
def zeros(size):
    """Vector of zeros: one way to make a vector is compiled once, each of numpy's by itself."""
    out = np.empty(size)
    clear(out)
    return out


@inlined
def copied(source):
    """Copy of a vector."""
    out = zeros(source.size)
    copy(source, out)
    return out
