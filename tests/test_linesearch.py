"""A step shortened to the least potential along it, on potentials of one number."""

from types import SimpleNamespace

import numpy as np
import pytest

from coilspring.solver.equilibrium.linesearch import FLAT, line_search, whole_step


def searched(energy, slope_at):
    """Length, and number of evaluations, of a search along a step of 1 from 0, where the slope is -1."""
    count = []

    def assemble(reals, ints, accepted, least_gap, history, state, g, H):
        count.append(state[0])
        g[0] = slope_at(state[0])
        return energy(state[0]), 1

    def retract(reals, ints, state, step, factor, base, least, out):
        out[0] = state[0] + factor * step[0]

    nothing = np.zeros(0)
    system = SimpleNamespace(
        reals=nothing, ints=nothing, prescribed=nothing, assemble=assemble, retract=retract,
        work=lambda *_: 0.0,
    )  # fmt: skip
    target = SimpleNamespace(accepted=None, least_gap=0.0, history=None, load=np.zeros(1), modified=True)
    work = SimpleNamespace(H=nothing, g=np.array([slope_at(1.0)]), step=np.ones(1), scratch=np.zeros(1))
    it = SimpleNamespace(slope=-1.0, energy=energy(0.0), noise=0.0, pairs=0, near=1)
    gain = energy(1.0) - energy(0.0)
    return line_search(system, target, work, np.zeros(1), it, gain), len(count)


@pytest.mark.parametrize("kink", [1e-2, 5e-4, 1e-6])
def test_slope_that_jumps_is_found(kink):
    """Before it the potential falls evenly, behind it rises as if from another place: no line through the
    slopes tells where."""
    length, count = searched(
        lambda x: -x if x < kink else -kink + 0.5 * (x + kink) ** 2 - 2.0 * kink**2,
        lambda x: -1.0 if x < kink else x + kink,
    )
    assert kink <= length <= FLAT
    assert count <= 12


def test_smooth_potential_takes_few_evaluations():
    length, count = searched(lambda x: -x + 2.0 * x**2, lambda x: -1.0 + 4.0 * x)
    assert abs(-1.0 + 4.0 * length) <= FLAT
    assert count <= 2


@pytest.mark.parametrize(("left", "taken"), [(0.9, False), (0.1, True)])
def test_a_fall_lost_in_rounding_is_judged_by_the_slope(left, taken):
    """The slope promises a little more than rounding; what was gained is less. Hard pairs of a beam pressed
    solid opened and closed for ever by such steps, each of which seemed to gain."""
    energy, slope = 7.0, -1.2e-12
    work = SimpleNamespace(g=np.array([left * slope]), step=np.ones(1))
    it = SimpleNamespace(slope=slope, noise=5e-14)
    assert whole_step(work, it, energy, gain=-2e-13) == taken
    assert whole_step(work, it, energy, gain=-2e-12)
    assert not whole_step(work, it, energy, gain=2e-12)
