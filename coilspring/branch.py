"""The branch: where a path is predicted to go on, and whether a state found there continues it."""

from __future__ import annotations

import numpy as np

from coilspring.compiled import copied, part

# A converged state continues the branch when it lies near the straight prediction: within this share
# of the way it came (a fold or a jump turns the path by more), or within a small distance at all
# (a closing contact kinks the path, so that no step is short enough for the share).
TURN = 0.07
SMALL = 0.05  # wire diameters
# A pair may not move by more in one substep: beyond, coils could pass through or over each other.
PAIR_MOTION = 0.5  # wire diameters
JUMP = 0.25  # of the way, by which it may differ from that which the tangents at both ends tell
PAIR_TURN = 0.02  # wire diameters, between a pair's motion and that which the tangents tell


@part
def curvature(tangent, old, last, step):
    """1 where a step follows the path's curvature, 0 where the tangent turned too much in the last one."""
    bend, size = 0.0, 0.0
    for i in range(tangent.size):
        bend += (tangent[i] - old[i]) ** 2
        size += tangent[i] ** 2
    return 1.0 if (0.5 * step / last) ** 2 * bend <= TURN**2 * size else 0.0


@part
def predict(reals, ints, before, state, tangent, last, step, bend, out, retract):
    """The path extrapolated from `state` by a `step` of time: along its tangent, and with ``bend = 1`` on the
    parabola that also meets the state `before`, a time `last` ago; with 0 on the straight line."""
    second = bend * (step / last) ** 2
    retract(reals, ints, state, tangent, step + second * last, before, second, out)


@part
def continues(reals, ints, predicted, state, trial, diameter, troubled, judged, motion):
    """Whether `trial` continues the branch of `state`; the share by which the path turned, less where the
    turn is small at all; a bound on how far any point moved."""
    # no pair moves by more than its two ends do
    way, pair, _ = motion(reals, ints, state, trial, 0.5 * PAIR_MOTION * diameter)
    if pair > PAIR_MOTION:
        return False, 1.0, way
    if not judged:
        return True, 0.0, way
    turn, _, _ = motion(reals, ints, predicted, trial, np.inf)
    share = turn / way if way > 0.0 else 0.0
    least = turn / (SMALL * diameter)
    return least <= 1.0 or (share <= TURN and not troubled), min(share, TURN * least), way


@part
def snapped(reals, ints, state, trial, way, tangent, ahead, step, diameter, predicted, retract, motion):
    """Whether near pairs moved neither as predicted nor as the tangents at both ends tell, or all did not as
    these tell: the path may have passed a limit point between the two. `way` is that of `continues`;
    `predicted` is overwritten.
    """
    least = 0.5 * PAIR_TURN * diameter
    _, pair, _ = motion(reals, ints, predicted, trial, least)
    if pair <= PAIR_TURN and way * JUMP <= SMALL * diameter:
        return False
    mean = copied(tangent)
    for i in range(mean.size):
        mean[i] = 0.5 * (tangent[i] + ahead[i])
    retract(reals, ints, state, mean, step, state, 0.0, predicted)
    turn, other, _ = motion(reals, ints, predicted, trial, least)
    # a fold's tangent points along the jump from it, and may be as long; behind it the tangent is short
    return min(pair, other) > PAIR_TURN or turn > max(JUMP * way, SMALL * diameter)
