"""The energy of a user's law, compiled for jets: so its first and second derivatives come with it."""

import builtins
import linecache
import re
from collections import ChainMap
from collections.abc import Callable
from functools import lru_cache
from types import CellType, FunctionType, ModuleType
from typing import Any, cast

from numba.np.unsafe.ndarray import to_fixed_tuple

from coilspring.compiling.compiled import kernel, part
from coilspring.compiling.kernelcache import codes, is_foreign
from coilspring.errors import InputError
from equivbeam.element import Response
from equivbeam.laws import jets

FIRST = 4  # column of the law's first own parameter: stiffnesses and length at rest come before
ALLOWED = "a law is plain arithmetic, elementary functions of numpy and math, branches and loops over a range"


@lru_cache(maxsize=256)
def compiled_law(law: str, digest: str, energy: FunctionType, columns: int) -> tuple[Callable, Callable]:
    """The response of a law by its name, content and energy, and a kernel that makes a table of it.

    The law's own parameters are the `columns` of its table of parameters from `FIRST` on.
    """
    content = f"{digest}_{jets.CONTENT}"
    strain_energy, variables, lifted = _part_of(energy, law, content, ()), jets.variables, jets.lifted
    count, fixed = columns - FIRST, cast("Any", to_fixed_tuple)

    def response(law, rows, i, l, v, dth):  # noqa: E741
        l, v, dth = variables(l, v, dth)  # noqa: E741
        u = lifted(strain_energy(l, v, dth, fixed(rows[i, FIRST:], count)))
        return Response(u.value, u.l, u.v, u.m, u.ll, u.lv, u.lm, u.vv, u.mm, u.vm)

    response.__name__ = response.__qualname__ = f"response_{content}"
    part(response)

    def tabulate(rows, index, points, out):
        for k in range(index.size):
            r = response(0, rows, index[k], points[k, 0], points[k, 1], points[k, 2])
            for j in range(out.shape[1]):
                out[k, j] = r[j]

    tabulate.__qualname__ = f"tabulate_{content}"
    return response, kernel(tabulate)


def _part_of(function: Any, law: str, content: str, callers: tuple[FunctionType, ...]) -> Callable:
    """A copy of a law's function as a part of kernels, with copies of those that it calls.

    Names hold the law's content: compiled code of two laws that came from the disk must not be mistaken for
    each other.
    """
    if function in callers:
        raise InputError(f"law {law}: {function.__name__} must not call itself")
    read = {name for code in codes(function.__code__) for name in code.co_names}

    def known(value: Any) -> Any:
        if value is print:  # it compiles, and its kernel hangs or fails as it runs
            raise InputError(f"law {law}: {function.__name__} must not print: {ALLOWED}")
        if isinstance(value, FunctionType) and not is_foreign(value.__module__):
            return _part_of(value, law, content, (*callers, function))
        if isinstance(value, ModuleType) and not is_foreign(value.__name__):
            copied = ModuleType(value.__name__)
            vars(copied).update({name: known(each) for name, each in vars(value).items() if name in read})
            return copied
        return value

    names = ChainMap(function.__globals__, vars(builtins))
    space = function.__globals__ | {name: known(names[name]) for name in read & names.keys()}
    cells = tuple(CellType(known(cell.cell_contents)) for cell in function.__closure__ or ())
    copied = FunctionType(function.__code__, space, function.__name__, function.__defaults__, cells)
    copied.__qualname__, copied.__module__ = f"{function.__name__}_{content}", __name__
    return part(copied)


def why_not_compiled(energy: Callable, error: Exception) -> str:
    """Why an energy cannot be compiled, with the line of its file, from what numba says."""
    text, file = re.sub(r"\x1b\[\d*m", "", str(error)), energy.__code__.co_filename
    place = re.search(rf'{re.escape(file)}(?:", line | \()(\d+)', text)
    number = int(place.group(1)) if place else 0
    line = f"line {number}: " if place else ""
    # of the calls with jets the innermost one in the law's own line: those beyond are in numba's code
    source, space = linecache.getline(file, number), energy.__globals__
    named = [re.search(rf"[\w.]*\b{name}\b", source) for name in re.findall(r">>> (\w+)\(.*\bjet\b", text)]
    called = [each.group() for each in named if each]
    foreign = [name for name in called if not isinstance(space.get(name), FunctionType)]
    refused = foreign or re.findall(r"built-in function (\w+)>", text)
    if refused:
        return f"{line}{refused[-1]} has no derivative here: {ALLOWED}"
    before = [each.strip(' "') for each in text[: place.start() if place else None].splitlines()]
    skipped = ("During", "File", ">>>", "Failed in", "^", "[", "-")
    reasons = [each for each in before if each and not each.startswith(skipped)] or [type(error).__name__]
    return f"{line}energy cannot be compiled: {reasons[-1 if place else 0]}: {ALLOWED}"
