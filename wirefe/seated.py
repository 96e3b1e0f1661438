"""The kernels of `wirefe.kernels` that differ where end turns rest on plates."""

from coilspring.compiling.compiled import kernel, shaped
from wirefe import kernels
from wirefe.contact.pressing import fill_loads, press
from wirefe.model import view_elements, view_held, view_plates


@kernel
def assemble(reals, ints, accepted, least_gap, history, state, g, H):
    """`wirefe.kernels.assemble`, and the plates."""
    energy, pairs = kernels.assemble(reals, ints, accepted, least_gap, history, state, g, H)
    plates, blocks = view_plates(reals, ints), shaped(H, (H.size // 36, 6, 6))
    energy += press(plates, view_elements(reals, ints), state, g, blocks)
    kernels.hold(view_held(ints), g, blocks)
    return energy, pairs + plates.node.size


@kernel
def plate_loads(reals, ints, states, loads):
    """Fill forces and moments of the plates on both nodes of each border, (states, borders, 12), N, N mm."""
    plates = view_plates(reals, ints)
    for n in range(len(states)):
        fill_loads(plates, states[n], loads[n])


@kernel
def update_history(reals, ints, state, history):
    """`wirefe.kernels.update_history`; contact with the plates may change at any time."""
    return min(kernels.update_history(reals, ints, state, history), 0.0)
