"""Numbers that carry their first and second derivatives in three variables: exact, without differences.

With a jet u = (value, gradient g, Hessian H) every operation f gives::

    f(u):  f,  f' g,  f' H + f'' g g^T
    u w:   u w,  u g_w + w g_u,  u H_w + w H_u + g_u g_w^T + g_w g_u^T

The variables are l, v and dtheta of a half coil. `equivbeam.laws.differentiation` writes the calls.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from coilspring.compiling.compiled import part


class Jet(NamedTuple):
    """A value with its derivatives in l, v and m, which stands for dtheta."""

    value: float
    l: float  # noqa: E741
    v: float
    m: float
    ll: float
    lv: float
    lm: float
    vv: float
    vm: float
    mm: float


@part
def constant(x):
    """A number that depends on none of the variables."""
    return Jet(1.0 * x, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)


@part
def variables(l, v, m):  # noqa: E741
    """The variables themselves."""
    return (
        Jet(l, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        Jet(v, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        Jet(m, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
    )


@part
def chain(u, f, f1, f2):
    """The jet of a function of `u` from its value and derivatives there."""
    return Jet(
        f, f1 * u.l, f1 * u.v, f1 * u.m,
        f1 * u.ll + f2 * u.l * u.l, f1 * u.lv + f2 * u.l * u.v, f1 * u.lm + f2 * u.l * u.m,
        f1 * u.vv + f2 * u.v * u.v, f1 * u.vm + f2 * u.v * u.m, f1 * u.mm + f2 * u.m * u.m,
    )  # fmt: skip


@part
def negative(u):
    """-u."""
    return scaled(u, -1.0)


@part
def scaled(u, x):
    """u times a number."""
    return Jet(
        x * u.value, x * u.l, x * u.v, x * u.m, x * u.ll, x * u.lv, x * u.lm, x * u.vv, x * u.vm, x * u.mm
    )


@part
def shifted(u, x):
    """u plus a number."""
    return Jet(u.value + x, u.l, u.v, u.m, u.ll, u.lv, u.lm, u.vv, u.vm, u.mm)


@part
def add(u, w):
    """u + w."""
    return Jet(
        u.value + w.value, u.l + w.l, u.v + w.v, u.m + w.m,
        u.ll + w.ll, u.lv + w.lv, u.lm + w.lm, u.vv + w.vv, u.vm + w.vm, u.mm + w.mm,
    )  # fmt: skip


@part
def subtract(u, w):
    """u - w."""
    return Jet(
        u.value - w.value, u.l - w.l, u.v - w.v, u.m - w.m,
        u.ll - w.ll, u.lv - w.lv, u.lm - w.lm, u.vv - w.vv, u.vm - w.vm, u.mm - w.mm,
    )  # fmt: skip


@part
def multiply(u, w):
    """u w."""
    a, b = u.value, w.value
    return Jet(
        a * b, a * w.l + b * u.l, a * w.v + b * u.v, a * w.m + b * u.m,
        a * w.ll + b * u.ll + 2.0 * u.l * w.l,
        a * w.lv + b * u.lv + u.l * w.v + u.v * w.l,
        a * w.lm + b * u.lm + u.l * w.m + u.m * w.l,
        a * w.vv + b * u.vv + 2.0 * u.v * w.v,
        a * w.vm + b * u.vm + u.v * w.m + u.m * w.v,
        a * w.mm + b * u.mm + 2.0 * u.m * w.m,
    )  # fmt: skip


@part
def reciprocal(u):
    """1 / u."""
    r = 1.0 / u.value
    return chain(u, r, -r * r, 2.0 * r * r * r)


@part
def divide(u, w):
    """u / w."""
    return multiply(u, reciprocal(w))


@part
def square(u):
    """u^2."""
    return chain(u, u.value * u.value, 2.0 * u.value, 2.0)


@part
def power(u, n):
    """u^n for a number n; a derivative whose factor is zero is zero, also where u is."""
    x = u.value
    f1 = n * x ** (n - 1.0) if n != 0.0 else 0.0
    f2 = n * (n - 1.0) * x ** (n - 2.0) if n != 0.0 and n != 1.0 else 0.0
    return chain(u, x**n, f1, f2)


@part
def exponential(u):
    """exp(u)."""
    f = math.exp(u.value)
    return chain(u, f, f, f)


@part
def logarithm(u):
    """log(u), not a number below zero."""
    x = u.value
    return chain(u, np.log(x), 1.0 / x, -1.0 / (x * x))


@part
def raised(u, w):
    """u^w of two jets, or of a number that `constant` has made one."""
    return exponential(multiply(w, logarithm(u)))


@part
def sqrt(u):
    """Square root, not a number below zero."""
    f = np.sqrt(u.value)
    return chain(u, f, 0.5 / f, -0.25 / (f * u.value))


@part
def expm1(u):
    """exp(u) - 1."""
    f = math.exp(u.value)
    return chain(u, math.expm1(u.value), f, f)


@part
def log1p(u):
    """log(1 + u)."""
    r = 1.0 / (1.0 + u.value)
    return chain(u, np.log1p(u.value), r, -r * r)


@part
def sin(u):
    """Sine."""
    s, c = math.sin(u.value), math.cos(u.value)
    return chain(u, s, c, -s)


@part
def cos(u):
    """Cosine."""
    s, c = math.sin(u.value), math.cos(u.value)
    return chain(u, c, -s, -c)


@part
def tan(u):
    """Tangent."""
    t = math.tan(u.value)
    f1 = 1.0 + t * t
    return chain(u, t, f1, 2.0 * t * f1)


@part
def asin(u):
    """Arc sine."""
    x = u.value
    f1 = 1.0 / np.sqrt(1.0 - x * x)
    return chain(u, np.arcsin(x), f1, x * f1**3)


@part
def acos(u):
    """Arc cosine."""
    return shifted(negative(asin(u)), 0.5 * math.pi)


@part
def atan(u):
    """Arc tangent."""
    x = u.value
    f1 = 1.0 / (1.0 + x * x)
    return chain(u, math.atan(x), f1, -2.0 * x * f1 * f1)


@part
def atan2(u, w):
    """Angle of the point (w, u)."""
    steep = abs(u.value) > abs(w.value)
    found = negative(atan(divide(w, u))) if steep else atan(divide(u, w))
    return shifted(found, math.atan2(u.value, w.value) - found.value)


@part
def hypot(u, w):
    """Root of the sum of squares."""
    return sqrt(add(square(u), square(w)))


@part
def sinh(u):
    """Hyperbolic sine."""
    s, c = math.sinh(u.value), math.cosh(u.value)
    return chain(u, s, c, s)


@part
def cosh(u):
    """Hyperbolic cosine."""
    s, c = math.sinh(u.value), math.cosh(u.value)
    return chain(u, c, s, c)


@part
def tanh(u):
    """Hyperbolic tangent."""
    t = math.tanh(u.value)
    f1 = 1.0 - t * t
    return chain(u, t, f1, -2.0 * t * f1)


@part
def absolute(u):
    """|u|, of which the derivative at zero is that from above."""
    return negative(u) if u.value < 0.0 else u


@part
def smaller(u, w):
    """The lesser of two; the first where they are equal."""
    return w if w.value < u.value else u


@part
def larger(u, w):
    """The greater of two; the first where they are equal."""
    return w if w.value > u.value else u


# Functions of numpy, math and Python, and the same for jets.
FUNCTIONS: dict[Any, Callable] = {
    np.square: square, np.sqrt: sqrt, math.sqrt: sqrt, np.abs: absolute, abs: absolute, math.fabs: absolute,
    np.exp: exponential, math.exp: exponential, np.log: logarithm, math.log: logarithm,
    np.expm1: expm1, math.expm1: expm1, np.log1p: log1p, math.log1p: log1p, np.sin: sin, math.sin: sin,
    np.cos: cos, math.cos: cos, np.tan: tan, math.tan: tan, np.arcsin: asin, math.asin: asin,
    np.arccos: acos, math.acos: acos, np.arctan: atan, math.atan: atan, np.arctan2: atan2,
    math.atan2: atan2, np.hypot: hypot, math.hypot: hypot, np.sinh: sinh, math.sinh: sinh, np.cosh: cosh,
    math.cosh: cosh, np.tanh: tanh, math.tanh: tanh, np.minimum: smaller, min: smaller, np.maximum: larger,
    max: larger, np.power: raised, math.pow: raised, np.reciprocal: reciprocal, np.negative: negative,
}  # fmt: skip
