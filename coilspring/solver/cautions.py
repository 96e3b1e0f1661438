"""What a reader of a path's rows must know: where they are none of a spring, or hide what it did."""

from typing import NamedTuple, Self

import numpy as np

from coilspring.contact.law import tangential_stiffness
from coilspring.path import EquilibriumPath
from coilspring.scene.load import given_loads

MOST_BEYOND = 0.5  # wire diameters by which coils may reach beyond an end: a seat would hold them by then
VOID_PENETRATION = 0.1  # wire diameters of overlap, beyond which a penalty no longer stands for contact
# Times the way at the initial rate, beyond which a spring has buckled. Of random springs on which no force
# acts sideways those that did not lean moved by at most 1.05 times that way; of 500 on plates by 1.06 times.
BUCKLED = 1.5
AXIAL = np.array([[0.0, -1.0]])
# Contact stiffness on plates, in units of E d. Of 20 random springs with friction none ends early by rounding
# at 5, 2 do at 500 and at 5e4; on rigid seats none of 158. All 11 that soft plates ended were below 1e-10.
HARD, SOFT = 100.0, 1e-9
SUDDEN = 2.0  # times the speed before, with which the top moves on from the last row to the end of a path


def worst(values: np.ndarray, times: np.ndarray) -> tuple[int, str]:
    """The last row of the largest value, and when that is unless at the end of the load."""
    row = len(times) - 1 - int(np.argmax(values[::-1]))
    return row, f" at time {times[row]:.6g}" if times[row] < 1.0 else ""


class Reached(NamedTuple):
    """Rows of a path, and, if it ended before time 1, the last equilibrium."""

    times: np.ndarray
    states: np.ndarray
    least_gaps: np.ndarray
    tips: np.ndarray
    ended: bool  # whether the last one is no row

    @classmethod
    def of(cls, path: EquilibriumPath) -> Self:
        """All that a path has reached."""
        times, states, gaps = path.times, path.states, path.least_gaps
        if path.last_state is not None and path.end_bracket is not None and path.end_bracket[0] > 0.0:
            last = path.last_state[None]
            times, states = np.append(times, path.end_bracket[0]), np.concatenate((states, last))
            gaps = np.append(gaps, path.shape.pair_gaps(last).min(initial=np.inf))
            return cls(times, states, gaps, path.shape.tips(states), ended=True)
        return cls(times, states, gaps, path.tips, ended=False)

    def worst(self, values: np.ndarray) -> tuple[int, str]:
        """As `worst`; at the end of a path that ended before, "there", which the message has just named."""
        row, when = worst(values, self.times)
        return row, " there" if self.ended and row == len(self.times) - 1 else when


def warning(path: EquilibriumPath) -> str:
    """What makes some of the rows equilibria of the model rather than of a spring, that the spring buckled,
    that it moved far after the last row, or that contact was too hard or too soft for plates; or nothing."""
    rows, ends = Reached.of(path), _stiffness(path)
    if not len(rows.times):
        return ends
    return _no_spring(path, rows) + _buckled(path, rows) + _moves_on(path, rows) + ends


def _no_spring(path: EquilibriumPath, rows: Reached) -> str:
    """What no spring does."""
    said, d = "", path.scene.spring.wire_diameter
    row, when = rows.worst(-rows.least_gaps)
    if (depth := -rows.least_gaps[row] / d) > VOID_PENETRATION:
        said = f"; but{when} coils penetrate by {depth:.2f} wire diameters: the contact stiffness is too low"
    row, when = rows.worst(lowered := -rows.tips[:, 1])
    if lowered[row] > path.scene.spring.active_height:
        return f"{said}; but{when} the top has passed the bottom, which no contact law here prevents"
    row, when = rows.worst(beyond := path.shape.beyond_ends(rows.states))
    if beyond[row] > MOST_BEYOND * d:
        reach = f"coils reach {beyond[row]:.3g} mm beyond an end"
        return f"{said}; but{when} {reach}, which no seat stops here"
    return said


def _buckled(path: EquilibriumPath, rows: Reached) -> str:
    """That an axial load moved the top farther than at the initial rate: where it is lowest, or highest."""
    load = path.scene.load
    if any(x for x, _ in (load.force, *load.stages)):
        return ""
    if load.displacement:  # of rows alone the reaction is known
        rows = rows._replace(times=path.times, tips=path.tips, ended=False)
    for sign in (-1.0, 1.0) if len(rows.times) else ():
        row, when = rows.worst(sign * rows.tips[:, 1])
        if load.displacement:
            _, y = path.select(slice(row, row + 1)).loads[0]
        else:
            _, y = given_loads(load, rows.times[row : row + 1])[0]
        way, force = float(sign * rows.tips[row, 1]), float(sign * y)
        # unloaded, a spring is where rounding, or what sticks, leaves it
        if min(way, force) > 0.0 and (ratio := _rate(path) * way / force) > BUCKLED:
            moved = f"the top has moved {ratio:.2g} times as far as at the initial rate"
            return f";{when} {moved}: the spring has buckled"
    return ""


def _rate(path: EquilibriumPath) -> float:
    """Axial rate of the model at rest, N/mm, a user's law included."""
    return float(path.shape.rates(path.shape.rest[None], None, AXIAL)[0])


def _moves_on(path: EquilibriumPath, rows: Reached) -> str:
    """That the top moved suddenly after the last row, up to the end."""
    if path.scene.load.displacement or not rows.ended or not len(path.times):
        return ""
    loads = np.vstack((np.zeros(2), given_loads(path.scene.load, rows.times)))
    tips = np.vstack((np.zeros(2), rows.tips[:, :2]))
    (before, after), (far, moved) = (
        np.linalg.norm(np.diff(each, axis=0)[-2:], axis=1) for each in (loads, tips)
    )
    if moved * before <= SUDDEN * far * after or moved <= path.scene.spring.wire_diameter:
        return ""
    return f"; from its last row, at time {rows.times[-2]:.6g}, to its end the top moves by {moved:.3g} mm"


def _stiffness(path: EquilibriumPath) -> str:
    """That contact on plates is so hard that rounding may have ended the path, or holds next to nothing."""
    spring, contact = path.scene.spring, path.scene.contact
    if path.outcome == "completed" or path.scene.supports.seat != "plate":
        return ""
    stiffness = tangential_stiffness(contact.stiffness, contact.exponent, spring.wire_diameter)
    ratio = stiffness / (path.scene.material.E * spring.wire_diameter)
    why = f"above {HARD:g} E d rounding may end a path on plates" if ratio > HARD else "too low for plates"
    return f"; but the contact stiffness is {ratio:.3g} E d: {why}" if not SOFT <= ratio <= HARD else ""
