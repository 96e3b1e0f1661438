"""A failed substep, or release, is taken again, shorter, until the path ends or pairs are released."""

import numpy as np

from coilspring.compiling.compiled import part
from coilspring.contact.history import grazing, release_grazing
from coilspring.solver.continuation.accept import NEAR_END
from coilspring.solver.continuation.snap import end_or_snap, release_or_jump
from coilspring.solver.continuation.stability import FINEST, LEAST_STEP, RIGID
from coilspring.solver.continuation.start import FIRST_STEP
from coilspring.solver.continuation.substep import LEAST_RELEASE, MOST_RELEASE
from coilspring.solver.equilibrium.newton import INDEFINITE
from coilspring.solver.system import COMPLETED, CRITICAL, JUMP, STUCK, TURNED
from coilspring.solver.tangential.friction import raise_bounds

RETRIED = 0.5  # share of a substep, or release, that failed: it is tried next
LEAST_LEFT = 1e-4  # share that a release leaves, over what was still to release where a pair touched again
LEAST_GRAZING = 1e-7  # of the time 0..1: in less, a grazing pair moves by no more than it is located to


@part
def shorten(system, task, work, path, substep):
    """Take what failed again, shorter; what is too short ends the path, unless a pair can be released."""
    if path.outcome != COMPLETED:
        return
    path.reuse = False
    if path.snap.active:
        unstable, ends = substep.trouble == INDEFINITE, path.snap.ends
        if ends == STUCK and unstable:
            ends = CRITICAL  # negative pivots just ahead are why no substep was short enough
        elif ends == JUMP and path.lost and not unstable:
            ends = STUCK  # the iteration ended, which tells nothing of equilibria nearby
        if ends == CRITICAL and path.snap.opened and not path.lost:
            ends = JUMP  # to an equilibrium too far away; nothing is critical here
        path.snap.active, path.outcome, path.snap.far = False, ends, not path.lost
    elif path.release.active:
        release_less(task, path, substep.cut)
    else:
        go_less(task, work, path, substep)
        rigid = path.softest.value > RIGID * path.scale.stiffness  # it is no mode that has become soft
        least = LEAST_STEP
        if rigid and grazing(work.history) and substep.cut == 1.0:
            least = LEAST_GRAZING  # one that is only cut, to where a pair touches or opens, does not stall
        elif substep.near_critical and substep.unstable:
            least = FINEST  # the stiffness may vanish just behind where a pair closed, or as it is predicted
        if substep.duration < least:
            path.bracket = 2.0 * max(substep.duration, LEAST_STEP)
            if not (rigid and starts_release(system, task, work, path)):
                # negative pivots however short the step: the stiffness jumps there
                outcome = CRITICAL if substep.unstable else STUCK
                outcome = TURNED if abs(path.time - path.friction.turned) <= NEAR_END else outcome
                end_or_snap(system, task, work, path, outcome)


@part
def release_less(task, path, cut):
    """Release less of what opening pairs hold; where that is too little, all at once, or the path jumps.

    Where a pair touches again after the share `cut` of it, no attempt that leaves much less is made.
    """
    path.release.power = min(path.release.power, 2.0 * MOST_RELEASE) * RETRIED
    while 2.0**-path.release.power < LEAST_LEFT * (1.0 - cut):
        path.release.power *= RETRIED
    if path.release.power < LEAST_RELEASE:
        path.bracket = 2.0 * LEAST_STEP
        release_or_jump(task, path)


@part
def go_less(task, work, path, substep):
    """Choose a shorter substep, and note what was wrong with this one."""
    if path.friction.slid and substep.trouble == INDEFINITE:
        raise_bounds(work, path, task.diameter)
    if substep.turned:
        path.friction.turned = substep.target
    if substep.cut < 1.0:
        path.until = substep.cut * substep.duration
    else:
        path.failed, path.next_step = True, RETRIED * substep.duration


@part
def starts_release(system, task, work, path):
    """Begin to release pairs that graze, or are about to open, since what they hold leads nowhere; where they
    are released again at once, by a snap. Returns whether there is one."""
    grazes = grazing(work.history)
    system.update_pairs(system.reals, system.ints, work.state, work.state, work.state, work.history)
    if not release_grazing(work.history, path.scale.pressed * task.diameter):
        return False
    again = path.time <= path.release.gradual
    path.release.gradual, path.next_step, path.until = path.time + LEAST_STEP, FIRST_STEP, np.inf
    if grazes:
        path.undecided = min(path.undecided, path.time)
    path.release.active, path.release.power, path.release.last = True, np.inf, 0.0
    if again:
        release_or_jump(task, path)
    return True
