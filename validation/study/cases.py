"""The paper's four cases, what it prints of them, and how it solves them; two more springs of the studies."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import Any

from coilspring import CATALOGUE, Contact, Load, Scene, Spring, Supports
from validation.study.models import PAPER_LAW

# the paper's proposed model, solved with the exact tangent
PAPER_BEAM: dict[str, Any] = {"law": PAPER_LAW, "tangent": "exact", "sliding": "ignore"}
# the paper's FE mesh (its Table 2)
PAPER_MESH: dict[str, Any] = {"element": "straight", "elements_per_turn": 40, "pairs_per_turn": 4}
FINE_MESH = PAPER_MESH | {"elements_per_turn": 80}  # to estimate the error of that mesh

# UX, UY in mm, ROTZ in rad at two times: rigid end turns and the default material, integrated by shooting
# to 1e-10. Our own numbers, not published ones.
EXACT_ROD: Mapping[str, Mapping[float, tuple[float, float, float]]] = {
    "spring-a-no-contact": {0.5: (-13.325870, -3.912853, 0.707779), 1.0: (-21.260191, -10.464994, 1.200717)},
    "spring-b-no-contact": {0.5: (0.0, -12.476115, 0.0), 1.0: (0.0, -25.060823, 0.0)},
}

SPHERES = Contact(geometry="spheres")  # as the paper's mesh and the catalogue have them


def paper_mesh(scene: Scene) -> dict[str, Any]:
    """The paper's mesh for a scene; of stations of wires, which it lacks, the wire model's own number."""
    return PAPER_MESH if scene.contact.geometry == "spheres" else PAPER_MESH | {"pairs_per_turn": None}


@dataclass(frozen=True)
class PaperCase:
    """One row of the paper's Table 3."""

    name: str  # scene of the catalogue
    title: str  # as the paper calls it
    paper_wire: float  # the paper's solution time of FE, s
    paper_beam: float  # the paper's solution time of the proposed model, s
    paper_reduction: float  # as the paper prints it, %

    @property
    def scene(self) -> Scene:
        """The scene that is solved."""
        return CATALOGUE[self.name]()


CASES = (
    PaperCase("spring-a", "Spring A", 154.0, 24.0, 84.0),
    PaperCase("spring-a-no-contact", "Spring A w/o contacts", 81.0, 38.0, 53.0),
    PaperCase("spring-b", "Spring B", 122.0, 8.0, 93.0),
    PaperCase("spring-b-no-contact", "Spring B w/o contacts", 68.0, 4.0, 94.0),
)


def case(name: str) -> PaperCase:
    """The case of a catalogue scene."""
    return next(item for item in CASES if item.name == name)


def turned(scene: Scene, degrees: float) -> Scene:
    """The scene with the helix started at another phase."""
    return replace(scene, spring=replace(scene.spring, start_phase=math.radians(degrees)))


def study_scenes() -> dict[str, Scene]:
    """The four cases of the paper and two more springs, by name."""
    cylinder = Scene(
        name="cylinder-lateral",
        spring=Spring(wire_diameter=1.0, mean_diameter=(10.0, 10.0), active_coils=8.0, active_height=24.0),
        load=Load((1.5, -5.0)),
        contact=SPHERES,
    )
    slender = Scene(  # its wire model buckles at 14.4 N
        name="slender-axial",
        spring=Spring(wire_diameter=1.0, mean_diameter=(8.0, 8.0), active_coils=20.0, active_height=60.0),
        load=Load((0.0, -12.0)),
        supports=Supports(("ux", "rotz")),
        contact=SPHERES,
    )
    return {name: make() for name, make in CATALOGUE.items()} | {s.name: s for s in (cylinder, slender)}
