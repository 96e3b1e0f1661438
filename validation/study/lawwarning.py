"""By how much the paper's law is off for a scene: it does not know where in a turn coils begin and end."""

import math
from dataclasses import replace

import numpy as np

import equivbeam
from coilspring import EquilibriumNotFound, InputError, Load, Scene
from coilspring.curves import COMPONENTS
from coilspring.scene.sizing import axial_rate
from validation.study.models import HELIX_LAW, PAPER_LAW

SMALL = 1e-4  # of the active height: about as far does the top move
DOUBTFUL = 0.1  # of a component of the tip
SLIGHT = 0.05  # of the largest component: one that is smaller does not count


def law_warning(scene: Scene) -> str:
    """A sentence where law haringx differs from law helix, or nothing.

    The tip is compared under a small load without contact, which takes a millisecond. Not of a law that was
    fitted, nor where law helix has no answer.
    """
    if scene.factors.given:
        return ""
    height = scene.spring.active_height
    forces = np.array(scene.load.stages or (scene.load.force,)) * scene.supports.free
    fx, fy = max(forces.tolist(), key=lambda force: math.hypot(*force))
    if scene.load.displacement or (fx, fy) == (0.0, 0.0):
        fx, fy = 0.0, -1.0
    size = SMALL * height * axial_rate(scene) / math.hypot(fx, fy)
    try:
        small = replace(scene.without_contact(), load=Load((size * fx, size * fy), 1))
        laws = [equivbeam.solve(small, law=law).tips[-1] for law in (PAPER_LAW, HELIX_LAW)]
    except (EquilibriumNotFound, InputError):
        return ""
    paper, helix = np.array(laws) * (1.0, 1.0, height)
    large = np.maximum(abs(paper), abs(helix)) > SLIGHT * max(abs(paper).max(), abs(helix).max())
    off = np.where(large, abs(paper - helix) / np.maximum(abs(helix), SLIGHT * abs(helix).max()), 0.0)
    if off.max() < DOUBTFUL:
        return ""
    much = f"{100.0 * off.max():.0f} % in {COMPONENTS[int(off.argmax())]}"
    return f"under a small load law haringx differs by {much} from law helix, which knows where coils begin"
