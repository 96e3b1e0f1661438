"""Numbers of a spring and of its model by name, and derivatives of the tip's displacements by them."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from operator import attrgetter
from typing import Any, NamedTuple, cast

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.contact.law import PAIR_HISTORY, normal_law
from coilspring.errors import InputError, require_choice
from coilspring.path import EquilibriumPath, shape_of
from coilspring.scene import Scene
from coilspring.scene.material import Material
from coilspring.words import shown
from equivbeam import band, kernels
from equivbeam.model import BeamModel, build_model, matrix_size, with_tangent
from equivbeam.options import BeamOptions
from equivbeam.shape import BeamShape

STEP = 6e-6  # relative, for central differences of what is smooth: the cube root of the rounding
_normal_law = np.vectorize(normal_law, otypes="ddd")  # one by one: a law for numbers may branch
FACTORS = ("axial", "shearing", "bending")  # of the paper's stiffnesses


class Parameter(NamedTuple):
    """A number of a part of the scene."""

    part: str
    read: Callable[[Any], float]
    changed: Callable[[Any, float], Any]  # the part that has another value


def _field(part: str, name: str) -> Parameter:
    return Parameter(part, attrgetter(name), lambda of, value: replace(of, **{name: value}))


def _diameter(read: Callable, ends: Callable) -> Parameter:
    """A number read from the mean diameters at bottom and top, and these where it has another value."""
    return Parameter(
        "spring",
        lambda spring: read(*spring.mean_diameter),
        lambda spring, value: replace(spring, mean_diameter=ends(value, *spring.mean_diameter)),
    )


def _widened(value: float, bottom: float, top: float) -> tuple[float, float]:
    """Both diameters by the same factor, so that their mean is the value."""
    share = 2.0 * value / (bottom + top)
    return share * bottom, share * top


AT_NU = "E at nu"  # both moduli in proportion, which a fit of E moves where the material gives nu
OF_ALL_COILS = ("mean_diameter", "bottom_diameter", "top_diameter", "pitch")  # sections have their own
PARAMETERS: Mapping[str, Parameter] = {
    "wire_diameter": _field("spring", "wire_diameter"),
    "mean_diameter": _diameter(lambda bottom, top: 0.5 * (bottom + top), _widened),
    "bottom_diameter": _diameter(lambda bottom, top: bottom, lambda value, bottom, top: (value, top)),
    "top_diameter": _diameter(lambda bottom, top: top, lambda value, bottom, top: (bottom, value)),
    "pitch": Parameter(
        "spring",
        attrgetter("pitch"),
        lambda spring, pitch: replace(spring, active_height=pitch * spring.active_coils),
    ),
    "E": Parameter("material", attrgetter("E"), lambda of, E: Material.from_moduli(E, of.G, of.density)),
    "G": Parameter("material", attrgetter("G"), lambda of, G: Material.from_moduli(of.E, G, of.density)),
    AT_NU: _field("material", "E"),
    "penalty": _field("contact", "stiffness"),
    "exponent": _field("contact", "exponent"),
    **{name: _field("factors", name) for name in FACTORS},
}
NAMES = tuple(name for name in PARAMETERS if name != AT_NU)
UNITS = {"E": "MPa", "G": "MPa"} | dict.fromkeys(("wire_diameter", *OF_ALL_COILS), "mm")


def values(scene: Scene, names: tuple[str, ...]) -> np.ndarray:
    """Values of the parameters named; `InputError` for a name that is none of `NAMES`, or of the scene's."""
    for name in names:
        if name != AT_NU:
            require_choice("parameters", name, NAMES)
        if scene.spring.sections and name in OF_ALL_COILS:
            others = ", ".join(other for other in NAMES if other not in OF_ALL_COILS)
            raise InputError(
                f"{name} cannot be fitted or varied where the spring has sections, each with its own; "
                f"the parameters are then {others}"
            )
    wanted = (PARAMETERS[name] for name in names)
    return np.array([each.read(getattr(scene, each.part)) for each in wanted])


def distinct_names(parameters: Sequence[str]) -> tuple[str, ...]:
    """Names of parameters; `InputError` for none, the same twice, or a text in place of a list."""
    names = tuple(parameters) if isinstance(parameters, list | tuple) else ()
    if not names or not all(isinstance(name, str) for name in names) or len(set(names)) < len(names):
        raise InputError(f"parameters must be a list of different names, got {shown(parameters)}")
    return names


def unit(scene: Scene, name: str) -> str:
    """Unit of a parameter of a scene; empty for a pure number."""
    if name == "penalty":
        exponent = scene.contact.exponent
        return "N/mm" if exponent == 1.0 else f"N/mm^{exponent:g}"
    return UNITS.get(name, "")


def varied(scene: Scene, names: tuple[str, ...], new: np.ndarray) -> Scene:
    """The scene with other values of the parameters named."""
    for name, value in zip(names, new.tolist(), strict=True):
        part, _, changed = PARAMETERS[name]
        scene = replace(scene, **{part: changed(getattr(scene, part), value)})
    return scene


def rise(scene: Scene, name: str) -> float:
    """Change of the height at rest, from where displacements are counted, with a parameter."""
    return scene.spring.active_coils if name == "pitch" else 0.0


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
        Of wire_diameter, mean_diameter, bottom_diameter, top_diameter, pitch, E, G, penalty, exponent, and
        with the paper's law the factors axial, shearing, bending. E and G vary one without the other.

    Raises
    ------
    InputError : unknown name, a diameter or the pitch of a spring of sections, another model's path, or one
        with friction or a prescribed displacement.
    """
    names = distinct_names(parameters)
    shape: BeamShape = shape_of(path, "equivbeam", "sensitivities")
    if shape.data.mu > 0.0 and path.scene.contact.enabled:
        raise InputError("sensitivities needs a path without friction, got sliding = 'scene'")
    if path.scene.load.displacement:
        raise InputError("sensitivities needs a path under forces, got one of load.displacement")
    at = values(path.scene, names)
    tips = np.empty((len(path.times), len(names), 3))
    packed, factors = pack(shape.data), np.empty((len(path.times), matrix_size(shape.data)))
    _gradients(shape.assemble, with_tangent(shape.data), path.states, factors)
    for F in factors:
        band.factor(*packed, F)
    for i, name in enumerate(names):
        moves, lift = -_residual_rates(path, name, at[i]), rise(path.scene, name)
        for row, (move, F) in enumerate(zip(moves, factors, strict=True)):
            move[-3:] *= 1.0 - shape.data.fixed
            band.solve(*packed, F, move)
            tips[row, i] = move[-3:] - np.array([0.0, lift, 0.0])
    return Sensitivity(names, at, tips)


def _gradients(assemble: Callable, data: BeamModel, states: np.ndarray, matrices: np.ndarray) -> np.ndarray:
    """Gradients of the energy at states, (steps, n); sets the matrices there too, unless they are empty."""
    packed, history = pack(data), np.zeros(len(data.pairs), PAIR_HISTORY)
    gradients = np.empty((len(states), states.shape[1] - 3))
    for state, g, H in zip(states, gradients, matrices, strict=True):
        assemble(*packed, state, 0.0, history, state, g, H)
    return gradients


def _residual_rates(path: EquilibriumPath, name: str, value: float) -> np.ndarray:
    """Rates of the residual at fixed states, shape (steps, n)."""
    chosen = BeamOptions.of(path.options)

    def half_coils(scene: Scene) -> np.ndarray:
        data = build_model(scene.without_contact(), chosen)
        no_matrices = np.empty((len(path.states), 0))
        assemble = kernels.assemble_of(chosen.law, data.rows.shape[1])
        return _gradients(assemble, data, path.states, no_matrices)

    def rate(read: Callable[[Scene], Any]) -> Any:
        return _rate(read, path.scene, name, value)

    rates = rate(half_coils)
    if path.scene.contact.enabled:
        rates += _contact_rates(path, lambda read: rate(lambda scene: read(build_model(scene, chosen))))
    return rates


def _rate(read: Callable[[Scene], Any], scene: Scene, name: str, value: float) -> Any:
    """Rate with a parameter of what is read of a scene, by differences of second order."""
    h = STEP * value

    def at(steps: float) -> Any:
        return read(varied(scene, (name,), np.array([value + steps * h])))

    try:
        return (at(1.0) - at(-1.0)) / (2.0 * h)
    except InputError:  # at an end of its range, as an exponent of 1
        pass
    try:
        return (4.0 * at(1.0) - 3.0 * at(0.0) - at(2.0)) / (2.0 * h)
    except InputError:
        return (3.0 * at(0.0) - 4.0 * at(-1.0) + at(-2.0)) / (2.0 * h)


def _contact_rates(path: EquilibriumPath, rate: Callable) -> np.ndarray:
    """Contact's part of these; `rate` gives the rate with the parameter of what is read of a model.

    A difference over the whole residual would open and close hard pairs, which penetrate by less than its
    step moves them. So differences are of what varies smoothly, where the circles stand and the numbers of
    the law; the force follows by the law's own derivative, of the pairs that touch in the state.
    """
    shape, states = cast("BeamShape", path.shape), path.states
    data, (first, second) = shape.data, shape.data.pairs.T
    arms, moves = (shape.arms(states, each) for each in (data.offset, rate(attrgetter("offset"))))
    w, dw = shape.pair_vectors(states)[..., :2], moves[:, second] - moves[:, first]
    h = np.linalg.norm(w, axis=-1, keepdims=True)
    n, pressed = w / h, np.maximum(data.d - h, 0.0)
    _, F, slope = _normal_law(pressed, data.kc, data.k)
    dh = (n * dw).sum(axis=-1, keepdims=True)
    dF = rate(lambda model: _normal_law(pressed, model.kc, model.k)[1])
    dF = np.where(pressed > 0.0, dF + slope * (rate(attrgetter("d")) - dh), 0.0)
    f, df = -F * n, -dF * n - F * (dw - dh * n) / h  # the energy's gradient in the pair's vector, its rate
    rates = np.zeros((len(data.rows) + 1, len(states), 3))
    for circles, sign in ((first, -1.0), (second, 1.0)):
        moment = _cross(arms[:, circles], df) + _cross(moves[:, circles], f)
        each = sign * np.concatenate((df, moment), axis=-1)
        np.add.at(rates, data.attached[circles], each.swapaxes(0, 1))
    return rates[1:].swapaxes(0, 1).reshape(len(states), -1)


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Component out of the plane of the vector product, (..., 1)."""
    return a[..., :1] * b[..., 1:] - a[..., 1:] * b[..., :1]
