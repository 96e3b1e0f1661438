"""One substep: the equilibria from its prediction on, and whether the one found continues the branch."""

import numpy as np

from coilspring.compiling.compiled import copy, part
from coilspring.contact.history import (
    barely_pressed,
    begin_attempt,
    copy_history,
    grazing,
    has_friction,
    has_history,
    keep_bounds,
    located,
    release,
    slides,
    stick,
    stuck_from,
)
from coilspring.contact.kinematics import OVERLAP_ALLOWED
from coilspring.contact.law import tangential_stiffness
from coilspring.contact.transitions import OPEN
from coilspring.solver.continuation import snap
from coilspring.solver.continuation.branch import (
    LEAST_TURN,
    SMALL_TURN,
    continues,
    displacement_bound,
    jumped,
    most_turn,
    small_turn,
)
from coilspring.solver.continuation.stability import LEAST_STEP, WEAK
from coilspring.solver.equilibrium.newton import CONVERGED, FAILED, LINEAR, NONE, SADDLE
from coilspring.solver.equilibrium.operations import (
    assembled,
    factored,
    moved,
    put_prescribed,
    stale_solution,
)
from coilspring.solver.system import OVERLAP, Target
from coilspring.solver.tangential.friction import let_flow, slides_stably, solve_bounds
from coilspring.solver.tangential.grazing import update_grazing

# Powers of two by which the tangential stiffness of opening pairs is lowered: all of it beyond the largest;
# where the least finds no place nearby, the path jumps.
MOST_RELEASE, LEAST_RELEASE = 40.0, 1e-3
LEAST_PRECISION = 1e-5  # of the decrement that is asked for, where little is left of the stiffness
LEAST_CUT, MOST_CUT = 0.05, 0.9  # shares at which a substep is cut where a pair touches or opens
NEARER = 3.0  # times the bound on all motion: so much nearer may two wires come, also between nodes
GRAZING_CUT = 0.5  # share at which a substep in which a pair ceases to graze is cut, at most
MISSED = 5e-4  # wire diameters that such a pair may have slipped before
OVERLAP_TIME = 1e-5  # of the time 0..1: so closely is it located
LEAST_RATED = 1e-3  # of the time 0..1: in less a path with friction, or sticking, may turn as any other
BOUND_CHANGE = 1e-6  # of the bounds of tangential forces, over the largest, where they count as found
MOST_ROUNDS = 30
FIRST_SHIFT = 0.1  # with which an indefinite matrix is made positive, in units of that at rest
MOST_DAMPED = 25  # iterations that went through an indefinite matrix: more lead away from the branch
SHORT = 10.0  # times the way after which that is refused: one predicted to be longer does not end within it
SLOW, GAIN = 3, 0.5  # rounds of Newton's method that leave more than this share lead nowhere
RENEWED = 3  # times that bounds are just renewed, before Newton's method is worth its back substitutions


@part
def find_equilibrium(system, equilibrium, task, work, path, substep, it):
    """Equilibria for given bounds of the tangential forces, until these are those of the normal forces."""
    # where friction has just begun it holds next to nothing: the prediction slides where the state sticks
    copy(work.state if path.lost and has_friction(work.history) else work.predicted, work.trial)
    load, growing, dead = work.load, task.load, task.dead
    time = 0.0 if system.prescribed.size > 0 else substep.target
    for i in range(load.size):
        load[i] = dead[i] + time * growing[i]
    put_prescribed(system, task.start, substep.target, work.trial)
    scale = path.scale
    loaded = scale.dead + scale.force * substep.target
    # so that along a soft mode, too, states are found as exactly as along a stiff one
    precision = 1.0 if path.snap.active else min(max(substep.left, LEAST_PRECISION), 1.0)
    limit = task.limit * snap.LONGER if path.snap.active else task.limit
    ratio = substep.duration / path.last_step
    begin_attempt(work.history, substep.duration, ratio, work.old[0] == np.inf)
    if path.release.active:
        release(work.history, 2.0**-path.release.power if path.release.power <= MOST_RELEASE else 0.0)
    update_pairs(system, work, work.predicted)
    keep_bounds(work.history)
    if substep.located:
        stick(work.history)
    target = Target(
        work.state, path.least_gap, work.history, work.load, scale.reference * substep.target**2, precision,
        scale.reference * substep.duration**2, scale.rounding * loaded, scale.rounding,
        tangential_stiffness(task.penalty, task.exponent, task.diameter),
        limit, most_damped(system, task, work, path, limit),
        snap.SHIFT if path.snap.active else FIRST_SHIFT, task.modified, scale.least_pivot,
    )  # fmt: skip
    substep.rounds, substep.iterations, substep.trouble, substep.cut = 0, 0, NONE, 1.0
    substep.turned, substep.several, substep.unstable = False, False, False
    substep.damping, change = 1.0, np.inf
    substep.step, substep.worst = 1.0, np.inf
    while True:
        it.reuse = path.reuse
        substep.status = equilibrium(system, target, work, work.trial, it)
        substep.iterations += it.count
        substep.unstable = substep.unstable or it.unstable or substep.status == SADDLE
        substep.trouble, substep.tolerance = max(substep.trouble, it.trouble), max(it.tolerance, it.rounding)
        path.spent += it.count
        path.pairs += it.pairs
        if substep.status == LINEAR and (substep.rounds > 0 or path.release.active):
            substep.status = CONVERGED
        substep.rounds += 1
        copy_history(work.history, work.trial_history)  # with the bounds that this state was found with
        if path.snap.active and substep.status == SADDLE and substep.rounds <= snap.SADDLES:
            snap.leave_saddle(system, task, work)
            path.reuse = False
            continue
        if substep.status > LINEAR:
            break
        change = update_held(system, task, work, path, substep, change)
        if change == 0.0:
            break
        path.reuse = True
        path.tries += 1
    put_prescribed(system, task.start, substep.target, work.trial)
    path.lost = substep.status > LINEAR


@part
def most_damped(system, task, work, path, limit):
    """Iterations through an indefinite matrix, at most: none where what they lead to is refused, see
    `coilspring.solver.continuation.branch.continues`. Contact that remembers may take it, or learn from it
    where a pair touches or opens."""
    if path.snap.active:
        return limit
    if task.located < np.inf or not task.predictor:
        return MOST_DAMPED
    distance, _, _ = displacement_bound(system, work.state, work.predicted, np.inf)
    return 0 if distance > SHORT * LEAST_TURN * task.diameter else MOST_DAMPED


@part
def update_held(system, task, work, path, substep, before):
    """Renew what pairs hold tangentially, after a change in the round `before`.

    Returns the change, 0 where the round was the last one: nothing is left to change, a shorter substep is
    wanted, or the rounds lead nowhere.
    """
    change = update_pairs(system, work, work.trial)
    end = located(work.history)
    if end < 1.0 and can_shorten(path, substep, 2.0 * LEAST_STEP) and not path.snap.active:
        substep.cut = min(max(end, LEAST_CUT), 1.0 if path.release.active else MOST_CUT)
        return 0.0
    left = 0.0
    if grazing(work.history):
        left = update_grazing(system, task, work, substep, path.scale.pressed)
        path.spent += left > 1.0
    stable = True
    if path.snap.active and has_friction(work.history):
        stable = let_flow(system, task, work, substep)
        path.spent += 1
    if change <= BOUND_CHANGE and left <= 1.0 and stable:
        missed = stuck_from(work.history) * substep.duration / path.last_step
        if missed > MISSED * task.diameter and substep.duration >= 2.0 * LEAST_STEP and not path.snap.active:
            substep.cut = max(LEAST_CUT, min(GRAZING_CUT, MISSED * task.diameter / missed))
        return 0.0
    newton = left == 0.0 and substep.rounds > RENEWED and not path.snap.active
    slow = newton and substep.rounds > RENEWED + SLOW and change > GAIN * before
    most = snap.ROUNDS if path.snap.active else MOST_ROUNDS
    if slow or substep.rounds == most or left == np.inf:
        substep.status = FAILED
        return 0.0
    if newton:
        substep.turned = solve_bounds(system, task, work) < 0 or substep.turned
        path.spent += 1
    return change + left


@part
def can_shorten(path, substep, least):
    """Whether the release at hand, or a substep of the `least` duration at least, can be taken shorter."""
    return path.release.power >= 2.0 * LEAST_RELEASE if path.release.active else substep.duration >= least


@part
def update_pairs(system, work, state):
    """Make the contact history that of a state of the substep; returns the change."""
    predicted = work.predicted
    return system.update_pairs(system.reals, system.ints, work.state, predicted, state, work.history)


@part
def keeps_branch(system, task, work, path, substep):
    """Whether the trial state continues the branch; sets the outcome where wires overlap just ahead."""
    if path.lost or substep.cut < 1.0:
        return False
    stiffness, small = path.softest.value, SMALL_TURN * task.diameter
    if stiffness < WEAK * path.scale.stiffness:
        small = small_turn(task, stiffness, substep.tolerance)
    judged = (task.predictor or path.release.active) and not path.snap.active
    good, substep.turn, substep.share, substep.distance, substep.error = continues(
        system, task, work, substep.trouble, judged, small
    )
    at_once = path.release.active and path.release.power == np.inf
    if at_once and barely_pressed(work.history, OPEN * task.diameter):
        substep.several = substep.several or substep.distance > snap.least_told(task, path)
    # so far in no time is a snap too
    snaps = path.snap.active or (substep.duration <= snap.NO_TIME and not path.release.active)
    good = good and (substep.distance <= snap.LARGEST * task.diameter or not snaps)
    good = good and (path.release.active or not turns_too_far(work, substep))
    substep.room, substep.moved = path.room.value, path.room.moved + substep.distance
    if good and (NEARER * substep.moved >= substep.room or substep.near_overlap):
        substep.room, substep.moved = free_room(system, task, work.trial), 0.0
        good = substep.room >= 0.0 and clear_between(system, task, work, path, substep)
        if not (good or path.snap.active or can_shorten(path, substep, OVERLAP_TIME)):
            path.outcome = OVERLAP
    if not good or substep.status == LINEAR:
        return good
    if path.least_gap > 0.0 and not path.snap.active and hides_instability(system, work, path):
        return False
    if slides(work.history):
        return slides_stably(system, task, work, path, substep)
    stale_solution(system, work, work.trial, task.load, 1.0, work.ahead)
    if not task.predictor or path.snap.active or has_history(work.history):
        return True
    return not jumped(system, task, work, substep.distance, substep.duration)


@part
def turns_too_far(work, substep):
    """Whether the path turned so far that friction would act in wrong directions, or that a release would be
    missed."""
    return substep.duration > LEAST_RATED and substep.share > most_turn(work.history)


@part
def hides_instability(system, work, path):
    """Whether the first pair closes, and the open spring has become unstable before: contact may hide it."""
    copy_history(work.history, work.high)
    closes = system.update_history(system.reals, system.ints, work.trial, work.history) <= 0.0
    copy_history(work.high, work.history)
    if not closes:
        return False
    assembled(system, work.state, np.inf, work.history, work.trial, work.g, work.H)
    negative, _ = factored(system, work.H)
    path.checks += 1
    return negative > 0


@part
def clear_between(system, task, work, path, substep):
    """Whether wires overlap by no more than allowed half way, too: coils that slip past each other may do so
    only there."""
    if path.snap.active or path.release.active or 0.5 * NEARER * substep.distance < substep.room:
        return True
    moved(system, work.state, work.tangent, 0.5 * substep.duration, work.scratch)
    put_prescribed(system, task.start, substep.target - 0.5 * substep.duration, work.scratch)
    return free_room(system, task, work.scratch) >= 0.0


@part
def free_room(system, task, state):
    """How much nearer wires may come before they overlap by more than is allowed."""
    return OVERLAP_ALLOWED * task.diameter - system.overlap(system.reals, system.ints, state)[1]
