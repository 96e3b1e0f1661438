"""Finite rotations: unit quaternions (w, x, y, z), and the functions of the rotation angle.

In kernels quaternions and vectors are tuples, which stay in registers.
"""

import math

import numpy as np

from coilspring.compiling.compiled import arithmetic

# a / sin a = 1 + sum c_k q^(k+1) with a = theta/2, q = theta^2: c(q) = (a / sin a - 1) / q
_SERIES = (
    1.0 / 24.0,
    7.0 / 5760.0,
    31.0 / 967680.0,
    127.0 / 154828800.0,
    73.0 / 3503554560.0,
    1414477.0 / (653837184000.0 * 4096.0),
    8191.0 / (37362124800.0 * 16384.0),
)
SMALL_ANGLE_SQUARED = 0.25  # below, closed forms lose digits; the series' next term is below 1e-16


@arithmetic
def stretch_functions(q, a, sin_a, cos_a):
    """alpha = a / sin a and c = (alpha - 1)/q with derivatives in q = theta^2, where a = theta/2.

    Returns c, c', c'', tau, tau' with tau = tan(theta/4)/theta.
    """
    if q < SMALL_ANGLE_SQUARED:
        c0 = c1 = c2 = 0.0
        for k in range(len(_SERIES) - 1, -1, -1):
            c2 = c2 * q + 2.0 * c1
            c1 = c1 * q + c0
            c0 = c0 * q + _SERIES[k]
        b = 0.25 * q
        third = 1.0 / 6.0 - b * (1.0 / 120.0 - b * (1.0 / 5040.0 - b * (1.0 / 362880.0 - b / 39916800.0)))
        return c0, c1, c2, *_quarter(a, sin_a, cos_a, third)
    alpha = a / sin_a
    d1 = (sin_a - a * cos_a) / sin_a**2
    d2 = (a * sin_a**2 - 2.0 * cos_a * (sin_a - a * cos_a)) / sin_a**3
    e = 8.0 * a  # dq/da
    alpha1 = d1 / e
    alpha2 = (d2 / e - d1 / (e * a)) / e
    c0 = (alpha - 1.0) / q
    c1 = (alpha1 - c0) / q
    c2 = (alpha2 - 2.0 * c1) / q
    return c0, c1, c2, *_quarter(a, sin_a, cos_a, (a - sin_a) / a**3)


@arithmetic
def _quarter(a, sin_a, cos_a, third):
    """tau = tan(a/2)/(2 a) and its derivative in q = 4 a^2, with third = (a - sin a)/a^3."""
    ratio = sin_a / a if a > 0.0 else 1.0
    return ratio / (2.0 * (1.0 + cos_a)), third / (16.0 * (1.0 + cos_a))


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


def cross_rows(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Vector products a x b, shapes (..., 3): those of `np.cross` in a third of its time."""
    out = np.empty(np.broadcast_shapes(a.shape, b.shape))
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        out[..., i] = a[..., j] * b[..., k]
        out[..., i] -= a[..., k] * b[..., j]
    return out


def quaternion_from_matrix(R: np.ndarray) -> np.ndarray:
    """Unit quaternions of rotation matrices, shape (..., 3, 3) -> (..., 4), with w >= 0."""
    products = np.empty((*R.shape[:-2], 4, 4))  # of all components, times 4
    trace = R[..., 0, 0] + R[..., 1, 1] + R[..., 2, 2]
    products[..., 0, 0] = 1.0 + trace
    for i, (j, k) in enumerate(((1, 2), (2, 0), (0, 1))):
        products[..., i + 1, i + 1] = 1.0 + 2.0 * R[..., i, i] - trace
        products[..., 0, i + 1] = products[..., i + 1, 0] = R[..., k, j] - R[..., j, k]
        products[..., j + 1, k + 1] = products[..., k + 1, j + 1] = R[..., j, k] + R[..., k, j]
    # the row of the largest component loses no digits
    largest = np.argmax(np.diagonal(products, axis1=-2, axis2=-1), axis=-1)
    q = np.take_along_axis(products, largest[..., None, None], axis=-2)[..., 0, :]
    return q * (np.where(q[..., :1] < 0.0, -1.0, 1.0) / np.linalg.norm(q, axis=-1, keepdims=True))
