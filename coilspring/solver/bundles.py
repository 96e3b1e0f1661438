"""How compiled code holds what `coilspring.solver.system` describes, and the types of it.

Bundles are held by one pointer each: a tuple of arrays is handed on as a hundred numbers, which takes long to
compile. The bundle of kernels is made once, since Python takes long to hand them over.
"""

from functools import cache
from typing import Any

from numba import from_dtype, types
from numba.experimental import structref

from coilspring.compiling.compiled import lent, part, signed, zeros
from coilspring.contact.law import PAIR_HISTORY
from coilspring.solver.interface import SIGNATURES, Kernels, record_type
from coilspring.solver.system import NEWTON, PATH, SUBSTEP, Data, Records, System, Target, Task, Workspace


@structref.register
class _Fields(types.StructRef):
    """Type of a bundle by its fields."""


@structref.register
class _KernelFields(types.StructRef):
    """Type of the bundle of kernels."""


class SystemRef(structref.StructRefProxy):
    """`System` in compiled code."""


class TaskRef(structref.StructRefProxy):
    """`Task` in compiled code."""


class WorkRef(structref.StructRefProxy):
    """`Workspace` in compiled code."""


class KernelsRef(structref.StructRefProxy):
    """`coilspring.solver.interface.Kernels` in compiled code."""


structref.define_attributes(_Fields)
for _ref, _names in ((SystemRef, System), (TaskRef, Task), (WorkRef, Workspace)):
    structref.define_constructor(_ref, _Fields, list(_names._fields))
FUNCTIONS = (*Kernels._fields, "equilibrium")
structref.define_proxy(KernelsRef, _KernelFields, list(FUNCTIONS))


def _written(name: str, arguments: str, value: str, **reads: Any) -> Any:
    """Function of a text with each kernel's name: numba takes first-class functions singly."""
    space = reads | {"__name__": __name__}
    exec(f"def {name}({arguments}):\n    return {value}\n", space)
    return space[name]


_functions = ", ".join(FUNCTIONS)
_bundle = _written("_bundle", _functions, f"KernelsRef({_functions})", KernelsRef=KernelsRef)


@cache
def bundled(kernels: Kernels, equilibrium: Any) -> Any:
    """A model's kernels and `coilspring.solver.equilibrium.newton.equilibrium` as the follower takes them."""
    return compiled_bundle()(*kernels, equilibrium)


@cache
def compiled_bundle() -> Any:
    """`_bundle`, compiled; read from the cache where stored."""
    return signed(_bundle, *_kernel_types(), types.FunctionType(equilibrium_signature()))


def _kernel_types() -> tuple[Any, ...]:
    return tuple(types.FunctionType(signature) for signature in SIGNATURES)


def equilibrium_signature() -> Any:
    """numba's signature of `coilspring.solver.equilibrium.newton.equilibrium`."""
    vector, history, real = types.float64[::1], record_type(PAIR_HISTORY), types.float64
    data = (vector, types.int64[::1], vector, vector)
    system = _Fields(tuple(zip(System._fields, (*data, *_kernel_types()), strict=True)))
    work = _Fields(tuple(zip(Workspace._fields, workspace_type().types, strict=True)))
    numbers = (*(real,) * 6, types.int64, types.int64, real, types.boolean, real)
    target = types.NamedTuple((vector, real, history, vector, *numbers), Target)
    return types.int64(system, target, work, vector, from_dtype(NEWTON))


def system_types() -> tuple[Any, ...]:
    """Types of what `system_of` takes."""
    vector = types.float64[::1]
    functions = (*_kernel_types(), types.FunctionType(equilibrium_signature()))
    data = types.NamedTuple((vector, types.int64[::1], vector), Data)
    return data, _KernelFields(tuple(zip(FUNCTIONS, functions, strict=True)))


def task_type() -> Any:
    """numba's type of `Task`."""
    vector, real = types.float64[::1], types.float64
    fields = (*(vector,) * 5, *(real,) * 6, types.int64, types.boolean, types.boolean)
    return types.NamedTuple(fields, Task)


def records_type() -> Any:
    """numba's type of `Records`."""
    return types.NamedTuple([record_type(dtype) for dtype in (PATH, SUBSTEP, NEWTON)], Records)


def workspace_type() -> Any:
    """numba's type of `Workspace`."""
    vector, table = types.float64[::1], types.float64[:, ::1]
    others = {"histories": record_type(PAIR_HISTORY, 2), "states": table, "iterations": types.int64[::1]}
    others |= dict.fromkeys(("history", "trial_history", "low", "high"), record_type(PAIR_HISTORY))
    return types.NamedTuple([others.get(name, vector) for name in Workspace._fields], Workspace)


# `System` in compiled code.
_kernels = ", ".join(f"kernels.{name}" for name in Kernels._fields)
_system = f"SystemRef(lent(data.reals), lent(data.ints), lent(data.prescribed), zeros(1), {_kernels})"
_reads = {"SystemRef": SystemRef, "lent": lent, "zeros": zeros}
system_of = part(_written("system_of", "data, kernels", _system, **_reads))
