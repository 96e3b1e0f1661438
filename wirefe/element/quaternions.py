"""Unit quaternions (w, x, y, z) and vectors as tuples, which stay in registers."""

from __future__ import annotations

import math

from coilspring.compiling.compiled import arithmetic


@arithmetic
def times(p, q):
    """Hamilton product p q: first the rotation q, then p."""
    return (
        p[0] * q[0] - p[1] * q[1] - p[2] * q[2] - p[3] * q[3],
        p[0] * q[1] + p[1] * q[0] + p[2] * q[3] - p[3] * q[2],
        p[0] * q[2] - p[1] * q[3] + p[2] * q[0] + p[3] * q[1],
        p[0] * q[3] + p[1] * q[2] - p[2] * q[1] + p[3] * q[0],
    )


@arithmetic
def conjugate(q):
    """The inverse rotation."""
    return q[0], -q[1], -q[2], -q[3]


@arithmetic
def unit(w, x, y, z):
    """The quaternion of length 1."""
    size = 1.0 / math.sqrt(w * w + x * x + y * y + z * z)
    return size * w, size * x, size * y, size * z


@arithmetic
def half_way(p, q):
    """The rotation half way from p to q, the shorter way, and q with the sign of that way."""
    if p[0] * q[0] + p[1] * q[1] + p[2] * q[2] + p[3] * q[3] < 0.0:
        q = (-q[0], -q[1], -q[2], -q[3])
    return unit(p[0] + q[0], p[1] + q[1], p[2] + q[2], p[3] + q[3]), q


@arithmetic
def turned(q, v):
    """Vector v turned by q."""
    tx = 2.0 * (q[2] * v[2] - q[3] * v[1])
    ty = 2.0 * (q[3] * v[0] - q[1] * v[2])
    tz = 2.0 * (q[1] * v[1] - q[2] * v[0])
    return (
        v[0] + q[0] * tx + q[2] * tz - q[3] * ty,
        v[1] + q[0] * ty + q[3] * tx - q[1] * tz,
        v[2] + q[0] * tz + q[1] * ty - q[2] * tx,
    )


@arithmetic
def small_turn(v, share):
    """Nearly the rotation by the vector ``share * v``, to the third order."""
    half = 0.5 * share
    return unit(1.0, half * v[0], half * v[1], half * v[2])


@arithmetic
def rotation_vector(q):
    """Rotation vector of the shorter way."""
    sign = 1.0 if q[0] >= 0.0 else -1.0
    sine = math.sqrt(q[1] * q[1] + q[2] * q[2] + q[3] * q[3])
    share = sign * (2.0 * math.atan2(sine, sign * q[0]) / sine if sine > 0.0 else 2.0)
    return share * q[1], share * q[2], share * q[3]


@arithmetic
def exponential(v):
    """Quaternion of the rotation vector v."""
    angle = math.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    share = math.sin(0.5 * angle) / angle if angle > 0.0 else 0.5
    return math.cos(0.5 * angle), share * v[0], share * v[1], share * v[2]


@arithmetic
def matrix(q):
    """Matrix of the unit quaternion q, by rows."""
    w, x, y, z = q
    return (
        1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y),
        2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x),
        2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y),
    )  # fmt: skip
