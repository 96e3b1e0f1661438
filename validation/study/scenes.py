"""The springs of the studies: the catalogue and two more; and tips of two of them as exact Cosserat rods."""

from collections.abc import Mapping

from coilspring import CATALOGUE, Contact, Load, Scene, Spring, Supports

# UX, UY in mm, ROTZ in rad at two times: rigid end turns and the default material, integrated by shooting
# to 1e-10. Our own numbers, not published ones.
EXACT_ROD: Mapping[str, Mapping[float, tuple[float, float, float]]] = {
    "spring-a-no-contact": {0.5: (-13.325870, -3.912853, 0.707779), 1.0: (-21.260191, -10.464994, 1.200717)},
    "spring-b-no-contact": {0.5: (0.0, -12.476115, 0.0), 1.0: (0.0, -25.060823, 0.0)},
}

SPHERES = Contact(geometry="spheres")  # as the paper's mesh and the catalogue have them


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
