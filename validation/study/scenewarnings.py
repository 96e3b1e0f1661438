"""What makes a scene doubtful before it is solved, in a sentence each."""

import math

from coilspring import Scene
from coilspring.scene.profile import TWO_PI
from coilspring.scene.sizing import Sizes, middle_diameter, nests, sizes
from coilspring.words import counted

# EN 13906-1:2013: ranges of cold-coiled springs to which its formulas apply
INDEX = (4.0, 20.0)
LEAST_COILS = 2.0
TOUCHING = 1e-3  # wire diameters
SOFTEST = 1000.0  # MPa; metals have 1e4 and more
THINNEST = 0.05  # mm; wire is drawn to about 0.1 for springs
POISSON = (0.2, 0.45)  # of most metals


def warnings(scene: Scene) -> list[str]:
    """Sentences on units, ranges of the standard, buckling, and coils that close or cannot."""
    spring, found, said = scene.spring, sizes(scene), []
    d, (low, high) = spring.wire_diameter, found.index
    if scene.material.E < SOFTEST:
        said.append(f"E is {scene.material.E:g} MPa, which looks like GPa: 206 GPa are 206000 MPa")
    if not POISSON[0] <= scene.material.nu <= POISSON[1]:
        said.append(
            f"Poisson's ratio is {scene.material.nu:.3g}: most metals have {POISSON[0]} to {POISSON[1]}"
        )
    if d < THINNEST:
        said.append(f"the wire diameter is {d:g} mm, which looks like metres: lengths are in mm")
    if abs(phase := spring.start_phase) > TWO_PI:
        said.append(
            f"the start phase is {phase:g} rad, which looks like degrees: "
            f"{phase:g} degrees are {math.radians(phase):.5g} rad"
        )
    if low < INDEX[0] or high > INDEX[1]:
        index = ends_text(found.index)
        said.append(f"index D/d is {index}, outside {INDEX[0]:g} to {INDEX[1]:g} (EN 13906-1)")
    if spring.active_coils < LEAST_COILS:
        coils = counted(spring.active_coils, "active coil")
        said.append(f"{coils}, less than {LEAST_COILS:g} (EN 13906-1)")
    if found.least_gap is not None and found.least_gap < TOUCHING * d:
        said.append("coils touch at rest")
    if nests(spring):
        said.append(
            "the radius changes by the wire diameter or more per coil: such coils pass inside one another "
            "without touching; check takes them to lie flat on a seat under all coils, which no model has"
        )
    return said + _of_load(scene, found)


def _of_load(scene: Scene, found: Sizes) -> list[str]:
    """Sentences on a load that pulls, buckles or closes a spring."""
    spring, said = scene.spring, []
    if found.pull:
        also = f" too, by up to {found.pull:.3g} N" if found.force > 0.0 else ""
        said.append(f"the axial load pulls{also}: a force or displacement that compresses is negative")
    if found.buckling is not None and found.shortening >= found.buckling:
        slender = spring.active_height / middle_diameter(spring)
        said.append(
            f"slenderness {slender:.3g}: as a column it buckles when shortened by {found.buckling:.3g} mm, "
            f"at about {found.buckling * found.rate:.3g} N (EN 13906-1; see also equivbeam.buckling)"
        )
    if found.force > found.closing[0] and not scene.contact.enabled:
        said.append("coils close under the load, and contact is not enabled")
    elif math.isinf(found.force):
        said.append(
            f"the prescribed shortening of {found.shortening:.3g} mm is beyond solid: "
            f"the spring has {found.travel:.3g} mm"
        )
    elif found.force > found.closing[1]:
        said.append(
            f"the axial load of {found.force:.3g} N is beyond solid: the last coil closes at "
            f"{found.closing[1]:.3g} N"
        )
    return said


def ends_text(ends: tuple[float, float]) -> str:
    """A range to three digits, as one number where both of its ends are."""
    return " to ".join(dict.fromkeys(f"{end:.3g}" for end in ends))
