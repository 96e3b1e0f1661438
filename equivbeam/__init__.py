"""2D equivalent beam on the spring axis, after Haringx, with contact between the coils' circles."""

from coilspring.sweep import Outcome
from equivbeam.calibration import Calibration, calibrate
from equivbeam.column import Buckling, buckling, lateral_stiffness
from equivbeam.laws.helix import Refinements
from equivbeam.sensitivity import Sensitivity, sensitivities
from equivbeam.solve import path_shape, solve, sweep

__all__ = [
    "Buckling",
    "Calibration",
    "Outcome",
    "Refinements",
    "Sensitivity",
    "buckling",
    "calibrate",
    "lateral_stiffness",
    "path_shape",
    "sensitivities",
    "solve",
    "sweep",
]
