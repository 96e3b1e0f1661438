"""A model's arrays in two flat ones, so that one compiled path follower serves every model.

Kernels receive `reals` and `ints` and view the fields again by their number; `ints` begins with the
length of a table and the table: (offset, extents) of every field. Numbers are fields of one entry.
"""

from typing import Any, TypeAlias

import numpy as np

from coilspring.compiling.compiled import inlined, lent, shaped

HEAD = 4  # offset and three extents

# Fields of a NamedTuple are annotated by these, or by float and int, for `viewer`.
Vector: TypeAlias = np.ndarray
Table: TypeAlias = np.ndarray
Stack: TypeAlias = np.ndarray
Wholes: TypeAlias = np.ndarray
WholeTable: TypeAlias = np.ndarray
VIEWS = {
    "Vector": "vector(reals, head[{0}])",
    "Table": "table(reals, head[{0}])",
    "Stack": "stack(reals, head[{0}])",
    "float": "reals[head[{0}, 0]]",
    "Wholes": "vector(ints, head[{0}])",
    "WholeTable": "table(ints, head[{0}])",
    "int": "ints[head[{0}, 0]]",
}


def flat_fields(model: tuple) -> list[np.ndarray]:
    """Fields of a NamedTuple as arrays, those of nested ones in their place."""
    fields: list[np.ndarray] = []
    for value in model:
        if isinstance(value, tuple):
            fields += flat_fields(value)
        else:
            array = np.asarray(value)
            fields.append(array if array.ndim else array[None])
    return fields


def pack(model: tuple) -> tuple[np.ndarray, np.ndarray]:
    """Two flat arrays that hold all fields of a NamedTuple of arrays (3 axes at most) and numbers."""
    fields = flat_fields(model)
    head: list[int] = [HEAD * len(fields)]
    reals: list[np.ndarray] = []
    ints: list[np.ndarray] = []
    size = {True: 0, False: 1 + HEAD * len(fields)}
    for field in fields:
        real = field.dtype.kind == "f"
        head += [size[real], *field.shape, *(1,) * (3 - field.ndim)]
        (reals if real else ints).append(field.ravel())
        size[real] += field.size
    empty = np.zeros(0)
    packed = np.concatenate([np.array(head, dtype=np.int64), *ints], dtype=np.int64, casting="unsafe")
    return np.concatenate([empty, *reals]), packed


@inlined
def heads(ints):
    """Table of (offset, extents) of all fields; a row of it is what the functions below take."""
    count = ints[0] // HEAD  # the first integer is the length of the table
    return shaped(lent(ints)[1 : 1 + HEAD * count], (count, HEAD))


@inlined
def vector(flat, head):
    """Field as a vector."""
    return lent(flat)[head[0] : head[0] + head[1]]


@inlined
def table(flat, head):
    """Field as a table."""
    n, m = head[1], head[2]
    return shaped(lent(flat)[head[0] : head[0] + n * m], (n, m))


@inlined
def stack(flat, head):
    """Field as a stack of tables."""
    n, m, p = head[1], head[2], head[3]
    return shaped(lent(flat)[head[0] : head[0] + n * m * p], (n, m, p))


def viewer(record: Any, first: int = 0) -> Any:
    """A part of kernels that views a NamedTuple in the packed arrays, in which its fields begin at `first`.

    It takes `reals` and `ints`, or `ints` alone where the fields are integers.
    """
    kinds = enumerate(record.__annotations__.values(), first)
    fields = ", ".join(VIEWS[getattr(kind, "__forward_arg__", kind)].format(place) for place, kind in kinds)
    arguments = "reals, ints" if "reals" in fields else "ints"
    space = {**globals(), "record": record}
    text = f"def view({arguments}):\n    head = heads(ints)\n    return record({fields})\n"
    exec(compile(text, f"<view of {record.__name__}>", "exec"), space)
    space["view"].__qualname__ = f"view_{record.__name__}"
    return inlined(space["view"])
