"""The springs of the studies: the catalogue and two more."""

from __future__ import annotations

from coilspring import CATALOGUE, Load, Scene, Spring, Supports


def study_scenes() -> dict[str, Scene]:
    """The four cases of the paper and two more springs, by name."""
    cylinder = Scene(
        name="cylinder-lateral",
        spring=Spring(wire_diameter=1.0, mean_diameter=(10.0, 10.0), active_coils=8.0, active_height=24.0),
        load=Load((1.5, -5.0)),
    )
    slender = Scene(  # its wire model buckles at 14.4 N
        name="slender-axial",
        spring=Spring(wire_diameter=1.0, mean_diameter=(8.0, 8.0), active_coils=20.0, active_height=60.0),
        load=Load((0.0, -12.0)),
        supports=Supports(("ux", "rotz")),
    )
    return {name: make() for name, make in CATALOGUE.items()} | {s.name: s for s in (cylinder, slender)}
