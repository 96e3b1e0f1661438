"""Products of small vectors and matrices, written out for the compiled kernels."""

from __future__ import annotations

from coilspring.compiled import arithmetic


@arithmetic
def skew(a, factor, S):
    """S = factor [a], the matrix of the cross product a x."""
    x, y, z = factor * a[0], factor * a[1], factor * a[2]
    S[0, 0], S[0, 1], S[0, 2] = 0.0, -z, y
    S[1, 0], S[1, 1], S[1, 2] = z, 0.0, -x
    S[2, 0], S[2, 1], S[2, 2] = -y, x, 0.0


@arithmetic
def cross(a, b, c):
    """c = a x b."""
    c[0] = a[1] * b[2] - a[2] * b[1]
    c[1] = a[2] * b[0] - a[0] * b[2]
    c[2] = a[0] * b[1] - a[1] * b[0]


@arithmetic
def product(A, B, C):
    """C = A B for 3 x 3 matrices; C may be A or B. Read first, then write: twice as fast."""
    b00, b01, b02 = B[0, 0], B[0, 1], B[0, 2]
    b10, b11, b12 = B[1, 0], B[1, 1], B[1, 2]
    b20, b21, b22 = B[2, 0], B[2, 1], B[2, 2]
    for i in range(3):
        x, y, z = A[i, 0], A[i, 1], A[i, 2]
        C[i, 0] = x * b00 + y * b10 + z * b20
        C[i, 1] = x * b01 + y * b11 + z * b21
        C[i, 2] = x * b02 + y * b12 + z * b22


@arithmetic
def turned(M, Mt, A):
    """A becomes M A M^T; `Mt` is the transpose of M."""
    product(A, Mt, A)
    product(M, A, A)
