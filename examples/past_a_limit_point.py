"""Spring B without friction: its path ends before full load, and arc length goes on from there."""

from dataclasses import replace

import wirefe
from coilspring import Contact, EquilibriumNotFound, EquilibriumPath, spring_b


def main() -> tuple[float, EquilibriumPath]:
    """Print and return where the path turns, and the path traced past that."""
    scene = replace(spring_b(), contact=Contact(geometry="spheres"))
    mesh = {"element": "curved", "elements_per_turn": 8}
    try:
        wirefe.solve(scene, **mesh)
    except EquilibriumNotFound as ended:
        turn = ended.critical_time
        print(f"{ended.outcome} at {turn:.4f} of the load: {-turn * scene.load.force[1]:.1f} N")
    traced = wirefe.trace(scene, points=56, **mesh)
    print(f"traced {len(traced.times)} equilibria, {sum(traced.negative_pivots > 0)} of them unstable")
    return turn, traced


if __name__ == "__main__":
    main()
