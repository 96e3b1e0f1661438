"""A spring of one's own, described in Python, solved by both models and compared."""

import equivbeam
import wirefe
from coilspring import Load, Scene, Spring, Supports
from coilspring.curves import Comparison, compare_paths


def main() -> Comparison:
    """Print and return how far the equivalent beam is from the wire model."""
    scene = Scene(
        name="my spring",
        spring=Spring(
            wire_diameter=2.0, mean_diameter=(18.0, 12.0), active_coils=6.0, active_height=32.0
        ),  # mm
        load=Load(force=(0.0, -150.0), steps=20),  # N
        supports=Supports(top_held=("ux", "rotz")),
    )
    beam, wire = equivbeam.solve(scene), wirefe.solve(scene)
    found = compare_paths(beam, wire)
    print(f"UY at full load: beam {beam.tips[-1, 1]:.3f} mm, wire model {wire.tips[-1, 1]:.3f} mm")
    print(f"largest difference of the load curves {100 * found.curve_max:.2f} %")
    return found


if __name__ == "__main__":
    main()
