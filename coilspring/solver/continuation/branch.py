"""The branch: where a path is predicted to go on, and whether a state found there continues it."""

import math

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.contact.history import has_friction, has_history
from coilspring.solver.equilibrium.newton import INDEFINITE, NONE
from coilspring.solver.equilibrium.operations import moved, put_prescribed

# A converged state continues the branch where its turn, the distance from the straight prediction, is within
# a share of the distance it came: a fold or a jump turns the path by more. A turn that is small is no turn: a
# closing contact kinks the path, so that no step is short enough for the share.
TURN = 0.07  # largest turn, as a share of the distance
FRICTION_TURN = 3e-3  # largest turn with friction, a share: a wrong direction stays wrong along the path
SMALL_TURN = 0.05  # turn that is small, wire diameters
# Where it limits substeps, what is small is a share of all motion since the start, too:
FRICTION_SHARE = 0.1  # with friction
STUCK_SHARE = 1e-3  # where pairs stick, which may be released on the way and be closed again at its end
# Where next to nothing is left of the stiffness a jump may begin, and less is small; where the matrix was
# indefinite on the way, no larger distance continues the branch.
LEAST_TURN = 1e-4  # turn that is small there at least, wire diameters
LEFT = 2.0  # turn that is small there, if that is more, in roots of the tolerance over the stiffness
PAIR_MOTION = 0.5  # largest motion of a pair in a substep, wire diameters: beyond, coils may pass each other
TANGENTS_TURN = 0.25  # largest turn from what the tangents at both ends tell, as a share of the distance
PAIR_TURN = 0.02  # largest turn of a pair's motion from what the tangents tell, wire diameters


@part
def displacement_bound(system, a, b, least):
    """Bound on all motion, pair motion, share of it before the first touch."""
    return system.displacement_bound(system.reals, system.ints, a, b, least)


@part
def curvature(task, work, last, step):
    """1 where a step follows the path's curvature, 0 where the tangent turned too much in the last one."""
    bend, size, tangent, old, arms = 0.0, 0.0, work.tangent, work.old, task.arms
    for i in range(tangent.size):
        bend += (arms[i] * (tangent[i] - old[i])) ** 2
        size += (arms[i] * tangent[i]) ** 2
    return 1.0 if (0.5 * step / last) ** 2 * bend <= TURN**2 * size else 0.0


@part
def predict(system, task, work, path, bend, target):
    """Extrapolate the path to a time: along its tangent, and with ``bend = 1`` on the parabola that also
    meets the state before; with 0 on the straight line."""
    step, last = target - path.time, path.last_step
    second = bend * (step / last) ** 2
    system.retract(
        system.reals, system.ints, work.state, work.tangent, step + second * last, work.before, second,
        work.predicted,
    )  # fmt: skip
    put_prescribed(system, task.start, target, work.predicted)


@part
def interpolate(system, task, work, path, time):
    """Put a state within the last substep in `work.predicted`: on the parabola between its ends, along the
    tangent at its begin, which is better known than that at a critical point just ahead."""
    if work.old[0] == np.inf:
        predict(system, task, work, path, 1.0, time)
        return
    since = path.last_step - (path.time - time)
    share = (since / path.last_step) ** 2
    system.retract(
        system.reals, system.ints, work.before, work.old, since - share * path.last_step, work.state, share,
        work.predicted,
    )  # fmt: skip
    put_prescribed(system, task.start, time, work.predicted)


@part
def most_turn(history):
    """Share by which a path may turn in a substep."""
    return FRICTION_TURN if has_friction(history) else TURN


@part
def small_turn(task, stiffness, tolerance):
    """Turn up to which a state continues the branch at all, mm, where little `stiffness`, N/mm, is left."""
    left = LEFT * math.sqrt(tolerance / stiffness) if stiffness > 0.0 else np.inf
    return min(max(LEAST_TURN * task.diameter, left), SMALL_TURN * task.diameter)


@part
def continues(system, task, work, trouble, judged, small):
    """Whether the trial state continues the branch, as after turns of up to `small`, mm, at all; by how much
    the path turned, mm; as a share of the way, less where the turn is small; a bound on all motion; and how
    far near pairs are from the prediction, mm: where pairs stick and that is little, a bound."""
    # no pair moves by more than its two ends do
    distance, pair, _ = displacement_bound(system, work.state, work.trial, 0.5 * PAIR_MOTION * task.diameter)
    if pair > PAIR_MOTION:
        return False, np.inf, 1.0, distance, np.inf
    if not judged:
        return True, 0.0, 0.0, distance, 0.0
    turn, pair, _ = displacement_bound(system, work.predicted, work.trial, 0.5 * task.located)
    share = turn / distance if distance > 0.0 else 0.0
    least = turn / small
    good = least <= 1.0 or (share <= TURN and trouble == NONE)
    if trouble == INDEFINITE and not has_friction(work.history):
        # a jump may end anywhere, also near the prediction; friction is predicted to slide where it sticks
        good = distance <= LEAST_TURN * task.diameter
    if has_history(work.history):
        whole, _, _ = displacement_bound(system, task.start, work.trial, np.inf)
        most = whole * (FRICTION_SHARE if has_friction(work.history) else STUCK_SHARE)
        least = max(least, turn / most) if most > 0.0 else least
    sticks = task.predicted < task.located
    error = 2.0 * turn if sticks and turn <= 0.5 * task.located else pair * task.diameter
    return good, turn, min(share, TURN * least), distance, error


@part
def jumped(system, task, work, distance, step):
    """Whether near pairs moved neither as predicted nor as the tangents at both ends tell, or all did not as
    these tell: the path may have passed a limit point between the two. `distance` is that of `continues`;
    `work.predicted` and `work.step` are overwritten.
    """
    least = 0.5 * PAIR_TURN * task.diameter
    _, pair, _ = displacement_bound(system, work.predicted, work.trial, least)
    if pair <= PAIR_TURN and distance * TANGENTS_TURN <= SMALL_TURN * task.diameter:
        return False
    mean, tangent, ahead = work.step, work.tangent, work.ahead
    for i in range(mean.size):
        mean[i] = 0.5 * (tangent[i] + ahead[i])
    moved(system, work.state, mean, step, work.predicted)
    turn, other, _ = displacement_bound(system, work.predicted, work.trial, least)
    # a fold's tangent points along the jump from it, and may be as long; behind it the tangent is short
    return min(pair, other) > PAIR_TURN or turn > max(TANGENTS_TURN * distance, SMALL_TURN * task.diameter)
