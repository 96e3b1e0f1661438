"""The scenes of the paper (Table 1)."""

from dataclasses import replace

from coilspring.scene.load import Load
from coilspring.scene.scene import Contact, Scene, Supports
from coilspring.scene.spring import Spring


def spring_a() -> Scene:
    """Spring A: a cylinder bent and compressed by its free top; contact of spheres, as in Table 2."""
    return Scene(
        name="spring-a",
        spring=Spring(wire_diameter=1.5, mean_diameter=(10.0, 10.0), active_coils=14.5, active_height=28.6),
        load=Load(force=(-9.0, -4.0)),
        contact=Contact(geometry="spheres"),
    )


def spring_b() -> Scene:
    """Spring B: a cone compressed between held ends; no sliding, as the paper's FE model had it."""
    return Scene(
        name="spring-b",
        spring=Spring(wire_diameter=1.5, mean_diameter=(12.0, 6.0), active_coils=7.5, active_height=28.6),
        load=Load(force=(0.0, -200.0)),
        supports=Supports(top_held=("ux", "rotz")),
        contact=Contact(sliding="none", geometry="spheres"),
    )


def _bare(scene: Scene) -> Scene:
    return replace(scene.without_contact(), name=f"{scene.name}-no-contact")


CATALOGUE = {
    "spring-a": spring_a,
    "spring-a-no-contact": lambda: _bare(spring_a()),
    "spring-b": spring_b,
    "spring-b-no-contact": lambda: _bare(spring_b()),
}
