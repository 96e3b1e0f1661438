"""The helix law on random springs, against the wire model at four start phases; part of the error budget."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

import equivbeam
import wirefe
from coilspring import Contact, Load, Material, Scene, Spring
from coilspring.scene import Supports
from coilspring.wire import Section, round_section
from validation.document import Block, Heading, Table, Text
from validation.metrics import NEGLIGIBLE
from validation.reached import as_far

COUNT, FIRST_SEED, STEPS = 200, 0, 10
WIRE = {"element": "curved", "elements_per_turn": 8}
PHASES = tuple(0.5 * math.pi * k for k in range(4))
KINDS = ("guided", "lateral, free top", "lateral, guided top")
HELD = (("ux", "rotz"), (), ("rotz",))
LISTED = 6  # of the worst
SLENDER = 5.0  # L/D from which a guided cylinder may buckle
FEW = 5.0  # coils, below which the ends' share in the wire shows
SHARE = 0.5  # of an error that is put down to one cause
SETTING = (
    f"{COUNT} springs, seeds {FIRST_SEED} to {FIRST_SEED + COUNT - 1}: index 4 to 15, 3 to 20 coils, "
    "cylinders and cones; load axial with a guided top, or lateral and axial with a free or guided top; "
    "axial load up to what closes the widest coil. Error of the load curve in per cent of the peak over "
    f"{STEPS} steps, as far as both go, against the wire model (8 curved elements a turn) at start phase "
    "0. *In its plane* is the plane across where the load is axial, the working plane elsewhere. *Mean of "
    "four phases* compares the means of both models over the start phases 0, 90, 180 and 270 degrees; with "
    "contact each phase has its spheres elsewhere, and the mean is one of four contact models."
)
WORKING = {"law": "helix", "plane": "working"}
BOTH = ((wirefe.solve, WIRE), (equivbeam.solve, WORKING))
BLIND = {"refinements": equivbeam.Refinements(ends=False)}


@dataclass(frozen=True)
class Sample:
    """One random spring: errors of its load curves in per cent of the peak, at phase 0 unless said."""

    seed: int
    kind: int
    spring: Spring
    helix: float  # in its plane
    working: float  # in the working plane
    blind: float  # there, without what held ends do
    haringx: float
    mean: float  # the helix law's mean over four phases against the wire's, in the working plane
    outcome: str
    bare: float  # as `helix`, without contact

    @property
    def slenderness(self) -> float:
        """Active height over the mean diameter."""
        return self.spring.active_height / float(np.mean(self.spring.mean_diameter))

    @property
    def reason(self) -> str:
        """What the error comes from, as far as the runs beside it tell."""
        if self.kind == 0 and self.slenderness > SLENDER:
            return "slender and guided: beyond buckling, where the wire bows out of any plane"
        if self.bare < SHARE * self.helix:
            return f"contact: {self.bare:.2f} % without; pairs out of the plane"
        if self.mean < SHARE * self.helix:
            return "coupling of the planes by few coils: the mean over four phases agrees"
        if self.spring.active_coils < FEW:
            return "few coils: out-of-plane motion that the ends hold"
        return "not explained by the runs beside it"


def random_scene(seed: int) -> tuple[Scene, int]:
    """A spring of index 4 to 15 and 3 to 20 coils, cylinder or cone, loaded up to coil contact at most."""
    rng = np.random.default_rng(seed)
    bottom, coils = rng.uniform(4.0, 15.0), round(2 * rng.uniform(3.0, 20.0)) / 2
    top = max(bottom * rng.uniform(0.5, 1.0), 4.0) if rng.random() < 0.5 else bottom
    if rng.random() < 0.5:
        bottom, top = top, bottom
    pitch = rng.uniform(1.3, 1.0 + 0.25 * 0.5 * (bottom + top))
    spring = Spring(1.0, (bottom, top), coils, coils * pitch)
    kind = int(rng.integers(3))
    force = _force(rng, spring, kind, round_section(1.0, Material()))
    scene = Scene(f"random {seed}", spring, Load(force, STEPS), Material(), Supports(HELD[kind]), Contact())
    return scene, kind


def _force(rng: np.random.Generator, spring: Spring, kind: int, wire: Section) -> tuple[float, float]:
    """A share of the axial load that closes the widest coil; a side load well below buckling."""
    gap, height = spring.pitch - 1.0, spring.active_height
    widest = 0.5 * max(spring.mean_diameter)
    axial = rng.uniform(0.3, 1.0) * gap * wire.GJ / (2.0 * math.pi * widest**3)
    if kind == 0:
        return 0.0, -axial
    radius = spring.radius(np.linspace(0.0, spring.phase_end, 2001))
    bending = radius.mean() * spring.phase_end * (0.5 / wire.GJ + 0.5 / wire.EI)
    shear = (radius**3).mean() * spring.phase_end * 0.5 / wire.EI
    stiffness = 1.0 / (shear + bending * height**2 * (1.0 / 3.0 if kind == 1 else 1.0 / 12.0))
    # Haringx's critical load of the clamped column, its top free or guided
    q, B, S = math.pi * (0.5 if kind == 1 else 1.0) / height, height / bending, height / shear
    critical = 0.5 * S * (math.sqrt(1.0 + 4.0 * q * q * B / S) - 1.0)
    axial = min(axial, 0.4 * critical)
    way = rng.uniform(0.1, 0.5) * min(spring.active_coils * gap, 0.3 * height)
    side = way * stiffness * (1.0 - axial / critical)
    return (side if rng.random() < 0.5 else -side), -axial


def sample(seed: int, contact: bool) -> Sample:
    """Solve one random spring by both laws and by the wire model at four phases."""
    scene, kind = random_scene(seed)
    bare = scene.without_contact()
    scene = scene if contact else bare
    phases = [turned(scene, phase) for phase in PHASES]
    wires, beams = ([_tips(solve, each, **o) for each in phases] for solve, o in BOTH)
    common = min(map(len, (*wires, *beams)))
    means = (np.mean([tips[:common] for tips in tips_of], axis=0) for tips_of in (beams, wires))
    path = as_far(equivbeam.solve, scene, law="helix")
    unclosed = path.tips if not contact else _tips(equivbeam.solve, bare, law="helix")
    return Sample(
        seed=seed,
        kind=kind,
        spring=scene.spring,
        helix=curve_error(path.tips, wires[0]),
        working=curve_error(beams[0], wires[0]),
        blind=curve_error(_tips(equivbeam.solve, scene, law="helix", **BLIND), wires[0]),
        haringx=curve_error(_tips(equivbeam.solve, scene), wires[0]),
        mean=curve_error(*means),
        outcome=path.outcome,
        bare=curve_error(unclosed, _tips(wirefe.solve, bare, **WIRE) if contact else wires[0]),
    )


def turned(scene: Scene, phase: float) -> Scene:
    """The scene with another start phase, rad."""
    return replace(scene, spring=replace(scene.spring, start_phase=phase))


def _tips(solve: Callable, scene: Scene, **options: object) -> np.ndarray:
    """Tips of a path as far as it is reached."""
    return as_far(solve, scene, **options).tips


def curve_error(tips: np.ndarray, reference: np.ndarray) -> float:
    """Largest difference at the same step over the reference's peak, worst component, per cent."""
    common = min(len(tips), len(reference))
    if common == 0:
        return math.nan
    peaks = np.abs(reference[:common]).max(axis=0)
    moved = peaks > NEGLIGIBLE * peaks.max()
    return float(100.0 * (np.abs(tips[:common] - reference[:common])[:, moved] / peaks[moved]).max())


def random_part() -> list[Block]:
    """The part of the page on random springs."""
    blocks: list[Block] = [
        Heading(2, "Random springs"),
        Text(SETTING),
    ]
    for contact in (False, True):
        found = [sample(seed, contact) for seed in range(FIRST_SEED, FIRST_SEED + COUNT)]
        blocks += _summary(found, contact)
    return blocks


def _summary(found: list[Sample], contact: bool) -> list[Block]:
    rows = []
    for name, values in (
        ("helix, in its plane", [item.helix for item in found]),
        ("helix, in its plane, guided springs", [item.helix for item in found if item.kind == 0]),
        ("helix, working plane", [item.working for item in found]),
        ("helix, working plane, guided springs", [item.working for item in found if item.kind == 0]),
        ("helix, working plane, mean of four phases", [item.mean for item in found]),
        ("helix, working plane, without `ends`", [item.blind for item in found]),
        ("Haringx", [item.haringx for item in found]),
    ):
        shown = (np.nanmedian(values), np.nanpercentile(values, 95), np.nanmax(values))
        rows.append((name, *(f"{value:.3f}" for value in shown)))
    ended = sum(item.outcome != "completed" for item in found)
    words = "With contact, frictionless" if contact else "Without contact"
    worst = sorted(found, key=lambda item: -item.helix)[:LISTED]
    return [
        Heading(3, words),
        Table(("law", "median", "95th percentile", "worst"), tuple(rows)),
        Text(f"Paths of the helix law that end at a critical point: {ended}. The worst in its plane:"),
        Table(
            (
                "seed",
                "support",
                "D",
                "coils",
                "L/D",
                "helix",
                "without `ends`",
                "mean of phases",
                "Haringx",
                "reason",
            ),
            tuple(_row(item) for item in worst),
        ),
    ]


def _row(item: Sample) -> tuple[str, ...]:
    bottom, top = item.spring.mean_diameter
    shape = f"{bottom:.1f}" if bottom == top else f"{bottom:.1f} to {top:.1f}"
    errors = (f"{value:.2f}" for value in (item.helix, item.blind, item.mean, item.haringx))
    return (
        *(str(item.seed), KINDS[item.kind], shape, f"{item.spring.active_coils:g}"),
        *(f"{item.slenderness:.1f}", *errors, item.reason),
    )
