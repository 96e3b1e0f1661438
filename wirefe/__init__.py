"""3D beam-FE model of the coiled wire with contact of wires or spheres: the reference; and of any wire."""

from coilspring.sweep import Outcome
from wirefe.adaptive import solve_to
from wirefe.results.stress import WireStress, stress
from wirefe.results.vibration import Mode, frequencies, modes
from wirefe.rod import Rod, RodPath, curved_rod, straight_rod
from wirefe.solve import path_shape, solve, solve_rod, sweep
from wirefe.tracing import trace, trace_rod

__all__ = [
    "Mode",
    "Outcome",
    "Rod",
    "RodPath",
    "WireStress",
    "curved_rod",
    "frequencies",
    "modes",
    "path_shape",
    "solve",
    "solve_rod",
    "solve_to",
    "straight_rod",
    "stress",
    "sweep",
    "trace",
    "trace_rod",
]
