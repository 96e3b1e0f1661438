"""The one result of both models: the equilibrium path."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace
from functools import cached_property
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any, BinaryIO, Protocol

import numpy as np

from coilspring.errors import InputError
from coilspring.pathfile import OTHER_VERSION, read_fields, write_fields
from coilspring.scene import Scene
from coilspring.scene.load import given_loads
from coilspring.scene.scene import load_directions
from coilspring.words import counted, shown

if TYPE_CHECKING:
    import pandas as pd

OUTCOMES = (
    "completed", "limit_point", "bifurcation", "jump", "interpenetration", "not_converged", "unsupported",
)  # fmt: skip


@dataclass(frozen=True)
class Friction:
    """What happens across the normals of the contact pairs.

    The force is that of the law, along the slip. In contact of wires a share z / h of it, see (W9g) in
    ``docs/theory.md``, acts besides: section forces have it, this has not.
    """

    force: np.ndarray  # (states, pairs, 3) tangential, on the lower body of each pair, N
    slip: np.ndarray  # (states, pairs) length that each pair has slid since it closed, mm
    work: np.ndarray  # (states, pairs) that friction, and releases of opening pairs, have taken, N mm


class Shape(Protocol):
    """Reads a model's states; made by the model, used by `EquilibriumPath` on demand."""

    @property
    def pair_law(self) -> Any:
        """What holds the pairs (pairs, 2) and their law; see `coilspring.contact.results`."""

    @property
    def rest(self) -> np.ndarray:
        """State at rest, flat."""

    def tips(self, states: np.ndarray) -> np.ndarray:
        """UX, UY, ROTZ of the top reference point, shape (states, 3); mm, rad (not wrapped)."""

    def pair_forces(self, states: np.ndarray) -> np.ndarray:
        """Normal contact force of every pair, shape (states, pairs), N."""

    def pair_gaps(self, states: np.ndarray) -> np.ndarray:
        """Gap h - d of every pair, negative where it penetrates, shape (states, pairs), mm."""

    def reactions(self, states: np.ndarray, histories: np.ndarray) -> np.ndarray:
        """Force that holds the top along X and Y in states found with contact histories, shape (states, 2),
        N."""

    def rates(self, states: np.ndarray, histories: np.ndarray | None, directions: np.ndarray) -> np.ndarray:
        """Tangent stiffness of the top along directions (states, 2), with the contact histories of the
        states (None: of no pair), shape (states,), N/mm."""

    def largest_stresses(self, states: np.ndarray, histories: np.ndarray | None) -> np.ndarray | None:
        """Largest shear stress of the wire, corrected for its curvature, in states found with contact
        histories (None: of no pair), shape (states,), MPa; None where the model has no wire."""

    def overlaps(self, states: np.ndarray) -> np.ndarray:
        """By how much the wire runs into itself, or the circles that stand for it, shape (states,), mm."""

    def beyond_ends(self, states: np.ndarray) -> np.ndarray:
        """By how much coils reach beyond the planes of the wire's tips, shape (states,), mm; negative between
        these."""

    def pair_friction(self, states: np.ndarray, histories: np.ndarray) -> Friction:
        """What sliding and its hindrance do to every pair, by the contact histories of the states."""

    def centreline(self, state: np.ndarray, phases: np.ndarray) -> np.ndarray:
        """Deformed wire at the phases given, shape (phases, 3), mm."""


@dataclass(frozen=True, eq=False)
class EquilibriumPath:
    """Equilibria of a scene at the requested times, as far as they were reached.

    A path equals itself alone: compare two by `coilspring.curves.compare_paths`. Arrays found from its states
    cannot be written.

    Attributes
    ----------
    scene, model, options : what was solved, by which model, with which numerics.
    times : (steps,) times reached, 0 left out.
    states : (steps, n) the model's own state vectors.
    iterations : (steps,) factorisations since the previous row, rejected attempts included.
    least_gaps : (steps,) least gap of the contact pairs known by then, mm, infinite where there are none; at
        most 0 on plates, and where sticking holds an open pair.
    outcome : one of `OUTCOMES`.
    message : one sentence.
    shape : reads the states, for what the properties below give.
    histories : (steps, pairs) records `coilspring.contact.law.PAIR_HISTORY` of what contact remembered of
        each pair when the state was found; None for traced paths.
    critical_time : middle of the time bracket of a critical point, or None.
    critical_bracket : length of that bracket, or None.
    undecided_time : time from which on coils can hold each other by other forces as well, since sticking
        pairs graze, friction snapped, or Coulomb's law is unstable just ahead: beyond it the answer may
        depend on the steps; or None.
    end_bracket : times between which a path ends that did not complete, or None.
    last_state : (n,) the last equilibrium of such a path, at the first of these times, or None.
    total_iterations : factorisations in all, those after the last row included.
    stability_checks : further factorisations, which only verified the stability of linear stretches.
    pair_evaluations : contact pairs evaluated in all residuals together.
    residual_history : last Newton decrements over the reference work of the load, oldest first.
    negative_pivots : (steps,) of traced paths: 0 where the equilibrium is stable; None for followed
        ones, whose equilibria are all stable.
    solve_seconds, compile_seconds : CPU time of the solve alone; wall time spent making its kernels
        ready.
    accuracy, estimated_error : of the load curve, asked for and estimated, or None: see `wirefe.solve_to`.
    other_seconds : CPU time of the other solves that the choice of the mesh and the estimate took.
    """

    scene: Scene
    model: str
    options: Mapping[str, object]
    times: np.ndarray
    states: np.ndarray
    iterations: np.ndarray
    least_gaps: np.ndarray
    outcome: str
    message: str
    shape: Shape
    histories: np.ndarray | None = None
    critical_time: float | None = None
    critical_bracket: float | None = None
    undecided_time: float | None = None
    end_bracket: tuple[float, float] | None = None
    last_state: np.ndarray | None = None
    total_iterations: int = 0
    stability_checks: int = 0
    pair_evaluations: int = 0
    residual_history: tuple[float, ...] = ()
    negative_pivots: np.ndarray | None = None
    solve_seconds: float = 0.0
    compile_seconds: float = 0.0
    accuracy: float | None = None
    estimated_error: float | None = None
    other_seconds: float = 0.0

    def __post_init__(self) -> None:
        lengths = [len(rows) for rows in (self.times, self.states, self.iterations, self.least_gaps)]
        if len(set(lengths)) > 1:
            raise ValueError(f"times, states, iterations and least_gaps differ in length: {lengths}")
        if self.outcome not in OUTCOMES:
            raise ValueError(f"outcome must be one of {OUTCOMES}, got {self.outcome!r}")

    def __str__(self) -> str:
        """The scene, the model and its options, the outcome, the last state, and what it cost."""
        options = ", ".join(f"{name} {value}" for name, value in self.options.items())
        cost = f"{counted(self.total_iterations, 'iteration')} in {self.solve_seconds:.3g} s"
        lines = [f"{self.scene.name} by {self.model} ({options})", f"{self.outcome}: {self.message}"]
        if len(self.times):
            ux, uy, rotz = self.tips[-1]
            lines.append(f"time {self.times[-1]:.6g}: UX {ux:.6g} mm, UY {uy:.6g} mm, ROTZ {rotz:.6g} rad")
            cost = (
                f"{self.active_contacts[-1]} of {self.gaps.shape[1]} contact pairs closed, penetration up to "
                f"{self.max_penetration[-1]:.3g} mm; {cost}"
            )
        return "\n".join((*lines, cost))

    def __getstate__(self) -> dict[str, Any]:
        """What was solved; what is found from it is found again."""
        return {item.name: getattr(self, item.name) for item in fields(self)}

    def save(self, file: str | Path | BinaryIO) -> None:
        """Write the path to an npz file, or a binary stream, that `coilspring.load_path` reads."""
        write_fields(self.__getstate__(), file)

    def select(self, rows: slice) -> EquilibriumPath:
        """The path with some of its rows alone; iterations are those since the row before that is left."""

        def some(values: np.ndarray | None) -> np.ndarray | None:
            return None if values is None else values[rows]

        return replace(
            self,
            times=self.times[rows],
            states=self.states[rows],
            iterations=np.diff(np.cumsum(self.iterations)[rows], prepend=0),
            least_gaps=self.least_gaps[rows],
            histories=some(self.histories),
            negative_pivots=some(self.negative_pivots),
        )

    @cached_property
    def loads(self) -> np.ndarray:
        """Load at the top reference point, shape (steps, 2), N; with a prescribed displacement all that holds
        the top there, FX where UX is held."""
        if not self.scene.load.displacement:
            return read_only(given_loads(self.scene.load, self.times))
        assert self.histories is not None  # paths traced by arc length are under forces
        held = np.array(["ux" in self.scene.supports.top_held, True])
        return read_only(np.where(held, self.shape.reactions(self.states, self.histories), 0.0))

    @cached_property
    def tips(self) -> np.ndarray:
        """UX, UY, ROTZ of the top reference point, shape (steps, 3); mm, rad (not wrapped)."""
        return read_only(self.shape.tips(self.states))

    @cached_property
    def contact_forces(self) -> np.ndarray:
        """Normal force of every contact pair, shape (steps, pairs), N; pairs from bottom to top."""
        return read_only(self.shape.pair_forces(self.states))

    @cached_property
    def gaps(self) -> np.ndarray:
        """Gap of every contact pair, negative where it penetrates, shape (steps, pairs), mm."""
        return read_only(self.shape.pair_gaps(self.states))

    @property
    def penetrations(self) -> np.ndarray:
        """Penetration of every contact pair, 0 where open, shape (steps, pairs), mm."""
        return np.maximum(-self.gaps, 0.0)

    @cached_property
    def friction(self) -> Friction:
        """Tangential force, slip and frictional work of every contact pair.

        Raises
        ------
        InputError : the path was traced by arc length, which keeps no contact history.
        """
        if self.histories is None:
            raise InputError("friction needs a followed path, got one traced by arc length")
        found = self.shape.pair_friction(self.states, self.histories)
        return Friction(*(read_only(getattr(found, item.name)) for item in fields(found)))

    @property
    def active_contacts(self) -> np.ndarray:
        """Number of closed pairs, shape (steps,)."""
        return np.count_nonzero(self.penetrations > 0.0, axis=1)

    @property
    def max_penetration(self) -> np.ndarray:
        """Largest penetration, shape (steps,), mm; 0 where nothing touches."""
        return self.penetrations.max(axis=1, initial=0.0)

    @cached_property
    def max_overlap(self) -> np.ndarray:
        """Largest overlap of the wire with itself, all coils against all, shape (steps,), mm; 0 if free.

        Of the equivalent beam that of its circles; coils that have changed places overlap by what they
        do side by side.
        """
        return read_only(np.maximum(self.shape.overlaps(self.states), 0.0))

    @cached_property
    def rates(self) -> np.ndarray:
        """Rate of the spring along its load, dF/du, shape (steps,), N/mm: the tangent stiffness, in some rows
        the difference from the row before; see Rate in ``docs/conventions.md``."""
        return read_only(self.rates_at(slice(None)))

    def rates_at(self, rows: slice) -> np.ndarray:
        """The `rates` of some steps."""
        mu, directions = self.shape.pair_law.mu, load_directions(self.scene, self.times)
        histories = None if self.histories is None else self.histories[rows]
        if histories is not None and 0.0 < mu < np.inf and self.scene.contact.enabled:
            return secants(self, directions)[rows]
        try:  # a path that was loaded may have a user's law that this process does not know
            tangents = self.shape.rates(self.states[rows], histories, directions[rows])
        except InputError:
            return secants(self, directions)[rows]
        if histories is None or not self.scene.contact.enabled:
            return tangents
        released = histories["released"]  # all of it where the pair is free, nothing where it is pressed
        grazing = (histories["grazes"] & (released > 0.0) & (released < 1.0)).any(axis=-1)
        return np.where(grazing, secants(self, directions)[rows], tangents) if grazing.any() else tangents

    @cached_property
    def max_stress(self) -> np.ndarray | None:
        """Largest shear stress in the wire, shape (steps,), MPa; None of the equivalent beam.

        16 |T| / (pi d^3) of the torsional moment T, with Bergstraesser's factor; see `wirefe.stress`.
        """
        found = self.shape.largest_stresses(self.states, self.histories)
        return None if found is None else read_only(found)

    @property
    def curve(self) -> dict[str, np.ndarray]:
        """The load curve, the first columns of ``path.csv``, each (steps,)."""
        ux, uy, rotz = self.tips.T
        x, y = self.loads.T
        return {"time": self.times, "load_x": x, "load_y": y, "ux": ux, "uy": uy, "rotz": rotz}

    @property
    def columns(self) -> dict[str, np.ndarray]:
        """The columns of ``path.csv`` by name, each (steps,); ``max_stress`` of the wire model alone."""
        stress = {} if self.max_stress is None else {"max_stress": self.max_stress}
        return {
            **self.curve,
            "iterations": self.iterations,
            "active_contacts": self.active_contacts,
            "max_penetration": self.max_penetration,
            "max_overlap": self.max_overlap,
            "rate": self.rates,
            **stress,
        }

    @cached_property
    def table(self) -> pd.DataFrame:
        """One row for each time reached, with the columns of ``path.csv``."""
        import pandas as pd

        return pd.DataFrame(self.columns)

    def centreline(self, step: int, points_per_turn: int = 40) -> np.ndarray:
        """Deformed wire at a stored step, end turns included, shape (points, 3), mm."""
        first, last = self.scene.spring.phase_range
        turns = (last - first) / (2.0 * np.pi)
        phases = np.linspace(first, last, round(turns * points_per_turn) + 1)
        return self.shape.centreline(self.states[require_step(self, step)], phases)

    def circle_centres(self, step: int) -> np.ndarray:
        """Centres of the circles in which the wire meets the working plane, shape (circles, 2), mm."""
        state = self.states[require_step(self, step)]
        return self.shape.centreline(state, self.scene.spring.circle_phases())[:, :2]

    @property
    def top(self) -> np.ndarray:
        """Position and rotation (x, y, rotz) of the top reference point, shape (steps, 3); mm, rad."""
        return self.tips + np.array([0.0, self.scene.spring.active_height, 0.0])


def read_only(array: np.ndarray) -> np.ndarray:
    """The array, or a view of it, that cannot be written."""
    view = array.view()
    view.flags.writeable = False
    return view


def require_step(path: EquilibriumPath, step: object) -> int:
    """Return `step`, or raise `InputError` unless it is the number of a stored step, -1 of the last one."""
    count = len(path.times)
    if isinstance(step, Integral) and not isinstance(step, bool) and -count <= int(step) < count:
        return int(step)
    allowed = f", an integer in [{-count}, {count - 1}]" if count else ""
    raise InputError(f"step must be one of the {count} of the path{allowed}, got {shown(step)}")


def require_path(path: object, needs: str) -> EquilibriumPath:
    """Return `path`, or raise `InputError`, which says what is needed, unless it is a path."""
    if not isinstance(path, EquilibriumPath):
        raise InputError(f"{needs}, got {shown(path)}")
    return path


def shape_of(path: object, model: str, needed_by: str) -> Any:
    """What reads the states of a path of `model`, or raise `InputError`: a function needs such a path."""
    needs = f"{needed_by} needs a path of the model {model}"
    found = require_path(path, needs)
    if found.model != model:
        raise InputError(f"{needs}, got {found.model}")
    return found.shape


def load_path(file: str | Path | BinaryIO) -> EquilibriumPath:
    """Path that `EquilibriumPath.save` has written; its model is imported.

    Raises
    ------
    InputError : no such file, or one that is no path.
    """
    found = read_fields(file)
    try:
        return EquilibriumPath(**found)
    except (TypeError, ValueError):  # fields, or an outcome, of another version
        raise InputError(OTHER_VERSION.format(str(file))) from None


def secants(path: EquilibriumPath, directions: np.ndarray) -> np.ndarray:
    """Change of the force over that of the deflection since the row before; nan where nothing moved."""
    force, deflection = (
        np.einsum("ij,ij->i", np.diff(values[:, :2], axis=0, prepend=0.0), directions)
        for values in (path.loads, path.tips)
    )
    return np.divide(force, deflection, out=np.full_like(force, np.nan), where=deflection != 0.0)
