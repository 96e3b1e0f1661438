"""How the gap and the tangential length of a pair change as it moves: exactly, at a state."""

import math

from coilspring.compiling.compiled import inlined
from coilspring.contact.law import arc, stretch

GAP_RATE, LENGTH_RATE = 0, 1  # columns


@inlined
def length_gradient(g, h, row, law, t):
    """Length by which a held pair is stretched or slid, and in `t` its derivative by the vector g (h long)
    between the centres; zero where the length is."""
    if row.bound == math.inf and not row.grazes:
        length = stretch(g, row, t)
        factor = 1.0 / length if length > 0.0 else 0.0
    else:
        length, factor = law.d * arc(g, h, row, t), law.d / h
    for i in range(3):
        t[i] *= factor
    return length


@inlined
def pair_rate(g, dg, row, law, t, rate):
    """Fill the rates of a pair's gap and tangential length as its vector g changes by dg; `t` is scratch.

    A length of zero grows whichever way the pair moves across g.
    """
    h, along, square, rate[LENGTH_RATE] = math.sqrt(g[0] ** 2 + g[1] ** 2 + g[2] ** 2), 0.0, 0.0, 0.0
    for i in range(3):
        along += g[i] * dg[i] / h
    rate[GAP_RATE] = along
    if not row.closed:
        return
    if length_gradient(g, h, row, law, t) > 0.0:
        for i in range(3):
            rate[LENGTH_RATE] += t[i] * dg[i]
        return
    for i in range(3):
        square += (dg[i] - along * g[i] / h) ** 2
    rate[LENGTH_RATE] = math.sqrt(square)
