"""The kernels of `wirefe.kernels` that differ where end turns rest on plates."""

from coilspring.compiling.compiled import kernel, shaped
from wirefe import kernels
from wirefe.contact.plates import press_high, press_low
from wirefe.model import view_plates


@kernel
def assemble(reals, ints, accepted, least_gap, history, state, g, H):
    """`wirefe.kernels.assemble`, and the plates."""
    energy, pairs = kernels.assemble(reals, ints, accepted, least_gap, history, state, g, H)
    plates = view_plates(reals, ints)
    blocks = shaped(H, (H.size // 36, 6, 6))
    energy += press_low(plates, state, g, blocks) + press_high(plates, state, g, blocks)
    return energy, pairs + plates.low.size + plates.high.size


@kernel
def update_history(reals, ints, state, history):
    """`wirefe.kernels.update_history`; contact with the plates may change at any time."""
    return min(kernels.update_history(reals, ints, state, history), 0.0)
