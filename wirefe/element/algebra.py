"""Vectors (3) and matrices (9, by rows) as tuples: they stay in registers, and compile fast."""

from coilspring.compiling.compiled import arithmetic


@arithmetic
def dot(a, b):
    """a . b."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


@arithmetic
def cross(a, b):
    """a x b."""
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@arithmetic
def plus(a, factor, b):
    """a + factor b of vectors."""
    return a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]


@arithmetic
def mixed(x, a, y, b):
    """x a + y b of vectors."""
    return x * a[0] + y * b[0], x * a[1] + y * b[1], x * a[2] + y * b[2]


@arithmetic
def skew(a, factor):
    """factor [a], the matrix of the cross product a x."""
    x, y, z = factor * a[0], factor * a[1], factor * a[2]
    return 0.0, -z, y, z, 0.0, -x, -y, x, 0.0


@arithmetic
def outer(x, a, b):
    """x a b^T."""
    u, v, w = x * a[0], x * a[1], x * a[2]
    return (
        u * b[0], u * b[1], u * b[2],
        v * b[0], v * b[1], v * b[2],
        w * b[0], w * b[1], w * b[2],
    )  # fmt: skip


@arithmetic
def added(A, factor, B):
    """A + factor B."""
    return (
        A[0] + factor * B[0], A[1] + factor * B[1], A[2] + factor * B[2],
        A[3] + factor * B[3], A[4] + factor * B[4], A[5] + factor * B[5],
        A[6] + factor * B[6], A[7] + factor * B[7], A[8] + factor * B[8],
    )  # fmt: skip


@arithmetic
def scaled(x, A):
    """x A."""
    return x * A[0], x * A[1], x * A[2], x * A[3], x * A[4], x * A[5], x * A[6], x * A[7], x * A[8]


@arithmetic
def diagonal(A, x):
    """A + x I."""
    return A[0] + x, A[1], A[2], A[3], A[4] + x, A[5], A[6], A[7], A[8] + x


@arithmetic
def transposed(A):
    """A^T."""
    return A[0], A[3], A[6], A[1], A[4], A[7], A[2], A[5], A[8]


@arithmetic
def applied(A, v):
    """A v."""
    return (
        A[0] * v[0] + A[1] * v[1] + A[2] * v[2],
        A[3] * v[0] + A[4] * v[1] + A[5] * v[2],
        A[6] * v[0] + A[7] * v[1] + A[8] * v[2],
    )


@arithmetic
def product(A, B):
    """A B, column by column."""
    x = applied(A, (B[0], B[3], B[6]))
    y = applied(A, (B[1], B[4], B[7]))
    z = applied(A, (B[2], B[5], B[8]))
    return x[0], y[0], z[0], x[1], y[1], z[1], x[2], y[2], z[2]


@arithmetic
def lever(f, r):
    """Second derivative of f . exp(phi) r in the spin phi: 1/2 (f r^T + r f^T) - (f . r) I."""
    return diagonal(added(outer(0.5, f, r), 1.0, outer(0.5, r, f)), -dot(f, r))


@arithmetic
def block(K, i, j):
    """The matrix whose first entry is K[i, j]."""
    return (
        K[i, j], K[i, j + 1], K[i, j + 2],
        K[i + 1, j], K[i + 1, j + 1], K[i + 1, j + 2],
        K[i + 2, j], K[i + 2, j + 1], K[i + 2, j + 2],
    )  # fmt: skip


@arithmetic
def put(K, i, j, A):
    """Write A into K, and its transpose into the mirrored place; on the diagonal A must be symmetric."""
    K[i, j], K[i, j + 1], K[i, j + 2] = A[0], A[1], A[2]
    K[i + 1, j], K[i + 1, j + 1], K[i + 1, j + 2] = A[3], A[4], A[5]
    K[i + 2, j], K[i + 2, j + 1], K[i + 2, j + 2] = A[6], A[7], A[8]
    K[j, i], K[j + 1, i], K[j + 2, i] = A[0], A[1], A[2]
    K[j, i + 1], K[j + 1, i + 1], K[j + 2, i + 1] = A[3], A[4], A[5]
    K[j, i + 2], K[j + 1, i + 2], K[j + 2, i + 2] = A[6], A[7], A[8]
