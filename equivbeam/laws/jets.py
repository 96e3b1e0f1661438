"""Numbers that carry their first and second derivatives in three variables: exact, without differences.

With a jet u = (value, gradient g, Hessian H) every operation f gives::

    f(u):  f,  f' g,  f' H + f'' g g^T
    u w:   u w,  u g_w + w g_u,  u H_w + w H_u + g_u g_w^T + g_w g_u^T

The variables are l, v and dtheta of a half coil. A jet is a type of numba's: compiled code of plain numbers
(the arithmetic, comparisons and functions below) takes jets in their place.
"""

import hashlib
import itertools
import math
import operator
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic, lower_cast, make_attribute_wrapper, models, register_model

from coilspring.compiling.compiled import overloaded, part

FIELDS = ("value", "l", "v", "m", "ll", "lv", "lm", "vv", "vm", "mm")  # m stands for dtheta
FLAT = (0.0, 0.0, 0.0, 0.0, 0.0, 0.0)  # Hessian of what is linear


class JetType(types.Type):
    """numba's type of a value with its derivatives; a number becomes one where branches meet."""

    def unify(self, typingctx: Any, other: Any) -> Any:
        """The common type of a jet and a number: a jet."""
        return self if isinstance(other, types.Integer | types.Float) else None


JET = JetType("jet")


@register_model(JetType)
class _JetModel(models.StructModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, [(name, types.float64) for name in FIELDS])


for _name in FIELDS:
    make_attribute_wrapper(JetType, _name, _name)


def _packed(context: Any, builder: Any, values: Any) -> Any:
    found = cgutils.create_struct_proxy(JET)(context, builder)
    for name, value in zip(FIELDS, values, strict=True):
        setattr(found, name, value)
    return found._getvalue()


def _jet(typingctx, value, g, H):
    """A jet of a value, its gradient (3) and the upper triangle of its Hessian (6), as in `FIELDS`."""

    def made(context, builder, _, given):
        parts = (cgutils.unpack_tuple(builder, each) for each in given[1:])
        return _packed(context, builder, (given[0], *itertools.chain.from_iterable(parts)))

    return JET(types.float64, *(types.UniTuple(types.float64, count) for count in (3, 6))), made


jet: Any = intrinsic(_jet)


@lower_cast(types.Integer, JetType)
@lower_cast(types.Float, JetType)
def _constant(context: Any, builder: Any, given: Any, wanted: Any, value: Any) -> Any:
    zero = context.get_constant(types.float64, 0.0)
    number = context.cast(builder, value, given, types.float64)
    return _packed(context, builder, (number, *[zero] * (len(FIELDS) - 1)))


@part
def variables(l, v, m):  # noqa: E741
    """The variables themselves."""
    return jet(l, (1.0, 0.0, 0.0), FLAT), jet(v, (0.0, 1.0, 0.0), FLAT), jet(m, (0.0, 0.0, 1.0), FLAT)


def lifted(u: Any) -> Any:
    """What compiled code has, a jet or a number, as a jet."""


@overloaded(lifted)
def _lifted(u: Any) -> Callable:
    def number(u):
        return jet(u, (0.0, 0.0, 0.0), FLAT)

    return (lambda u: u) if u == JET else number


@part
def chain(u, f, f1, f2):
    """The jet of a function of `u` from its value and derivatives there."""
    g = (f1 * u.l, f1 * u.v, f1 * u.m)
    H = (
        f1 * u.ll + f2 * u.l * u.l, f1 * u.lv + f2 * u.l * u.v, f1 * u.lm + f2 * u.l * u.m,
        f1 * u.vv + f2 * u.v * u.v, f1 * u.vm + f2 * u.v * u.m, f1 * u.mm + f2 * u.m * u.m,
    )  # fmt: skip
    return jet(f, g, H)


@part
def scaled(u, x):
    """u times a number."""
    H = (x * u.ll, x * u.lv, x * u.lm, x * u.vv, x * u.vm, x * u.mm)
    return jet(x * u.value, (x * u.l, x * u.v, x * u.m), H)


@part
def shifted(u, x):
    """u plus a number."""
    return jet(u.value + x, (u.l, u.v, u.m), (u.ll, u.lv, u.lm, u.vv, u.vm, u.mm))


@part
def add(u, w):
    """u + w."""
    H = (u.ll + w.ll, u.lv + w.lv, u.lm + w.lm, u.vv + w.vv, u.vm + w.vm, u.mm + w.mm)
    return jet(u.value + w.value, (u.l + w.l, u.v + w.v, u.m + w.m), H)


@part
def multiply(u, w):
    """u w."""
    a, b = u.value, w.value
    g = (a * w.l + b * u.l, a * w.v + b * u.v, a * w.m + b * u.m)
    H = (
        a * w.ll + b * u.ll + 2.0 * u.l * w.l,
        a * w.lv + b * u.lv + u.l * w.v + u.v * w.l,
        a * w.lm + b * u.lm + u.l * w.m + u.m * w.l,
        a * w.vv + b * u.vv + 2.0 * u.v * w.v,
        a * w.vm + b * u.vm + u.v * w.m + u.m * w.v,
        a * w.mm + b * u.mm + 2.0 * u.m * w.m,
    )
    return jet(a * b, g, H)


@part
def power(u, n):
    """u^n for a number n; a derivative whose factor is zero is zero, also where u is."""
    x = u.value
    f1 = n * x ** (n - 1.0) if n != 0.0 else 0.0
    f2 = n * (n - 1.0) * x ** (n - 2.0) if n != 0.0 and n != 1.0 else 0.0
    return chain(u, x**n, f1, f2)


@part
def atan2(u, w):
    """Angle of the point (w, u)."""
    y, x = lifted(u).value, lifted(w).value
    found = -math.atan(w / u) if abs(y) > abs(x) else math.atan(u / w)
    return found + (math.atan2(y, x) - lifted(found).value)


# Functions of one jet: first and second derivative at x, where the function is f.
DERIVATIVES: dict[tuple[Callable, ...], Callable] = {
    (math.sqrt, np.sqrt): lambda x, f: (0.5 / f, -0.25 / (f * x)),
    (math.exp, np.exp): lambda x, f: (f, f),
    (math.expm1, np.expm1): lambda x, f: (f + 1.0, f + 1.0),
    (math.log, np.log): lambda x, f: (1.0 / x, -1.0 / (x * x)),
    (math.log1p, np.log1p): lambda x, f: (1.0 / (1.0 + x), -1.0 / (1.0 + x) ** 2),
    (math.sin, np.sin): lambda x, f: (math.cos(x), -f),
    (math.cos, np.cos): lambda x, f: (-math.sin(x), -f),
    (math.tan, np.tan): lambda x, f: (1.0 + f * f, 2.0 * f * (1.0 + f * f)),
    (math.asin, np.arcsin): lambda x, f: (1.0 / math.sqrt(1.0 - x * x), x / math.sqrt(1.0 - x * x) ** 3),
    (math.acos, np.arccos): lambda x, f: (-1.0 / math.sqrt(1.0 - x * x), -x / math.sqrt(1.0 - x * x) ** 3),
    (math.atan, np.arctan): lambda x, f: (1.0 / (1.0 + x * x), -2.0 * x / (1.0 + x * x) ** 2),
    (math.sinh, np.sinh): lambda x, f: (math.cosh(x), f),
    (math.cosh, np.cosh): lambda x, f: (math.sinh(x), f),
    (math.tanh, np.tanh): lambda x, f: (1.0 - f * f, -2.0 * f * (1.0 - f * f)),
    (np.square,): lambda x, f: (2.0 * x, 2.0),
    (np.reciprocal,): lambda x, f: (-f * f, 2.0 * f * f * f),
}
# Functions of jets and numbers, by which of the arguments are jets (x), or whichever are.
RULES: dict[tuple[Callable, ...], dict[str, Callable]] = {
    (operator.neg, np.negative): {"x": lambda u: scaled(u, -1.0)},
    (operator.pos, np.positive, float): {"x": lambda u: u},
    (abs, np.abs, math.fabs): {"x": lambda u: -u if u < 0.0 else u},
    (operator.add, operator.iadd): {"xx": add, "x_": shifted, "_x": lambda x, u: shifted(u, x)},
    (operator.sub, operator.isub): {"any": lambda u, w: u + -w},
    (operator.mul, operator.imul): {"xx": multiply, "x_": scaled, "_x": lambda x, u: scaled(u, x)},
    (operator.truediv, operator.itruediv): {
        "x_": lambda u, x: scaled(u, 1.0 / x),
        "any": lambda u, w: u * np.reciprocal(w),
    },
    (operator.pow, operator.ipow, np.power, math.pow): {
        "x_": power,
        "any": lambda u, w: math.exp(w * math.log(u)),
    },
    (math.atan2, np.arctan2): {"any": atan2},
    (math.hypot, np.hypot): {"any": lambda u, w: math.sqrt(u**2 + w**2)},
    # the first of two that are equal
    (np.minimum,): {"any": lambda u, w: w if w < u else u},
    (np.maximum,): {"any": lambda u, w: w if w > u else u},
    (min,): {"any": lambda u, *others: np.minimum(u, min(*others) if len(others) > 1 else others[0])},
    (max,): {"any": lambda u, *others: np.maximum(u, max(*others) if len(others) > 1 else others[0])},
    (np.where,): {"any": lambda test, u, w: u if test else w},
}
# Of values alone: they change nowhere or by jumps, which `lawchecks` looks for.
OF_VALUES = (
    operator.lt, operator.le, operator.gt, operator.ge, operator.eq, operator.ne, round, int, bool,
    np.sign, np.floor, math.floor, np.ceil, math.ceil, np.isfinite,
)  # fmt: skip


def _teach(functions: tuple[Callable, ...], rules: dict[str, Callable]) -> None:
    """Let compiled code call functions with jets, by rules as in `RULES`.

    Names are unlike: compiled code that comes from the disk must not be mistaken for other.
    """

    def chosen(*given: Any) -> Callable | None:
        jets = "".join("x" if each == JET else "_" for each in given)
        return rules.get(jets, rules.get("any")) if "x" in jets else None

    for jets, rule in rules.items():
        rule.__qualname__ = f"{functions[0].__name__}_{jets}"
    for function in functions:
        overloaded(function)(chosen)


def _smooth(function: Callable, rates: Callable) -> dict[str, Callable]:
    """Rule of a function of one jet from its derivatives."""

    def rule(u):
        f = function(u.value)
        f1, f2 = rates(u.value, f)
        return chain(u, f, f1, f2)

    rates.__qualname__ = f"{function.__name__}_rates"
    part(rates)
    return {"x": rule}


def _of_values(function: Callable) -> dict[str, Callable]:
    """Rules of a function that has no derivative, or none but zero."""
    return {
        "x": lambda u: function(u.value),
        "x_": lambda u, w: function(u.value, w),
        "_x": lambda u, w: function(u, w.value),
        "xx": lambda u, w: function(u.value, w.value),
    }


for _functions, _rates in DERIVATIVES.items():
    _teach(_functions, _smooth(_functions[0], _rates))
for _functions, _rules in RULES.items():
    _teach(_functions, _rules)
for _function in OF_VALUES:
    _teach((_function,), _of_values(_function))

CONTENT = hashlib.sha256(Path(__file__).read_bytes()).hexdigest()[:16]
