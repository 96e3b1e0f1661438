"""Solids of CalculiX for `validation.solid.page`: ``python -m validation.solid.runs``, 15 minutes."""

from pathlib import Path

import pandas as pd

from coilspring import Material, load_scene
from validation.solid.comparison import COILS, coil, deflections, flexibilities
from validation.study.frames import write_csv

FOLDER = Path("reports/solid")
CASES = [(index, angle, COILS) for index in (4.0, 5.0, 20.0 / 3.0, 10.0) for angle in (5.0, 12.0)]
CASES.append((4.0, 5.0, 2.0 * COILS))  # what the ends do falls with the number of coils
SCENES = ("spring-b-no-contact",)  # Spring A's end turns: see `hexahedra.deflection`


def main() -> None:
    """Run and write flexibility.csv and deflection.csv."""
    FOLDER.mkdir(parents=True, exist_ok=True)
    coils, moved = [], []
    for index, angle, count in CASES:
        coils.append(flexibilities(coil(index, angle, count), Material(), count))
        coils[-1].insert(0, "index", index)
        coils[-1].insert(1, "angle", angle)
        print(coils[-1].to_string(), flush=True)
    write_csv(pd.concat(coils), FOLDER / "flexibility.csv")
    for name in SCENES:
        moved.append(deflections(load_scene(name)))
        moved[-1].insert(0, "scene", name)
        print(moved[-1].to_string(), flush=True)
    write_csv(pd.concat(moved), FOLDER / "deflection.csv", 8)


if __name__ == "__main__":
    main()
