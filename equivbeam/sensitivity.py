"""Derivatives of the tip's displacements, through the factored tangent."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.contact.law import PAIR_HISTORY
from coilspring.errors import InputError, shown
from coilspring.path import EquilibriumPath
from coilspring.scene import Scene
from equivbeam import band, kernels
from equivbeam.model import build_model, matrix_size
from equivbeam.options import BeamOptions
from equivbeam.parameters import rise, values, varied
from equivbeam.shape import BeamShape

STEP = 6e-6  # relative, for central differences of the residual: the cube root of the rounding


@dataclass(frozen=True)
class Sensitivity:
    """Derivatives of UX, UY and ROTZ at the top.

    Attributes
    ----------
    names : of the parameters.
    values : (parameters,) at which the derivatives hold.
    tips : (steps, parameters, 3) derivatives, mm or rad per unit of the parameter.
    """

    names: tuple[str, ...]
    values: np.ndarray
    tips: np.ndarray

    @property
    def relative(self) -> np.ndarray:
        """Change of the tip for a relative change of each parameter: derivative times value."""
        return self.tips * self.values[:, None]


def sensitivities(path: EquilibriumPath, parameters: Sequence[str]) -> Sensitivity:
    """Derivatives of the tip with respect to parameters, at every row of a path of the equivalent beam.

    At an equilibrium g(q, p) = t f the state moves by dq/dp = -H^-1 dg/dp (implicit differentiation),
    one back substitution a parameter. Where a pair is about to touch they are those of one side.

    Parameters
    ----------
    path : EquilibriumPath
        Of `equivbeam.solve`, without friction: with it the answer depends on the path.
    parameters : sequence of str
        Of wire_diameter, bottom_diameter, top_diameter, pitch, E, G, penalty, exponent, and with the
        paper's law the factors axial, shearing, bending. E and G vary one without the other.

    Raises
    ------
    InputError : unknown name, another model's path, or one with friction.
    """
    names = tuple(parameters)
    if not isinstance(path, EquilibriumPath):
        raise InputError(f"path must be an EquilibriumPath of equivbeam.solve, got {shown(path)}")
    shape = path.shape
    if not isinstance(shape, BeamShape):
        raise InputError(f"sensitivities needs a path of the model equivbeam, got {path.model}")
    if shape.data.mu > 0.0 and path.scene.contact.enabled:
        raise InputError("sensitivities needs a path without friction, got sliding = 'scene'")
    if path.scene.load.displacement:
        raise InputError("sensitivities needs a path under forces, got one of load.displacement")
    at = values(path.scene, names)
    tips = np.empty((len(path.times), len(names), 3))
    factored = [_factored(shape, state) for state in path.states]
    for i, name in enumerate(names):
        rates = _residual_rates(path, names[i : i + 1], at[i])
        lift = rise(path.scene, name)
        for row, (reals, ints, F) in enumerate(factored):
            move = -rates[row]
            move[-3:] *= 1.0 - shape.data.fixed
            band.solve(reals, ints, F, move)
            tips[row, i] = move[-3:] - np.array([0.0, lift, 0.0])
    return Sensitivity(names, at, tips)


def _factored(shape: BeamShape, state: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The packed model and its factored matrix at a state."""
    data = shape.data
    reals, ints = pack(data)
    F, history = np.empty(matrix_size(data)), np.zeros(len(data.pairs), PAIR_HISTORY)
    shape.assemble(reals, ints, state, 0.0, history, state, np.empty(state.size - 3), F)
    band.factor(reals, ints, F)
    return reals, ints, F


def _residual_rates(path: EquilibriumPath, name: tuple[str, ...], value: float) -> np.ndarray:
    """Rates of the residual at fixed states, shape (steps, n), by differences of second order."""
    h = STEP * value

    def at(steps: float) -> np.ndarray:
        return _residuals(path, varied(path.scene, name, np.array([value + steps * h])))

    try:
        return (at(1.0) - at(-1.0)) / (2.0 * h)
    except InputError:  # at the lower end of its range, as an exponent of 1
        return (4.0 * at(1.0) - 3.0 * at(0.0) - at(2.0)) / (2.0 * h)


def _residuals(path: EquilibriumPath, scene: Scene) -> np.ndarray:
    """Gradients of the energy of another scene at the states of the path, shape (steps, n)."""
    chosen = BeamOptions.of(path.options)
    data = build_model(scene, chosen)
    assemble = kernels.assemble_of(chosen.law, data.rows)
    reals, ints = pack(data)
    history = np.zeros(len(data.pairs), PAIR_HISTORY)
    g = np.empty((len(path.states), path.states.shape[1] - 3))
    for state, row in zip(path.states, g, strict=True):
        assemble(reals, ints, state, 0.0, history, state, row, np.empty(0))
    return g
