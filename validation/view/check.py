"""What a scene file describes: closed-form numbers, warnings, and which models can represent it."""

import math
from collections.abc import Callable
from pathlib import Path

import numpy as np

import equivbeam
from coilspring import InputError, Scene
from coilspring.scene import SEATS
from coilspring.scene.scene import require_motion
from coilspring.scene.sizing import sizes
from equivbeam.model import build_model
from equivbeam.validity import taut
from validation.study import scenewarnings
from validation.study.lawwarning import law_warning
from validation.study.models import MODELS
from validation.study.partialsolve import partial_path
from validation.study.template import template
from validation.view.held import held_wire
from wirefe.mesh import mesh_wire

STEEPEST = 7.5  # degrees; EN 13906-1:2013, to which its formulas apply
LEFT_OUT = "; its friction, or what makes its coils stick, with --sliding scene alone"
OFF = 0.1  # share of the rate of a formula, from which there is a warning
ELEMENTS_PER_TURN = 40  # of the wire model, where nothing is said
Progress = Callable[[str], None]
WORDS = template(Path(__file__).with_name("check.txt"))


def report(scene: Scene, progress: Progress = lambda line: None) -> tuple[list[str], list[str]]:
    """Lines that say what a scene is, and warnings; `progress` is called before what is solved for them."""
    found = sizes(scene)
    (low, high), angle = found.index, math.degrees(found.helix_angle)
    held = held_wire(scene) if scene.supports.seat == "rigid" else None
    text = WORDS.render(
        name="".join(c if c.isprintable() else repr(c)[1:-1] for c in scene.name),
        **{"scene": scene, "spring": scene.spring, "sizes": found, "solid": math.isinf(found.force)},
        index=scenewarnings.ends_text(found.index),
        index_varies=not math.isclose(low, high),
        angle=angle,
        unknown=math.isnan(found.wire_rates[1]),
        sideways=_sideways(scene),
        held=held,
    )
    models = (f"  {model:<13} {_verdict(model, scene, progress)}" for model in MODELS)
    warnings = scenewarnings.warnings(scene)
    if float(f"{angle:.3g}") > STEEPEST:  # as it is printed
        steep = f"helix angle up to {angle:.3g} degrees, above {STEEPEST:g}"
        warnings.append(f"{steep}: the formulas leave it out")
    few = scene.spring.active_coils < scenewarnings.LEAST_COILS
    if held and few and abs(held.rate - found.rate) > OFF * held.rate:
        warnings.append(
            f"held by its supports, the wire of so few coils has a rate of {held.rate:.4g} N/mm at rest, "
            "which the formulas of rate, closing, deflection, stress and frequency leave out"
        )
    if scene.supports.seat == "plate":
        warnings.append(
            "the rate is that of rigid end turns: on plates springs are softer, by 6 to 14 % where measured"
        )
    return [*text.rstrip("\n").split("\n"), *models], warnings


def _sideways(scene: Scene) -> float:
    """Largest force across the axis that no support takes, N."""
    if "ux" in scene.supports.top_held:
        return 0.0
    return max(abs(x) for x, _ in scene.load.stages or (scene.load.force,))


def _drawn(scene: Scene, progress: Progress) -> str:
    """What the equivalent beam says of coils drawn far, or nothing; it is solved where a load may draw them,
    since the kernels may have to be compiled for it."""
    forces = scene.load.stages or (scene.load.force,)
    if max(scene.load.displacement, default=0.0) <= 0.0 and all(y <= -abs(x) for x, y in forces):
        return ""
    progress("solving with equivbeam, without contact")
    bare = scene.without_contact().with_steps(1)
    path = partial_path(equivbeam.solve, bare)
    states, times = path.states, path.times
    if path.last_state is not None and path.end_bracket is not None:  # it ended before
        states, times = np.vstack((states, path.last_state)), np.append(times, path.end_bracket[0])
    return taut(bare, "haringx", states, times).strip()


def _verdict(model: str, scene: Scene, progress: Progress) -> str:
    """What a model says to a scene, with its usual mesh."""
    try:
        require_motion(scene)
        if model == "equivbeam":
            build_model(scene)
            sticks = scene.contact.enabled and scene.contact.sliding != "free"
            law = f"; {warning}: see --law helix" if (warning := law_warning(scene)) else ""
            drawn = f"; {said}" if (said := _drawn(scene, progress)) else ""
            return f"represents it{LEFT_OUT if sticks else ''}{law}{drawn}"
        # the parts that may refuse a scene; its spheres are many where coils are
        seat = scene.supports.require_supported("wirefe", SEATS)
        mesh_wire(scene.spring, ELEMENTS_PER_TURN, seat == "plate")
        return "represents it"
    except InputError as error:
        return str(error)
