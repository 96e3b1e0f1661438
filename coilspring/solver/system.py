"""What the compiled solver works with: model and constraint, the task, vectors, where a path stands.

Compiled functions take these few bundles. What changes in place are arrays, and records of numbers.
"""

from typing import Any, NamedTuple

import numpy as np

# Entries of what is prescribed: its place in the state, in the gradient, on the diagonal of the matrix, the
# stiffness that fixes it there, and its change by time 1.
PLACE, DOF, DIAGONAL, STIFFNESS, CHANGE = range(5)
FREE = np.zeros(0)  # nothing is prescribed


class Data(NamedTuple):
    """A model's numbers, see `coilspring.compiling.packing`, and the prescribed degree of freedom."""

    reals: np.ndarray
    ints: np.ndarray
    prescribed: np.ndarray  # (5,) or empty


class System(NamedTuple):
    """A model with its kernels, see `coilspring.solver.interface`, and the prescribed degree of freedom."""

    reals: Any
    ints: Any
    prescribed: Any  # (5,) or empty
    reaction: Any  # (1,) force on what is prescribed, in the state assembled last
    assemble: Any
    factor: Any
    solve: Any
    retract: Any
    work: Any
    rotate: Any
    displacement_bound: Any
    update_history: Any
    update_pairs: Any
    pair_rates: Any
    length_gradient: Any
    overlap: Any


class Task(NamedTuple):
    """What is asked of the follower."""

    times: np.ndarray  # (steps,) requested times, increasing
    load: np.ndarray  # (n,) that grows with time; of a prescribed motion the one that gives the tangent
    dead: np.ndarray  # (n,) load that is there from the beginning
    start: np.ndarray  # state at time 0
    arms: np.ndarray  # (n,) on which motions are measured, mm: 1 of displacements, of rotations the diameter
    span: float  # largest coordinate at rest, mm, whose rounding is that of positions
    diameter: float  # wire diameter, mm: the length with which motions are compared
    located: float  # mm, so closely is found where pairs touch first; infinite where that is all one
    predicted: float  # the error of a predicted touch that is not looked for any more, mm; or infinite
    penalty: float  # K and
    exponent: float  # k of a pair
    limit: int  # largest number of iterations of a substep
    predictor: bool  # the matrix is the tangent: predict by it, and judge the branch by it
    modified: bool  # modified Newton: factors are kept longer, the matrix left out where not factored


class Target(NamedTuple):
    """Of which equilibrium is asked."""

    accepted: Any  # the last accepted state,
    least_gap: Any  # and the least gap of its pairs
    history: Any  # contact history
    load: Any
    reference: Any  # work with which decrements are compared,
    precision: Any  # share of the decrement that is asked for
    predicted: Any  # energy of the predicted motion
    rounding: Any  # noise of the potential,
    grain: Any  # and for each newton of a force, mm
    hardness: Any  # stiffness of a pair, N/mm
    limit: Any  # largest number of iterations,
    damped: Any  # and of those through an indefinite matrix
    shift: Any  # with which that is made positive, at least, in units of the matrix at rest
    modified: Any  # see `coilspring.solver.system.Task`
    least_pivot: Any  # at rest


class Workspace(NamedTuple):
    """Vectors and tables that change on the way."""

    state: np.ndarray  # last accepted
    trial: np.ndarray  # of the substep at hand
    predicted: np.ndarray
    before: np.ndarray  # the state accepted before the last one
    origin: np.ndarray  # where the linear stretch at hand began
    scratch: np.ndarray  # a state
    factored_at: np.ndarray  # the state whose matrix `F` factors
    tangent: np.ndarray  # d(state)/d(time) at the last accepted state
    old: np.ndarray  # the same at the state before
    ahead: np.ndarray  # the same at the trial state
    g: np.ndarray  # gradient, or residual
    step: np.ndarray  # of Newton's method
    load: np.ndarray  # on the substep at hand
    mode: np.ndarray  # the softest
    H: np.ndarray  # matrix
    F: np.ndarray  # its factor, the last one
    rest: np.ndarray  # matrix at the start
    history: np.ndarray  # (pairs,) contact history: at the last accepted state, bounds of the trial
    trial_history: np.ndarray  # that with which the trial state was found
    low: np.ndarray  # two more tables, of another state or with other bounds
    high: np.ndarray
    decrements: np.ndarray  # the last Newton decrements over the reference work
    states: np.ndarray  # (steps, state size), at the requested times
    histories: np.ndarray  # (steps, pairs) contact history with which they were found
    iterations: np.ndarray  # (steps,) factorisations since the previous row
    least_gaps: np.ndarray  # (steps,) least gap of the contact pairs


# Found where the path starts; what later numbers are compared with.
SCALE = np.dtype(
    [
        ("reference", "f8"),  # work of the whole load along the tangent
        ("rounding", "f8"),  # of the potential, over a force
        ("force", "f8"),  # sizes of the growing load summed, or the first reaction to what is prescribed, N
        ("dead", "f8"),  # sizes of the dead load summed, N
        ("stiffness", "f8"),  # least stiffness
        ("least_pivot", "f8"),
        ("pressed", "f8"),  # wire diameters by which a grazing pair may penetrate
    ],
    align=True,
)

# Jumps past limit points, see `coilspring.solver.continuation.snap`.
SNAP = np.dtype(
    [
        ("active", "?"),  # the path is past a limit point
        ("ends", "i8"),  # outcome where that leads nowhere,
        ("far", "?"),  # or too far away
        ("opened", "?"),  # there the stiffness jumps, since a pair opens that sticks
        ("bifurcates", "?"),  # there the stiffness falls to zero in proportion, by a mode of no work
        ("count", "i8"),  # of snaps so far,
        ("largest", "f8"),  # and bound on the largest motion in one of them, wire diameters;
        ("size", "f8"),  # that of the last one,
        ("until", "f8"),  # which went on up to this time
    ],
    align=True,
)

# What opening pairs held is released at a constant load.
RELEASE = np.dtype(
    [
        ("active", "?"),  # opening pairs hold something tangentially that is still to be released
        ("power", "f8"),  # of two by which their tangential stiffness is lowered next
        ("last", "f8"),  # and that of the last release, 0 where it began with none
        ("gradual", "f8"),  # up to this time no pair is released again bit by bit,
        ("sudden", "f8"),  # and to this one none at once
    ],
    align=True,
)

FRICTION = np.dtype(
    [
        ("slid", "?"),  # a pair slid
        ("rise", "f8"),  # of the bounds of friction, see `coilspring.solver.tangential.friction`,
        ("raised", "f8"),  # and the least that the matrix needs
        ("turned", "f8"),  # where the determinant of Coulomb's tangent was negative last
    ],
    align=True,
)

# The least stiffness, which ends the path where it falls to zero.
SOFTEST = np.dtype(
    [
        ("value", "f8"),
        ("time", "f8"),  # at which it had that value
        ("zero", "f8"),  # time at which it is predicted to be zero,
        ("root", "f8"),  # the same if it falls as the root of the time that is left; and
        ("ahead", "f8"),  # that of these two which is approached, see `follow_root` of stability.py,
        ("linear", "?"),  # along a straight line, see `follow_line` there
        ("line", "f8"),  # its zero where that line was found,
        ("reach", "f8"),  # and the time that was left then
        ("mark", "f8"),  # a value found on the way, which is to become `past`
        ("mark_time", "f8"),
        ("past", "f8"),  # the value some time ago: `no_time` of `solver.continuation.stability` at least
        ("past_time", "f8"),
    ],
    align=True,
)

# How much nearer wires may come before they overlap by more than is allowed.
ROOM = np.dtype(
    [
        ("value", "f8"),  # mm
        ("time", "f8"),  # at which it was measured
        ("zero", "f8"),  # time at which it is predicted to be zero
        ("moved", "f8"),  # bound on all motion since
    ],
    align=True,
)

# A linear stretch, see `coilspring.solver.continuation.stretch`.
STRETCH = np.dtype(
    [
        ("active", "?"),
        ("begin", "f8"),  # time at which it began
    ],
    align=True,
)

# Where a path stands; its outcomes.
COMPLETED, CRITICAL, STUCK, NEW_PAIR, JUMP, OVERLAP, EXHAUSTED, TURNED = range(8)
PATH = np.dtype(
    [
        ("time", "f8"),
        ("row", "i8"),  # the next requested time
        ("outcome", "i8"),
        ("bracket", "f8"),  # time beyond the last accepted one, in which the path ends
        ("spent", "i8"),  # factorisations since the last requested time
        ("checks", "i8"),  # factorisations that only verified stability
        ("pairs", "i8"),  # contact pairs evaluated
        ("tries", "i8"),  # equilibria looked for
        ("next_step", "f8"),  # duration of the next substep, unless something ends it before
        ("until", "f8"),  # duration after which a pair touches or opens; infinite where that is not known
        ("opens", "f8"),  # duration after which a pair that touched last is predicted to open; or infinite
        ("last_step", "f8"),  # duration of the last accepted substep
        ("error", "f8"),  # of its prediction, mm
        ("travel", "f8"),  # bound on all motion so far, mm
        ("undecided", "f8"),  # time of the first state beyond which pairs could hold other forces
        ("failed", "?"),  # a substep had to be shortened since the softest mode was evaluated
        ("due", "?"),  # the last accepted state is at a requested time, and not written yet
        ("least_gap", "f8"),  # least gap of the contact pairs
        ("reuse", "?"),  # the last factor is tried first
        ("fresh", "i8"),  # short steps still to take, since a pair has closed
        ("lost", "?"),  # the last attempt found no equilibrium
        ("scale", SCALE),
        ("snap", SNAP),
        ("release", RELEASE),
        ("friction", FRICTION),
        ("stretch", STRETCH),
        ("softest", SOFTEST),
        ("room", ROOM),
    ],
    align=True,
)

# One substep.
SUBSTEP = np.dtype(
    [
        ("target", "f8"),  # time at its end
        ("duration", "f8"),  # of time
        ("landing", "?"),  # on a requested time
        ("shortened", "?"),  # to where a pair is about to close
        ("located", "?"),  # the pair that closes touches where it is predicted to, see `Task.predicted`
        ("near_critical", "?"),  # it approaches the predicted zero of the least stiffness
        ("near_overlap", "?"),  # it approaches the predicted overlap
        ("left", "f8"),  # of the least stiffness, over what counts as weak: below 1 where little is left
        ("status", "i8"),  # whether an equilibrium was found, see `solver.equilibrium.newton`
        ("iterations", "i8"),  # factorisations
        ("rounds", "i8"),  # of renewed bounds
        ("trouble", "i8"),  # the worst of all rounds, see the same
        ("unstable", "?"),  # negative pivots where the iteration began, or at an equilibrium found
        ("tolerance", "f8"),  # of the energy that the iteration leaves, N mm
        ("turned", "?"),  # the determinant of Coulomb's tangent is negative
        ("several", "?"),  # pairs that graze, or are barely pressed, could hold other forces, too
        ("damping", "f8"),  # of the flow of friction's bounds in a snap
        ("step", "f8"),  # share of the change of the forces of grazing pairs that is taken in a round,
        ("worst", "f8"),  # and the largest gap or penetration that they had in the last one
        ("cut", "f8"),  # share of it after which a pair touches or opens; 1 where none does
        ("turn", "f8"),  # from the prediction, mm,
        ("share", "f8"),  # and over the way
        ("distance", "f8"),  # bound on all motion, mm
        ("error", "f8"),  # of the prediction
        ("room", "f8"),  # see `ROOM`,
        ("moved", "f8"),  # the same
        ("least_gap", "f8"),  # least gap of the contact pairs
    ],
    align=True,
)

# Newton's method in a substep.
NEWTON = np.dtype(
    [
        ("energy", "f8"),  # potential at the state, N mm
        ("near", "i8"),  # contact pairs evaluated at the state: 0 where none can touch
        ("pairs", "i8"),  # evaluated in all
        ("count", "i8"),  # factorisations
        ("trouble", "i8"),  # a step cut short, or an indefinite matrix
        ("rounding", "f8"),  # noise of the potential at equilibrium,
        ("noise", "f8"),  # and where pairs are off by a step
        ("tolerance", "f8"),  # of the decrement
        ("slope", "f8"),  # of the potential along the step
        ("shift", "f8"),  # with which an indefinite matrix was made positive
        ("damping", "f8"),  # the shift to begin with
        ("least_pivot", "f8"),  # of the last factor
        ("decrement", "f8"),  # of the last step with a factor of its own
        ("last", "f8"),  # of the last step at all, or infinite
        ("looks", "i8"),  # at states within the tolerance
        ("directions", "i8"),  # found with a factor of their own
        ("unstable", "?"),  # see `SUBSTEP`
        ("doubtful", "?"),  # a step was found within the tolerance with a factor that may be of other pairs
        ("reuse", "?"),  # the last factor is tried first
        ("current", "?"),  # the matrix is that of the state
    ],
    align=True,
)


class Records(NamedTuple):
    """Where a path stands: arrays of one record each."""

    path: np.ndarray  # `PATH`
    substep: np.ndarray  # `SUBSTEP`
    newton: np.ndarray  # `NEWTON`
