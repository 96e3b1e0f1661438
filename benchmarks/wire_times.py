"""CPU time of the wire model: the paper's mesh, growth with the mesh, and the curved element's error by time.

Times are CPU seconds of the solution alone, single thread, warm, medians of interleaved repeats. The load
curves are compared with the curved element at 32 per turn, whose own error is told by 16 per turn.
"""

from __future__ import annotations

import argparse
from collections.abc import Callable, Sequence
from statistics import median

import numpy as np

import wirefe
from coilspring import EquilibriumPath, load_scene
from coilspring.curves import compare_paths

CASES = ("spring-a", "spring-a-no-contact", "spring-b", "spring-b-no-contact")
MESHES = (40, 80, 160, 320)
CURVED = (4, 8, 16)
REFERENCE = 32


def times(solvers: Sequence[Callable[[], EquilibriumPath]], repeats: int) -> list[tuple[float, float, float]]:
    """Median, least and largest CPU seconds of each solver, run in turn after a discarded run."""
    for solve in solvers:
        solve()
    rounds = [[solve().solve_seconds for solve in solvers] for _ in range(repeats)]
    return [(median(column), min(column), max(column)) for column in zip(*rounds, strict=True)]


def shown(time: tuple[float, float, float]) -> str:
    """Milliseconds with their spread."""
    middle, least, most = (1e3 * value for value in time)
    return f"{middle:8.1f} ms ({least:.1f} to {most:.1f})"


def paper_mesh(repeats: int) -> None:
    """The four cases, straight elements, 40 per turn, 50 steps."""
    print("straight, 40 per turn, 50 steps")
    solvers = [lambda name=name: wirefe.solve(load_scene(name)) for name in CASES]
    for name, time in zip(CASES, times(solvers, repeats), strict=True):
        print(f"  {name:22s}{shown(time)}")


def growth(repeats: int) -> None:
    """Spring A, straight elements, by number a turn, and the exponent of the growth."""
    print("spring-a, straight, 50 steps")
    scene = load_scene("spring-a")
    solvers = [lambda mesh=mesh: wirefe.solve(scene, elements_per_turn=mesh) for mesh in MESHES]
    found = times(solvers, repeats)
    for mesh, time in zip(MESHES, found, strict=True):
        print(f"  {mesh:4d} per turn        {shown(time)}")
    exponent = np.polyfit(np.log(MESHES), np.log([time[0] for time in found]), 1)[0]
    iterations = [solve().total_iterations for solve in solvers]
    print(f"  grows with exponent {exponent:.2f}; factorisations {iterations}")


def curved(repeats: int) -> None:
    """The curved element: time, error of the load curve, and observed order."""
    print(f"curved, 50 steps, against {REFERENCE} per turn")
    for name in CASES:
        scene = load_scene(name)
        solvers = [
            lambda mesh=mesh, scene=scene: wirefe.solve(scene, element="curved", elements_per_turn=mesh)
            for mesh in CURVED
        ]
        reference = wirefe.solve(scene, element="curved", elements_per_turn=REFERENCE)
        errors = [compare_paths(solve(), reference).curve_max for solve in solvers]
        order = np.log2(errors[0] / errors[1])
        for mesh, error, time in zip(CURVED, errors, times(solvers, repeats), strict=True):
            print(f"  {name:22s}{mesh:4d} per turn {shown(time)}  error {error:.1e}")
        print(f"  {'':22s} observed order {order:.1f}")


def main(arguments: Sequence[str] | None = None) -> int:
    """Print the times; returns the exit code."""
    parser = argparse.ArgumentParser(description="Time the wire model.")
    parser.add_argument("--repeats", type=int, default=5, help="timed rounds; default: 5")
    repeats = parser.parse_args(arguments).repeats
    paper_mesh(repeats)
    growth(repeats)
    curved(repeats)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
