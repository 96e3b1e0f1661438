"""The model's energy with the plates on which its end turns rest: nodes against a rigid plane at each end.

The bottom plate is fixed, the top one moves and turns with the top end. With the normal n of a plate, its
reference point X and the vector w = X - x from a node, the gap is ``g = n . w - c``, where c makes it zero at
rest for nodes of the end turns, whose undersides are ground flat. The potential is 1/2 k g^2 where g <= 0:
plates push and do not pull, and the wire slides on them. With n = exp(phi) n along the exponential map

    dg = n . (dX - dx) + phi . (n x w)
    d2g = 2 phi . (n x (dX - dx)) + (phi . n)(phi . w) - (n . w) phi . phi
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from coilspring.compiling.compiled import kernel, part
from coilspring.compiling.packing import heads, vector
from wirefe import kernels
from wirefe.contact.plates import PlateArrays
from wirefe.contact.spheres import lever
from wirefe.element.algebra import put
from wirefe.element.poses import ROW, four, three
from wirefe.element.quaternions import turned
from wirefe.model import PLATES


@part
def _view(reals, ints):
    head = heads(ints)[PLATES:]
    return PlateArrays(
        vector(ints, head[0]), vector(reals, head[1]), vector(ints, head[2]), vector(reals, head[3]),
        vector(reals, head[4]), reals[head[5, 0]], vector(ints, head[6]), vector(ints, head[7]),
    )  # fmt: skip


class Gap(NamedTuple):
    """Derivatives of the gap between a node and the top plate."""

    n: Any  # (3,) normal of the plate
    a: Any  # (6,) gradient at the node
    b: Any  # (6,) and at the top end
    C: Any  # (3, 3) second derivative in the spin of the top end


@part
def _press_low(plates, state, g, H):
    """Potential of the bottom plate; adds its gradient and Hessian."""
    energy, k = 0.0, plates.stiffness
    for m in range(plates.low.size):
        node = plates.low[m]
        gap = state[ROW * node + 1] - plates.level[m]
        if gap > 0.0:
            continue
        energy += 0.5 * k * gap * gap
        g[6 * node + 1] += k * gap
        if len(H) > 0:
            H[node, 1, 1] += k
    return energy


@part
def _press_high(plates, state, g, H):
    """Potential of the top plate; adds its gradient and Hessian."""
    energy, k = 0.0, plates.stiffness
    n, w, a, b, C = np.empty(3), np.empty(3), np.zeros(6), np.empty(6), np.empty((3, 3))
    top = state.size // ROW - 1
    n[0], n[1], n[2] = turned(four(state, ROW * top + 3), (0.0, 1.0, 0.0))
    for m in range(plates.high.size):
        node = plates.high[m]
        gap = -plates.depth[m]
        for i in range(3):
            w[i] = state[ROW * top + i] - state[ROW * node + i]
            gap += n[i] * w[i]
        if gap > 0.0:
            continue
        energy += 0.5 * k * gap * gap
        for i in range(3):
            j, l = (i + 1) % 3, (i + 2) % 3  # noqa: E741
            a[i] = -n[i]
            b[i] = n[i] * plates.free[i]
            b[3 + i] = (n[j] * w[l] - n[l] * w[j]) * plates.free[3 + i]
        for i in range(6):
            g[6 * node + i] += k * gap * a[i]
            g[6 * top + i] += k * gap * b[i]
        if len(H) > 0:
            put(C, 0, 0, lever(three(n, 0), three(w, 0)))
            _add_hessian(plates, m, top, k * gap, Gap(n, a, b, C), H)
    return energy


@part
def _add_hessian(plates, m, top, force, gap, H):
    """k dg dg^T + force d2g of the node m of the top plate."""
    node, free, k, (n, a, b, C) = plates.high[m], plates.free, plates.stiffness, gap
    B, flip = H[plates.block[m]], plates.flip[m]
    for i in range(6):
        for j in range(6):
            H[node, i, j] += k * a[i] * a[j]
            H[top, i, j] += k * b[i] * b[j]
            if flip:
                B[i, j] += k * a[i] * b[j]
            else:
                B[i, j] += k * b[i] * a[j]
    for i in range(3):
        for j in range(3):
            H[top, 3 + i, 3 + j] += force * C[i, j] * free[3 + i] * free[3 + j]
        j, l = (i + 1) % 3, (i + 2) % 3  # noqa: E741
        for axis, sign, nl in ((j, -1.0, n[l]), (l, 1.0, n[j])):  # phi_i (n_j d_l - n_l d_j)
            value = sign * nl * force * free[3 + i]
            H[top, 3 + i, axis] += value * free[axis]
            H[top, axis, 3 + i] += value * free[axis]
            if flip:
                B[axis, 3 + i] -= value
            else:
                B[3 + i, axis] -= value


@kernel
def assemble(reals, ints, accepted, least_gap, history, state, g, H):
    """`wirefe.kernels.assemble`, and the plates."""
    energy, pairs = kernels.assemble(reals, ints, accepted, least_gap, history, state, g, H)
    plates = _view(reals, ints)
    blocks = H.reshape((H.size // 36, 6, 6))
    energy += _press_low(plates, state, g, blocks) + _press_high(plates, state, g, blocks)
    return energy, pairs + plates.low.size + plates.high.size


@kernel
def update_history(reals, ints, state, history):
    """`wirefe.kernels.update_history`; contact with the plates may change at any time."""
    return min(kernels.update_history(reals, ints, state, history), 0.0)
