"""The random springs on which the laws are compared: kinds of load and support, shapes, size of the load."""

import math
from collections.abc import Callable, Container, Iterator
from dataclasses import dataclass, replace

import numpy as np

import equivbeam
from coilspring import CoilSection, Contact, Load, Scene, Spring
from coilspring.scene import Supports
from coilspring.scene.sizing import along, buckling_shortening, shortened, sizes

STEPS = 10
SHAPES = ("cylinder", "cone", "barrel", "progressive")
INDEX, COILS = (4.0, 15.0), (3, 20)
PITCH = (1.3, 0.25)  # least, mm; largest is 1 mm and this share of the mean diameter
TAPER, PROGRESS = (0.5, 1.0), (0.3, 1.0)  # ratio of the diameters of a cone; of gaps between coils
CONTACT, DEEP = 0.75, 0.75  # share of the scenes with contact; of those, loaded until coils close
BELOW, ABOVE = (0.3, 1.0), 0.9  # of the first closing load; least of it where coils are to close
LAST, SEVERAL = 0.9, 4.0  # of the axial load between first and last closing; of a first closing load
BUCKLING, SOLID, SWAY = 0.8, 0.95, 0.7  # most shortening over that of buckling, over the travel; most UX / L
SIDE = 0.05  # side force of a combined load over the axial one
DRAWS = 50  # of a spring that must not be loaded until coils close
PROBE = 1e-3  # of a closing load, at which rates are taken


@dataclass(frozen=True)
class Kind:
    """A kind of load and support."""

    name: str  # as tables have it
    held: tuple[str, ...]  # of the top
    side: float = 0.0  # Fx over the size of the load
    axial: tuple[float, float] = (1.0, 1.0)  # least and largest -Fy over it
    displacement: bool = False  # whether UY is prescribed in place of the force

    @property
    def is_axial(self) -> bool:
        """Whether the load is mostly axial."""
        return self.axial[0] == 1.0


KINDS = (
    Kind("guided, axial force", ("ux", "rotz")),
    Kind("guided, displacement", ("ux", "rotz"), displacement=True),
    Kind("pinned, axial force", ("ux",)),
    Kind("free top, axial force", ()),
    Kind("free top, lateral", (), 1.0, (0.0, 1.0)),
    Kind("guided top, lateral", ("rotz",), 1.0, (0.0, 1.0)),
    Kind("free top, combined", (), SIDE),
    Kind("guided top, combined", ("rotz",), SIDE),
)


@dataclass(frozen=True)
class Drawn:
    """A random scene, and what it was drawn as."""

    seed: int
    number: int
    kind: str
    shape: str
    scene: Scene


def plain(rng: np.random.Generator, spring: Spring) -> Spring:
    """The spring as it was drawn."""
    return spring


def population(
    seed: int,
    each: int,
    names: Container[str] | None = None,
    form: Callable[[np.random.Generator, Spring], Spring] = plain,
) -> Iterator[Drawn]:
    """Random scenes of one seed, `each` of every kind, or of those named; none depends on which are drawn.

    `form` makes springs of another form of those drawn.
    """
    for place, kind in enumerate(KINDS):
        for number in range(each if names is None or kind.name in names else 0):
            rng = np.random.default_rng((seed, place, number))
            shape, scene = _scene(rng, kind, f"{kind.name} {seed}/{number}", form)
            yield Drawn(seed, number, kind.name, shape, scene)


def _scene(rng: np.random.Generator, kind: Kind, name: str, form: Callable) -> tuple[str, Scene]:
    """A shape and a scene; springs that would buckle or sway before coils close are drawn again."""
    contact = bool(rng.random() < CONTACT)
    deep = contact and bool(rng.random() < DEEP)
    for _ in range(DRAWS):
        shape = str(rng.choice(SHAPES))
        blank = Load((0.0, -1.0), STEPS)
        supports, law = Supports(kind.held), Contact(enabled=contact)
        scene = Scene(name, form(rng, _spring(rng, shape)), blank, supports=supports, contact=law)
        direction = np.array((kind.side * rng.choice((-1.0, 1.0)), -rng.uniform(*kind.axial)))
        first, several, most = _bounds(scene, direction)
        wanted = rng.uniform(ABOVE * first, several) if deep else rng.uniform(*BELOW) * first
        if wanted <= most or not deep:
            break
    x, y = (min(wanted, most) * direction).tolist()
    if not kind.displacement:
        return shape, replace(scene, load=Load((x, y), STEPS))
    spring = sizes(scene)  # the shortening under the load, mm
    shortening = min(shortened(along(scene), spring.rate, -y), SOLID * spring.travel)
    return shape, replace(scene, load=Load(steps=STEPS, displacement=(-shortening,)))


def _spring(rng: np.random.Generator, shape: str) -> Spring:
    """A spring of 1 mm wire."""
    halves = int(rng.integers(2 * COILS[0], 2 * COILS[1] + 1))
    wide = rng.uniform(*INDEX)
    narrow = max(wide * rng.uniform(*TAPER), INDEX[0]) if shape in ("cone", "barrel") else wide
    ends = (wide, narrow) if rng.random() < 0.5 else (narrow, wide)
    pitch = rng.uniform(PITCH[0], 1.0 + PITCH[1] * 0.5 * (wide + narrow))
    same = (pitch, pitch)
    phase = rng.uniform(0.0, 2.0 * math.pi)
    if shape == "barrel":
        low, high = halves // 2 / 2, (halves - halves // 2) / 2
        sections = (CoilSection(low, same, ends), CoilSection(high, same, ends[::-1]))
        return Spring.of_sections(1.0, sections, start_phase=phase)
    if shape == "progressive":
        pitches = (pitch, 1.0 + (pitch - 1.0) * rng.uniform(*PROGRESS))
        return Spring.of_sections(1.0, (CoilSection(halves / 2, pitches, ends),), start_phase=phase)
    return Spring(1.0, ends, halves / 2, pitch * halves / 2, start_phase=phase)


def _bounds(scene: Scene, direction: np.ndarray) -> tuple[float, float, float]:
    """Multiples of a load at which a first coil closes, several have, and the most that is put on."""
    coils = along(scene)
    first, last = float(coils.closing.min()), float(coils.closing.max())
    most = _buckling_force(scene) / -direction[1] if direction[1] else math.inf
    if direction[0] == 0.0:
        return first, first + LAST * (last - first), most
    probe = PROBE * first
    x, y = (probe * direction).tolist()
    path = equivbeam.solve(replace(scene, load=Load((x, y), 2), contact=Contact()))
    half, whole = path.gaps
    rest, rate = 2.0 * half - whole, half - whole
    closing = rate > 1e-9 * rest
    sway = SWAY * scene.spring.active_height * probe / abs(float(path.tips[-1, 0]))
    solid = last / -direction[1] if direction[1] else math.inf
    first = min(0.5 * probe * float((rest[closing] / rate[closing]).min()), solid)
    return first, min(SEVERAL * first, solid), min(most, sway)


def _buckling_force(scene: Scene) -> float:
    """Axial force at `BUCKLING` of the shortening at which the column buckles, N; infinite if it does not."""
    shortening, coils = buckling_shortening(scene), along(scene)
    if shortening is None:
        return math.inf
    forces = np.unique([0.0, *coils.closing])
    rate = sizes(scene).rate
    shortenings = [shortened(coils, rate, force) for force in forces]
    return float(np.interp(BUCKLING * shortening, shortenings, forces, right=math.inf))
