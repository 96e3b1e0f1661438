"""What contact remembers of pairs from substep to substep, whatever a model's pairs are."""

import numpy as np

from coilspring.compiling.compiled import part

MOST_CHANGE = 1.5  # ratio of a predicted bound to the one before, or of this to that, at most


@part
def copy_history(source, target):
    """target[:] = source for contact histories."""
    for m in range(source.size):
        target[m] = source[m]


@part
def begin_attempt(history, duration, ratio, straight):
    """Take back what an attempt made of pairs that were open, or graze; in its `duration` those are expected
    to slip by `ratio` times what they did in the last substep.

    The direction in which a pair slides at the end of a substep is that of the parabola through the last
    three places (two-step backward differentiation): its reference is ahead on the last way by a share. Not
    where the path went `straight` last, or jumped.
    """
    for m in range(history.shape[0]):
        row = history[m]
        if row.fresh:
            row.closed = row.fresh = False
        row.released, row.least, row.most = 0.0, -1.0, 2.0
        slides = row.stride > 0.0 and (row.grazes or row.bound < np.inf)
        row.wanted = 0.0 if straight or not slides else ratio**2 / (1.0 + 2.0 * ratio)
        slip = ratio * row.slip - row.wanted * row.stride
        if row.grazes and slip > 0.0 and row.before > 0.0:
            more = max(row.growth * duration / row.stiffness, -row.before)
            row.released = max(slip - more, 0.0) / (row.before + slip)


@part
def keep_bounds(history):
    """Begin with the bounds of the last accepted state where predicted ones differ much: penetrations of hard
    contact are not predicted well."""
    for m in range(history.shape[0]):
        row = history[m]
        near = row.held / MOST_CHANGE <= row.bound <= MOST_CHANGE * row.held
        if row.closed and not (row.fresh or near) and row.bound < np.inf:
            row.bound = row.held


@part
def stick(history):
    """Hold what touched first from there on: that it did so where it is predicted to needs no attempt."""
    for m in range(history.shape[0]):
        if history[m].fresh:
            history[m].released = 0.0


@part
def touched_first(history):
    """The pairs that touched first in the substep at hand."""
    pairs, count = np.empty(history.shape[0], np.int64), 0
    for m in range(history.shape[0]):
        if history[m].fresh:
            pairs[count] = m
            count += 1
    return pairs[:count]


@part
def opening(history):
    """Whether a pair that has opened still holds something tangentially."""
    for m in range(history.shape[0]):  # noqa: SIM110
        if history[m].opening:
            return True
    return False


@part
def located(history):
    """Share of the substep, or release, that ends where the first pair touches or opens, 1 where it does."""
    share = 1.0
    for m in range(history.shape[0]):
        row = history[m]
        if row.closed and not row.grazes and (row.fresh or row.opening or row.bound == np.inf):
            share = min(share, row.cut)
    return share


@part
def release(history, share):
    """Leave opening pairs a share of the tangential stiffness they had in the last accepted state."""
    for m in range(history.shape[0]):
        if history[m].opening:
            history[m].released = 1.0 - share * history[m].kept


@part
def barely_pressed(history, deep):
    """Whether a pair that opened is pressed again without what it held, by no more than `deep`, mm: that it
    opened at all is known no better."""
    for m in range(history.shape[0]):  # noqa: SIM110
        if history[m].opening and -deep <= history[m].gap < 0.0:
            return True
    return False


@part
def release_grazing(history, pressed):
    """Begin to release pairs that graze, or that are about to open: `pressed`, mm, by no more than those that
    graze may be, and stretched by more. Returns whether there is one."""
    found = False
    for m in range(history.shape[0]):
        row = history[m]
        sticks = row.closed and row.bound == np.inf and not (row.fresh or row.opening)
        if row.grazes or (sticks and -pressed < row.gap <= 0.0 and row.before > pressed):
            if not row.grazes:
                row.held = row.kept * row.stiffness * row.before
            row.grazes, row.opening, found = False, True, True
    return found


@part
def release_further(history, pressed):
    """Release pairs further that were released and just touch again: no more pressed, mm, than those that
    graze may be."""
    for m in range(history.shape[0]):
        row = history[m]
        if row.grazes and row.held > 0.0 and row.gap > -pressed:
            row.grazes, row.opening = False, True


@part
def has_history(history):
    """Whether contact remembers anything of any pair."""
    for m in range(history.shape[0]):  # noqa: SIM110
        if history[m].stiffness != 0.0:  # stays when the pair opens
            return True
    return False


@part
def grazing(history):
    """Whether a pair grazes."""
    for m in range(history.shape[0]):  # noqa: SIM110
        if history[m].grazes:
            return True
    return False


@part
def stuck_from(history):
    """The largest slip in the last substep, mm, of the pairs that grazed then and stick now."""
    most = 0.0
    for m in range(history.shape[0]):
        row = history[m]
        if row.grazes and row.released == 0.0 and row.gap < 0.0:
            most = max(most, row.slip)
    return most


@part
def largest_slip(history):
    """Of the grazing pairs, in the last substep, mm."""
    most = 0.0
    for m in range(history.shape[0]):
        if history[m].grazes:
            most = max(most, history[m].slip)
    return most


@part
def has_friction(history):
    """Whether a pair is held by friction that is bounded."""
    for m in range(history.shape[0]):  # noqa: SIM110
        if history[m].closed and history[m].bound < np.inf:
            return True
    return False


@part
def sticks(history):
    """Whether a pair is held without a bound."""
    for m in range(history.shape[0]):  # noqa: SIM110
        if history[m].closed and history[m].bound == np.inf:
            return True
    return False


@part
def slides(history):
    """Whether a pair slides in the substep at hand."""
    for m in range(history.shape[0]):  # noqa: SIM110
        if history[m].closed and history[m].slip > 0.0:
            return True
    return False


@part
def set_rise(history, rise):
    """Let the bounds of the pairs that are held rise so with their slips."""
    for m in range(history.shape[0]):
        history[m].rise = rise if history[m].closed else 0.0
