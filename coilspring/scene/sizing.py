"""Closed-form numbers of a spring, as a designer looks at them before any model is run.

After EN 13906-1 (rate, stress with Bergstraesser's factor, buckling), taken coil by coil so that they
hold for coils of any diameter and pitch. Of contact they know that coils which have closed give no more.
"""

import math
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from coilspring.scene.load import Load
from coilspring.scene.profile import TWO_PI, closest
from coilspring.scene.scene import HELD_CHOICES, Scene
from coilspring.scene.solidwire import SOLID_POISSON, inner_stress_factor, wire_flexibility
from coilspring.scene.spring import Spring

POINTS = 129  # of a section, at which nonlinear quantities are evaluated
POINTS_PER_TURN = 72
SINES = 12  # of which the first surge is made
ROUNDING = 1e-9  # of the travel to solid
QUADRATURE = 8  # Gauss points of a turn of wire
# Effective over real length of a column whose bottom is clamped, by what holds the top.
SEATING = {(): 2.0, ("ux",): 0.7, ("rotz",): 1.0, ("ux", "rotz"): 0.5}


@dataclass(frozen=True)
class Sizes:
    """Numbers of a scene's spring at rest and under its axial load."""

    wire_length: float  # end turns included, mm
    index: tuple[float, float]  # least and largest coil index D/d
    total_coils: float  # end turns included
    # over the wire, mm, or over the ground ends, where half of the wire is taken off each tip
    free_length: float
    solid_length: float  # coils of different diameter nest
    # between neighbouring active coils, in the plane through the axis, mm; None below one coil
    least_gap: float | None
    helix_angle: float  # largest, rad
    rate: float  # axial, while no coils touch, by the textbook's formula, N/mm
    # the same of a wire by beam theory and by three-dimensional elasticity, with its pitch and ends that do
    # not turn; nan where Poisson's ratio is outside what the latter is fitted to
    wire_rates: tuple[float, float]
    closing: tuple[float, float]  # axial force at which the first and the last coil would close, N
    # largest axial one of the scene's load that compresses, or pulls if none compresses, positive in
    # compression, N; of a prescribed displacement the force that goes with it, infinite beyond solid
    force: float
    shortening: float  # by this force, mm, coils that close taken out
    pull: float  # largest axial force of the load that pulls, N; 0 where none does
    stress: float  # largest shear stress under both, MPa; coils that have closed give no more
    stressed_at: float  # in turns from the first active point
    stressed_by: float  # axial force that the coil there carries, N
    stress_factor: float  # of the wire's curvature, in it
    inner_factors: tuple[float, float]  # the same there by Wahl and by three-dimensional elasticity
    # lowest natural frequency of the active wire along the axis, both ends held, without load or contact, Hz
    surge: float
    buckling: float | None  # shortening at which the straight spring buckles, mm; None where it does not

    @property
    def travel(self) -> float:
        """From free to solid, mm."""
        return self.free_length - self.solid_length


class Along(NamedTuple):
    """What varies from coil to coil."""

    turns: np.ndarray  # from the first active point
    diameter: np.ndarray  # of the coil, mm
    pitch: np.ndarray  # mm
    closing: np.ndarray  # axial force at which neighbours of such a coil would close, N
    gap: np.ndarray  # closing distance of such a coil, mm


def along(scene: Scene) -> Along:
    """Active coils from bottom to top, at points of every section."""
    spring, d, share = scene.spring, scene.spring.wire_diameter, np.linspace(0.0, 1.0, POINTS)
    ends = np.array([(section.mean_diameter, section.pitch) for section in spring.coils])
    diameter, pitch = np.moveaxis(ends[..., :1] * (1.0 - share) + ends[..., 1:] * share, 1, 0)
    gap = np.maximum(pitch - _solid_pitches(spring)[:, None], 0.0)
    closing = scene.material.G * d**4 / 8.0 * gap / diameter**3
    knots = spring.profile.knots / TWO_PI
    turns = knots[:-1, None] + np.diff(knots)[:, None] * share
    return Along(*(values.ravel() for values in (turns, diameter, pitch, closing, gap)))


def sizes(scene: Scene) -> Sizes:
    """Closed-form numbers of a scene's spring; see `Sizes`."""
    spring, d, coils = scene.spring, scene.spring.wire_diameter, along(scene)
    rate = axial_rate(scene)
    held = "uy" in scene.supports.top_held
    # without contact no coil closes
    touching = (
        coils if scene.contact.enabled else coils._replace(closing=np.full_like(coils.closing, math.inf))
    )
    force, shortening, pull = (0.0, 0.0, 0.0) if held else _axial(scene.load, rate, touching)
    index = coils.diameter / d
    # a coil that has closed carries no more than what closed it
    carried = np.maximum(np.minimum(max(force, 0.0), touching.closing), pull)
    stress = stress_factor(index) * 8.0 * carried * coils.diameter / (math.pi * d**3)
    worst = float(index[np.argmax(stress)])
    active = wire_length(replace(spring, end_turns=0.0))
    mass = scene.material.density * 1e-12 * math.pi / 4.0 * d**2 * active  # t
    low, high = spring.height(np.array(spring.phase_range)).tolist()
    free = high - low + (0.0 if scene.supports.seat == "plate" else d)
    return Sizes(
        wire_length=wire_length(spring),
        index=(float(index.min()), float(index.max())),
        total_coils=spring.active_coils + 2.0 * spring.end_turns,
        free_length=free,
        solid_length=free - spring.active_height + solid_height(spring),
        least_gap=least_gap(spring),
        helix_angle=float(np.arctan(coils.pitch / (math.pi * coils.diameter)).max()),
        rate=rate,
        wire_rates=(wire_rate(scene, "beam"), wire_rate(scene, "solid")),
        closing=(float(coils.closing.min()), float(coils.closing.max())),
        force=force,
        shortening=shortening,
        pull=pull,
        stress=float(stress.max()),
        stressed_at=float(coils.turns[np.argmax(stress)]),
        stressed_by=float(carried[np.argmax(stress)]),
        stress_factor=float(stress_factor(worst)),
        inner_factors=(wahl_factor(worst), inner_stress_factor(worst)),
        surge=surge_number(coils) / TWO_PI * math.sqrt(rate / mass),
        buckling=buckling_shortening(scene),
    )


def surge_number(coils: Along) -> float:
    """First angular frequency along the axis between held ends, over sqrt(rate / mass).

    It is pi for a cylinder, whose frequency is 1/2 sqrt(rate / mass), d / (2 pi n D^2) sqrt(G / 2 rho).
    Any spring is taken for a rod with the compliance and the mass of its coils, -u'' = w^2 u dm/dx in the
    share x of the compliance, and its deflection for a sum of sines (Rayleigh and Ritz).
    """
    turns, middle = np.diff(coils.turns), 0.5 * (coils.diameter[1:] + coils.diameter[:-1])
    compliance, mass = middle**3 * turns, np.hypot(math.pi * coils.diameter, coils.pitch)
    mass = 0.5 * (mass[1:] + mass[:-1]) * turns
    x = (np.cumsum(compliance) - 0.5 * compliance) / compliance.sum()
    waves = math.pi * np.arange(1, SINES + 1)
    modes = math.sqrt(2.0) * np.sin(np.outer(waves, x)) / waves[:, None]
    return float(1.0 / math.sqrt(np.linalg.eigvalsh(modes * (mass / mass.sum()) @ modes.T)[-1]))


def solid_height(spring: Spring) -> float:
    """Height of the active part where all its coils touch, mm; coils of different diameter nest."""
    pitches = _solid_pitches(spring).tolist()
    return sum(pitch * section.coils for pitch, section in zip(pitches, spring.coils, strict=True))


def nests(spring: Spring) -> bool:
    """Whether coils of a section do not touch as they are compressed, but pass inside one another."""
    return bool((_solid_pitches(spring) == 0.0).any())


def axial_rate(scene: Scene) -> float:
    """Axial rate while no coils touch, N/mm."""
    cubes = 0.0  # integral of D^3 over the coils, by Simpson's rule, which is exact
    for section in scene.spring.coils:
        bottom, top = section.mean_diameter
        cubes += section.coils * (bottom**3 + 4.0 * (0.5 * (bottom + top)) ** 3 + top**3) / 6.0
    return scene.material.G * scene.spring.wire_diameter**4 / 8.0 / cubes


def wire_rate(scene: Scene, wire_rigidity: str) -> float:
    """Axial rate while no coils touch, of a wire on its helix whose ends do not turn about the axis, N/mm.

    nan where "solid" is not fitted to the material.
    """
    spring, material = replace(scene.spring, wire_rigidity=wire_rigidity), scene.material
    if wire_rigidity == "solid" and not SOLID_POISSON[0] <= material.nu <= SOLID_POISSON[1]:
        return math.nan
    phases, weights = _gauss(spring)
    R, c = spring.radius(phases), spring.rise(phases)
    slant = np.hypot(R, c)
    t, b, none = c / slant, R / slant, np.zeros_like(R)
    force = np.stack((t, none, b, R * b, none, -R * t), axis=-1)  # axial, through the axis
    couple = np.stack((none, none, none, t, none, b), axis=-1)
    wrenches = np.stack((force, couple), axis=-1)
    F = wire_flexibility(replace(spring, hand="right"), material)(phases)  # either hand has this rate
    C = np.einsum("n,nia,nij,njb->ab", weights * slant, wrenches, F, wrenches)
    return float(1.0 / (C[0, 0] - C[0, 1] ** 2 / C[1, 1]))


def _axial(load: Load, rate: float, coils: Along) -> tuple[float, float, float]:
    """Force and shortening, N and mm, and the pull of a load history, N; see `Sizes`."""
    ends = load.displacement or [y for _, y in load.stages or (load.force,)]
    least, most = 0.0 - max(ends), 0.0 - min(ends)
    largest, pulled = most if most > 0.0 else least, max(0.0 - least, 0.0)
    if not load.displacement:
        return largest, shortened(coils, rate, largest), pulled
    forces = np.unique(coils.closing)  # between them the shortening is linear in the force
    distances = np.array([shortened(coils, rate, force) for force in forces])
    if largest <= distances[0]:
        return rate * largest, largest, rate * pulled
    solid = largest > distances[-1] * (1.0 + ROUNDING)
    return (math.inf if solid else float(np.interp(largest, distances, forces))), largest, rate * pulled


def shortened(coils: Along, rate: float, force: float) -> float:
    """Shortening under an axial force, mm: coils close one by one, and then give no more."""
    if force <= coils.closing.min():
        return force / rate
    share = np.minimum(force, coils.closing) / np.maximum(coils.closing, np.finfo(float).tiny)
    return float(np.trapezoid(share * coils.gap, coils.turns))


def stress_factor(index: Any) -> Any:
    """Bergstraesser's factor of the stress at the inside of a coil of index D/d (EN 13906-1)."""
    return (index + 0.5) / (index - 0.75)


def bending_factor(index: Any) -> Any:
    """Factor of the bending stress at the inside of a coil of index D/d (EN 13906-3)."""
    return (index + 0.07) / (index - 0.75)


def wahl_factor(index: float) -> float:
    """Wahl's factor of the same stress."""
    return (4.0 * index - 1.0) / (4.0 * index - 4.0) + 0.615 / index


def middle_diameter(spring: Spring) -> float:
    """Mean over the coils of their diameter, mm."""
    return sum(sum(each.mean_diameter) * each.coils for each in spring.coils) / 2.0 / spring.active_coils


def wire_length(spring: Spring) -> float:
    """Length of the wire, end turns included, mm."""
    phases, weights = _gauss(spring)
    first, _ = spring.derivatives(phases)
    active = (weights * np.linalg.norm(first, axis=1)).sum()
    turns = np.hypot(math.pi * np.array(spring.mean_diameter), spring.end_pitch)
    return float(active + spring.end_turns * turns.sum())


def _gauss(spring: Spring) -> tuple[np.ndarray, np.ndarray]:
    """Phases of the active wire and their weights in an integral over the phase."""
    knots = spring.profile.knots
    edges = [
        np.linspace(low, high, math.ceil(section.coils), endpoint=False)
        for low, high, section in zip(knots[:-1], knots[1:], spring.coils, strict=True)
    ]
    at = np.concatenate([*edges, knots[-1:]])
    nodes, weights = np.polynomial.legendre.leggauss(QUADRATURE)
    half = 0.5 * np.diff(at)[:, None]
    return (at[:-1, None] + half * (1.0 + nodes)).ravel(), (half * weights).ravel()


def least_gap(spring: Spring) -> float | None:
    """Least gap between active coils one turn apart, in the plane through the axis, mm."""
    turns = spring.active_coils - 1.0
    if turns < 0.0:
        return None
    lower = np.linspace(0.0, TWO_PI * turns, math.ceil(turns * POINTS_PER_TURN) + 1)
    upper = lower + TWO_PI
    distance = np.hypot(
        spring.radius(upper) - spring.radius(lower), spring.height(upper) - spring.height(lower)
    )
    return max(float(distance.min()) - spring.wire_diameter, 0.0)  # coils that touch, but for rounding


def buckling_shortening(scene: Scene) -> float | None:
    """Shortening at which the spring buckles as a column of its mean coil diameter (EN 13906-1), mm.

    The clause's formula, solved so that it holds for G = E too; None where the column does not buckle,
    or where the scene's supports are none of the standard's.
    """
    spring, ratio = scene.spring, scene.material.G / scene.material.E
    seating = SEATING.get(scene.supports.top_held)
    if seating is None or scene.supports.bottom_held != HELD_CHOICES:
        return None
    square = (math.pi * middle_diameter(spring) / (seating * spring.active_height)) ** 2 / (0.5 + ratio)
    under = 1.0 - (1.0 - ratio) * square
    return 0.5 * spring.active_height * square / (1.0 + math.sqrt(under)) if under >= 0.0 else None


def _solid_pitches(spring: Spring) -> np.ndarray:
    """Pitch of each section's coils where they touch, mm.

    Neighbours are a turn apart: in a section shorter than that, the radius changes from coil to coil as it
    does over the turn about the section's middle.
    """
    knots, coils = spring.profile.knots, np.array([section.coils for section in spring.coils])
    turns = np.clip(coils, min(1.0, spring.active_coils), None)
    half = 0.5 * TWO_PI * turns
    middle = np.clip(0.5 * (knots[1:] + knots[:-1]), half, knots[-1] - half)
    steps = np.abs(spring.radius(middle + half) - spring.radius(middle - half)) / turns
    return np.array([closest(spring.wire_diameter, step) for step in steps.tolist()])
