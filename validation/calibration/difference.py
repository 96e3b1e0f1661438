"""By how much a model's load curve differs from a measured one."""

import math
from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from coilspring import EquilibriumPath, InputError, Load, Scene
from coilspring.measured import MOST_STEPS, Measured, equal_steps
from coilspring.scene.load import stage_ends
from coilspring.words import counted

BEYOND = 1e-6  # share of a path's last load by which a measured point may exceed it: digits of a file
FAR = 0.1  # rms difference, over the peak, of curves that may not be of one spring


def undirected(scene: Scene) -> str:
    """Why force cannot be drawn over deflection, in one sentence; empty where the load has one direction."""
    try:
        _ = scene.direction
    except InputError as error:
        return str(error)
    return ""


def along_load(path: EquilibriumPath) -> tuple[np.ndarray, np.ndarray]:
    """Deflection, mm, and force, N, in the direction of the scene's load, from the unloaded spring on."""
    d = np.array(path.scene.direction)
    return np.append(0.0, path.tips[:, :2] @ d), np.append(0.0, path.loads @ d)


def scene_for(scene: Scene, curve: Measured) -> Scene:
    """The scene to solve for a comparison with a curve: as it is where its steps include the measured points.

    Else in steps that do, or in so many that interpolation leaves 1e-4 of the peak at most; of several stages
    those up to the largest load.
    """
    load, ends = scene.load, stage_ends(scene.load) @ scene.direction
    last = int(np.argmax(ends))
    shares = (curve.deflection if load.displacement else curve.force) / ends[last]
    shares = shares[(shares > 0.0) & (shares <= 1.0)]
    steps = math.ceil(MOST_STEPS * np.abs(np.diff(ends[: last + 1])).max() / ends[last])
    steps = equal_steps(shares) if last == 1 and shares.size else steps
    if load.steps >= MOST_STEPS or load.steps % steps == 0:
        return scene
    stages, pressed = load.stages[:last], load.displacement[:last]
    force = stages[-1] if stages else load.force
    return replace(scene, load=Load(force, steps, stages=stages, displacement=pressed))


def differences(path: EquilibriumPath, curve: Measured) -> tuple[np.ndarray, np.ndarray]:
    """Deflections of the measured points that a model reached, and shares of the peak by which it differs."""
    deflection, force = along_load(path)
    model, measurement = (force, deflection), (curve.force, curve.deflection)
    turn = -1 if path.scene.load.displacement else 1  # the force is then the answer
    (given, answer), (mine, theirs) = model[::turn], measurement[::turn]
    # of a history of several stages what loads further than before
    loading = np.append(True, given[1:] > np.maximum.accumulate(given)[:-1])
    reached = (mine >= 0.0) & (mine <= given[loading][-1] * (1.0 + BEYOND))
    found = np.interp(mine[reached], given[loading], answer[loading])
    return curve.deflection[reached], (found - theirs[reached]) / np.abs(theirs).max()


def difference(path: EquilibriumPath, curve: Measured) -> dict[str, Any]:
    """Model minus measurement, shares of the peak, not a number where no point can be compared.

    ``max``, ``rms``: of the deflection at the same force; where a displacement is prescribed, of the force at
    the same deflection. ``points`` are compared, ``beyond`` are those that the model did not reach.
    """
    _, shares = differences(path, curve)
    most = float(np.abs(shares).max()) if shares.size else np.nan
    rms = float(np.sqrt(np.mean(shares**2))) if shares.size else np.nan
    return {"max": most, "rms": rms, "points": shares.size, "beyond": curve.force.size - shares.size}


def summary(paths: Mapping[str, EquilibriumPath], curve: Measured) -> dict[str, object]:
    """What ``compare.json`` holds of a measured curve."""
    found = {name: difference(path, curve) for name, path in paths.items()}
    return {"points": int(curve.force.size), "left_out": curve.left_out, **found}


def lines(paths: Mapping[str, EquilibriumPath], curve: Measured) -> list[str]:
    """The differences for a reader at the terminal."""
    said = []
    for name, path in paths.items():
        found = difference(path, curve)
        if not found["points"]:
            said.append(f"{name} minus measured: no measured point is within the model's path")
            continue
        pressed = path.scene.load.displacement
        what = "force at the same deflection" if pressed else "deflection at the same force"
        sizes = f"{100 * found['max']:.3g} % of the peak at most, {100 * found['rms']:.3g} % rms"
        beyond = f"; {found['beyond']} outside the model's path left out" if found["beyond"] else ""
        points = counted(found["points"], "point")
        said.append(f"{name} minus measured, {what}: {sizes}, at {points}{beyond}")
    return [*said, *([curve.passed_over] if curve.left_out else [])]


def warnings(paths: Mapping[str, EquilibriumPath], curve: Measured) -> list[str]:
    """Why the curve may not be one of this spring, in a sentence each."""
    said = list(curve.warnings)
    for name, path in paths.items():
        if (rms := difference(path, curve)["rms"]) > FAR:
            by = f"{name} and the measured curve differ by {100 * rms:.2g} % of the peak rms"
            if name == "wirefe" and path.scene.factors.given:
                said.append(f"{by}, perhaps since it takes no [factors], which are of the paper's law alone")
                continue
            said.append(f"{by}: are the spring, the units and the deflection at rest those of the scene?")
    return said
