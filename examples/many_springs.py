"""A random sample of cones on all cores: which of them reach full load, and which telescope before."""

from collections import Counter
from collections.abc import Iterator

import numpy as np

import equivbeam
from coilspring import Load, Scene, Spring, Supports

COUNT = 200


def sample(count: int, seed: int = 1) -> Iterator[Scene]:
    """Draw cones as large as Spring B, of other wires and tapers, under 100 to 300 N."""
    draw = np.random.default_rng(seed)
    for number in range(count):
        top = draw.uniform(6.0, 12.0)
        yield Scene(
            name=f"cone {number}",
            spring=Spring(draw.uniform(1.2, 1.8), (12.0, top), active_coils=7.5, active_height=28.6),
            load=Load(force=(0.0, -draw.uniform(100.0, 300.0))),
            supports=Supports(top_held=("ux", "rotz")),
        )


def main() -> Counter[str]:
    """Print and return how many springs had which outcome."""
    found = Counter(each.outcome for each in equivbeam.sweep(sample(COUNT), steps=1))
    for outcome, count in found.most_common():
        print(f"{count:4} {outcome}")
    return found


if __name__ == "__main__":
    main()
