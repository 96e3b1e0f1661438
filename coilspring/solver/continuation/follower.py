"""Load path of a model: adaptive substeps that land on the requested times and keep the branch.

A substep is planned, predicted, solved and judged. Where it continues the branch it is accepted, else it is
taken again, shorter. A stretch in which the response is linear takes no factorisation; its stability is
verified where it ends.
"""

from collections.abc import Callable
from functools import lru_cache

import numpy as np
from numba import types

from coilspring.compiling.compiled import copy, lent, part, signed
from coilspring.contact.history import copy_history
from coilspring.contact.kinematics import BETWEEN
from coilspring.solver.bundles import (
    TaskRef,
    WorkRef,
    records_type,
    system_of,
    system_types,
    task_type,
    workspace_type,
)
from coilspring.solver.continuation.accept import LEAST_LEFT, accept
from coilspring.solver.continuation.branch import PAIR_MOTION, curvature, displacement_bound, predict
from coilspring.solver.continuation.shorten import shorten
from coilspring.solver.continuation.snap import AHEAD, end_or_snap
from coilspring.solver.continuation.stability import (
    APPROACH,
    FINEST,
    IMPERFECT,
    LEAST_STEP,
    NEUTRAL,
    PROBE,
    RIGID,
    WEAK,
    watch_stiffness,
)
from coilspring.solver.continuation.start import begin, resume
from coilspring.solver.continuation.stretch import leaves_stretch
from coilspring.solver.continuation.substep import (
    MOST_RELEASE,
    OVERLAP_TIME,
    find_equilibrium,
    keeps_branch,
)
from coilspring.solver.equilibrium.newton import LINEAR
from coilspring.solver.equilibrium.operations import put_prescribed
from coilspring.solver.system import COMPLETED, CRITICAL, EXHAUSTED, NEW_PAIR

LEAST_ERROR = 1e-3  # of a prediction, over what is allowed: less may be chance
NEAREST = 0.03  # of the way to a touch that sticks, at least, is left for a better prediction
AROUND = 0.03  # of that way, before and behind, is where a touch on the straight way is on the predicted one
CAREFUL = 2.0  # times the last substep, at most, where next to nothing is left of the stiffness
MOST_TRIES = 20_000  # equilibria besides those at requested times; far more than a path needs


def follow(data, kernels, task, work, records, stop):
    """Follow the equilibrium through the requested times, from the start or from where the path stands.

    Parameters
    ----------
    data, kernels : `Data`, and `coilspring.solver.bundles.bundled` kernels.
    task, work, records : `Task`, `Workspace` and `Records`, see `coilspring.solver.system`.
    stop : one integer; another thread sets it to end the path at the next substep.
    """
    system = system_of(data, kernels)
    task, work = TaskRef(*lent(task)), WorkRef(*lent(work))
    path, substep, it = records.path[0], records.substep[0], records.newton[0]
    if path.tries == 0:
        begin(system, task, work, path)
    elif path.outcome == NEW_PAIR:
        resume(system, task, work, path)
    while path.row < task.times.size and path.outcome == COMPLETED and stop[0] == 0:
        advance(system, kernels.equilibrium, task, work, path, substep, it)
        if path.row == task.times.size or path.outcome != COMPLETED:
            leaves_stretch(system, task, work, path, path.time)


@part
def advance(system, equilibrium, task, work, path, substep, it):
    """Try a substep, and accept it or have it tried again, shorter."""
    if path.release.active and not leaves_stretch(system, task, work, path, path.time):
        return
    plan(system, task, work, path, substep)
    if path.outcome != COMPLETED:
        return
    predict_trial(system, task, work, path, substep)
    find_equilibrium(system, equilibrium, task, work, path, substep, it)
    if not keeps_branch(system, task, work, path, substep):
        if leaves_stretch(system, task, work, path, path.time):
            shorten(system, task, work, path, substep)
        return
    good = stable_so_far(system, task, work, path, substep)
    if good and knows_pairs(system, work, path, substep):
        watch_stiffness(system, task, work, path, substep)
        accept(system, task, work, path, substep)


@part
def plan(system, task, work, path, substep):
    """Time of the next state: no farther than half way to where stiffness or room are predicted to end."""
    softest = path.softest
    path.tries += 1
    if path.tries > MOST_TRIES + path.row:
        path.outcome = path.snap.ends if path.snap.active else EXHAUSTED
        return
    if path.release.active:
        # at the same load, some of what opening pairs held is released
        substep.target, substep.duration, substep.landing = path.time, 0.0, False
        substep.near_critical = substep.near_overlap = False
        path.bracket = 2.0 * LEAST_STEP
        return
    to_critical = APPROACH * (softest.ahead - path.time)
    to_overlap = max(APPROACH * (path.room.zero - path.time), OVERLAP_TIME)
    known = softest.linear and softest.value <= RIGID * path.scale.stiffness
    finest = max(IMPERFECT * path.time, FINEST) if known else FINEST
    if not path.snap.active and (softest.value <= NEUTRAL * path.scale.stiffness or to_critical < finest):
        # just before what vanishes, rounding may do so
        if leaves_stretch(system, task, work, path, path.time - AHEAD):
            path.bracket = 2.0 * max(softest.zero - path.time, LEAST_STEP)
            end_or_snap(system, task, work, path, CRITICAL)
        if path.outcome != COMPLETED:
            return
    substep.left = softest.value / (WEAK * path.scale.stiffness)
    if path.snap.active:
        substep.near_critical, substep.duration = True, AHEAD
    else:
        wanted = min(path.next_step, path.until, path.opens)
        if softest.value < RIGID * path.scale.stiffness:
            wanted = min(wanted, CAREFUL * path.last_step)
        substep.near_critical = path.fresh > 0 or to_critical < wanted
        substep.duration = min(wanted, to_critical, to_overlap, PROBE if path.fresh > 0 else np.inf)
        path.bracket = 2.0 * substep.duration
    substep.near_overlap = substep.duration == to_overlap
    left = task.times[path.row] - path.time
    substep.landing = left <= substep.duration * (1.0 + 1e-9)
    substep.target = task.times[path.row] if substep.landing else path.time + substep.duration
    substep.duration = substep.target - path.time


@part
def predict_trial(system, task, work, path, substep):
    """Predict the state; shorten the substep to where a pair is about to close, whose stiffness is not in
    the tangent."""
    substep.shortened = substep.located = False
    if path.snap.active or not task.predictor:
        copy(work.state, work.predicted)
        return
    if path.release.active:
        predict_release(system, task, work, path, substep)
        return
    bend = curvature(task, work, path.last_step, substep.duration)
    free = free_share(system, task, work, path, bend, substep)
    while free == BETWEEN and substep.duration > LEAST_LEFT:
        # a pair turns about the other, or passes it: nearer it is seen which; or it moves too far
        substep.landing, substep.duration = False, 0.5 * substep.duration
        substep.target = path.time + substep.duration
        bend = curvature(task, work, path.last_step, substep.duration)
        free = free_share(system, task, work, path, bend, substep)
    if free == BETWEEN:  # so near a touch is not looked for
        predict(system, task, work, path, bend, substep.target)
    if free < 1.0:
        substep.shortened, substep.landing = True, False
        left = time_to_touch(system, task, work, path, bend, substep, free * substep.duration)
        substep.duration = min(max(left, LEAST_LEFT), substep.duration)
        substep.target = path.time + substep.duration
        predict(system, task, work, path, bend, substep.target)


@part
def time_to_touch(system, task, work, path, bend, substep, left):
    """Duration to the first touch, which on the straight way takes the time `left`; less where the prediction
    does not tell what touches where: nearer to it, it does. Notes in `substep` which of the two it is."""
    if task.located == np.inf:
        return left
    sticks = task.predicted < task.located
    order = 2.0 + bend
    error = max(path.error, LEAST_ERROR * task.located) * (left / path.last_step) ** order
    if error > task.predicted:
        substep.shortened = False  # nothing closes yet
        return left / (1.0 + max((task.predicted / error) ** (1.0 / order), NEAREST if sticks else 0.0))
    substep.located = sticks
    return touch_about(system, task, work, path, left) if sticks and bend > 0.0 else left


@part
def touch_about(system, task, work, path, left):
    """Duration to the first touch on the predicted parabola, if it is about that on the straight way, `left`;
    else that. `work.predicted` and `work.scratch` are overwritten."""
    around = AROUND * left
    predict(system, task, work, path, 1.0, path.time + left - around)
    copy(work.predicted, work.scratch)
    predict(system, task, work, path, 1.0, path.time + left + around)
    _, _, free = displacement_bound(system, work.scratch, work.predicted, 0.0)
    return left + (2.0 * free - 1.0) * around if free < 1.0 else left


@part
def predict_release(system, task, work, path, substep):
    """Predict what a release leads to: it moves as the last one, in proportion to the powers of two."""
    known = path.release.last > 0.0 and path.release.power <= MOST_RELEASE
    onward = path.release.power / path.release.last if known else 0.0
    system.retract(
        system.reals, system.ints, work.state, work.tangent, 0.0, work.before, -onward, work.predicted
    )
    put_prescribed(system, task.start, substep.target, work.predicted)


@part
def free_share(system, task, work, path, bend, substep):
    """Share of a substep before a pair is predicted to touch, 1 or `BETWEEN`, see
    `coilspring.contact.kinematics.approach`; predicts its end, or half of it.

    A pair that remembers where it touched may do so and open again within the substep; where it sticks, it
    holds something from then on, be it for half of the way. `BETWEEN`, too, where a pair moves farther than
    in any substep.
    """
    half, gap = 0.5 * substep.duration, 0.5 * path.least_gap
    halfway = bend > 0.0 and task.located < np.inf
    if halfway:
        predict(system, task, work, path, bend, substep.target - half)
        distance, _, free = displacement_bound(system, work.state, work.predicted, gap)
        if free != 1.0:
            return 0.5 * free if free < 1.0 else free
        copy(work.predicted, work.scratch)
    predict(system, task, work, path, bend, substep.target)
    _, pair, free = displacement_bound(system, work.state, work.predicted, gap)
    if free == 1.0 and pair > PAIR_MOTION:
        return BETWEEN
    if free < 1.0 or not halfway:
        return free
    _, _, free = displacement_bound(system, work.scratch, work.predicted, gap - distance)
    return BETWEEN if free == BETWEEN else 1.0


@part
def stable_so_far(system, task, work, path, substep):
    """Whether a linear stretch that ends here is stable; notes where one begins."""
    if substep.status == LINEAR:
        if not path.stretch.active:
            copy(work.state, work.origin)
            path.stretch.begin, path.stretch.active = path.time, True
        return True
    if not path.stretch.active:
        return True
    # up to where the first pair closes, if none is closed: there the substep landed
    end = substep.target if path.least_gap > 0.0 else path.time
    return leaves_stretch(system, task, work, path, end)


@part
def knows_pairs(system, work, path, substep):
    """Update the contact history; whether all pairs that touch are in the model.

    Else the path stays where it was, to find the state again with the pair that was missing.
    """
    copy_history(work.trial_history, work.history)
    substep.least_gap = system.update_history(system.reals, system.ints, work.trial, work.history)
    if substep.least_gap > -np.inf:
        return True
    copy_history(work.trial_history, work.history)
    path.outcome = NEW_PAIR
    return False


@lru_cache(maxsize=1)
def compiled_follow() -> Callable:
    """`follow`, compiled; read from the cache where stored."""
    bundles = (task_type(), workspace_type(), records_type())
    return signed(follow, *system_types(), *bundles, types.int64[::1])
