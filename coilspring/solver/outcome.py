"""How a path ended, and the words that say why."""

from dataclasses import replace

import numpy as np

from coilspring.contact.history import has_friction
from coilspring.contact.kinematics import OVERLAP_ALLOWED
from coilspring.solver.body import body_of, softest
from coilspring.solver.continuation.follower import MOST_TRIES
from coilspring.solver.coulomb import goes_on, time_left
from coilspring.solver.interface import Kernels
from coilspring.solver.problem import Problem, Track
from coilspring.solver.system import COMPLETED, CRITICAL, EXHAUSTED, JUMP, OVERLAP, STUCK, TURNED

# Null modes of a bifurcation do no work with the load; where paths lean by rounding, less than this share.
NO_WORK = 3e-5
SOFT = 0.01  # stiffness of the softest mode over that at rest, below which the tangent counts as singular
LEFT = 1e-5  # of the time 0..1: so near to where a path ends, a limit point of Coulomb's law is its end
SLIDING = -1  # beside the outcomes of `coilspring.solver.system`: see `coilspring.solver.coulomb`
UNFOLLOWED = (
    "Coulomb's law has a solution beyond, but the iteration on friction bounds found no stable equilibrium"
)
PAIR_OPENS = (
    "a sticking pair opens, and the path jumps: no equilibrium without overlap is near as its tangential "
    "force is released,"
)
THROUGH = (
    f"coils pass through each other: the wire overlaps by {OVERLAP_ALLOWED:g} wire diameters more than any "
    "contact pair"
)
WHY = {
    SLIDING: UNFOLLOWED,
    STUCK: "no equilibrium that continues the branch was found",
    EXHAUSTED: f"the path was stopped after {MOST_TRIES} equilibria besides those at requested times,",
}


def judged(
    track: Track, problem: Problem, kernels: Kernels, length: float
) -> tuple[Track, np.ndarray, float]:
    """The track, with a critical point distinguished from a path that got stuck, the softest mode at its end,
    and the share of the load that does work with it."""
    load = problem.load
    if track.outcome not in (CRITICAL, STUCK, TURNED):
        return track, np.zeros_like(load), 0.0
    body = body_of(problem, kernels)
    share, mode, work = softest(body, track.last, track.history, problem.start, load)
    end = (body, track.last, track.history, load, length)
    friction = has_friction(track.history.view(np.recarray))
    left = time_left(*end) if friction else np.inf
    if track.outcome == TURNED:
        undecided = track.undecided if left <= LEFT else min(track.undecided, track.time)
        track = replace(track, outcome=CRITICAL, undecided=undecided)
    elif left <= LEFT:
        track = replace(track, outcome=CRITICAL, bracket=max(track.bracket, 2.0 * left))
    elif friction and not track.far and goes_on(*end):
        track = replace(track, outcome=SLIDING)
    elif track.outcome == STUCK and abs(share) < SOFT:
        track = replace(track, outcome=CRITICAL)
    return track, mode, work


def verdict(track: Track, work: float) -> tuple[str, str, float | None]:
    """Outcome, message and critical time."""
    if track.outcome == COMPLETED:
        return "completed", "the load path was followed to time 1", None
    begin, end = f"{track.time:.6g}", f"{track.time + track.bracket:.6g}"
    where = f"between time {begin} and {end}" if begin != end else f"at time {begin}"
    if track.outcome == OVERLAP:
        return "interpenetration", f"{THROUGH} {where}", None
    if track.outcome == JUMP:
        return "jump", f"{PAIR_OPENS} {where}", track.time
    if track.outcome == CRITICAL:
        critical = track.time + 0.5 * track.bracket
        if work > NO_WORK and not track.bifurcates:
            return "limit_point", f"limit point {where}: beyond it this branch has no equilibrium", critical
        return "bifurcation", f"bifurcation {where}: the branch loses its stability", critical
    return "not_converged", f"{WHY.get(track.outcome, WHY[STUCK])} {where}", None


def snaps(track: Track) -> str:
    """The limit points that the path passed, or nothing."""
    if track.snaps == 0:
        return ""
    points = "a limit point" if track.snaps == 1 else f"{track.snaps} limit points"
    return f"; on the way it snaps past {points}, by at most {track.largest_snap:.2g} wire diameters"


def undecided(track: Track) -> str:
    """That pairs could hold other forces as well, or nothing."""
    if track.undecided == np.inf:
        return ""
    return (
        f"; from time {track.undecided:.6g} on coils can hold each other by other forces as well: "
        "another number of steps may find those"
    )
