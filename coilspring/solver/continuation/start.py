"""Where a path starts: its tangent and least stiffness, and what later numbers are compared with."""

import numpy as np

from coilspring.compiling.compiled import copy, part
from coilspring.contact.kinematics import TOUCH
from coilspring.contact.transitions import grazing_depth
from coilspring.solver.continuation.stability import SETTLED, begin_watch, least_stiffness
from coilspring.solver.continuation.substep import free_room
from coilspring.solver.equilibrium.operations import assembled, factored, solution
from coilspring.solver.system import CHANGE, COMPLETED, CRITICAL, NEW_PAIR

FIRST_STEP = 0.1  # largest first substep: the tangent at rest knows nothing of the contact to come
EPSILON = 2.0**-52


@part
def begin(system, task, work, path):
    """State, tangent and least stiffness at the start, and the first substep."""
    copy(task.start, work.state)
    copy(task.start, work.trial)
    copy(task.start, work.before)
    copy(task.start, work.origin)
    path.last_step, work.old[0] = 1.0, np.inf  # no state before, no turn known
    path.next_step, path.until, path.opens = min(task.times[0], FIRST_STEP), np.inf, np.inf
    path.release.active, path.release.power, path.release.last, path.stretch.begin = False, 0.0, 0.0, 0.0
    path.release.gradual, path.release.sudden = -np.inf, -np.inf
    path.friction.turned, path.snap.until = -np.inf, -np.inf
    path.undecided = np.inf
    path.least_gap = system.update_history(system.reals, system.ints, work.state, work.history)
    path.outcome = NEW_PAIR if path.least_gap == -np.inf else COMPLETED
    factor_start(system, task, work, path)
    set_scales(system, task, work, path)
    softest, room = path.softest, path.room
    begin_watch(softest, least_stiffness(system, task, work, np.inf, SETTLED), 0.0)
    path.scale.stiffness = softest.value
    if path.least_gap <= TOUCH * task.diameter:
        # what touches at rest is no part of the tangent, nor of the stiffness
        path.fresh = 2
    room.value, room.time, room.zero = np.inf, 0.0, np.inf
    if work.history.shape[0] > 0:
        room.value = free_room(system, task, work.state)


@part
def factor_start(system, task, work, path):
    """Matrix at the start, its factor, and the tangent."""
    _, pairs = assembled(system, work.state, path.least_gap, work.history, work.state, work.g, work.rest)
    path.pairs += pairs
    copy(work.rest, work.F)
    copy(work.state, work.factored_at)
    negative, path.scale.least_pivot = factored(system, work.F)
    path.spent += 1
    path.reuse = True
    if negative > 0:
        path.outcome = CRITICAL
    solution(system, work.F, task.load, 1.0, work.tangent)


@part
def resume(system, task, work, path):
    """Go on from the last accepted state with pairs that are new: the matrix has other places."""
    assembled(system, task.start, np.inf, work.history, task.start, work.g, work.rest)
    copy(work.rest, work.F)
    _, path.scale.least_pivot = factored(system, work.F)  # in another order of elimination
    path.spent += 1
    path.least_gap = system.update_history(system.reals, system.ints, work.state, work.history)
    path.reuse, path.outcome = False, COMPLETED


@part
def set_scales(system, task, work, path):
    """Work of the whole load along the tangent at rest, and what rounding makes of the potential: the
    rounding of positions times a force."""
    load, dead, tangent = task.load, task.dead, work.tangent
    change = system.prescribed[CHANGE] if system.prescribed.size > 0 else 0.0
    reference, force, standing = 0.0, 0.0, 0.0
    for i in range(load.size):
        force += abs(load[i])
        standing += abs(dead[i])
        if change == 0.0:
            reference += load[i] * tangent[i]
        elif load[i] != 0.0:
            # the load that fixes the top less the tangent's last digits, in which the reaction is
            reference += load[i] * (change - tangent[i])
    scale = path.scale
    scale.reference, scale.rounding, scale.dead = reference, 2.0 * EPSILON * task.span, standing
    scale.force = force if change == 0.0 else abs(reference / change)
    scale.pressed = grazing_depth(scale.force + standing, task.diameter, task.penalty, task.exponent)
