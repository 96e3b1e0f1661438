"""What a scene file describes: closed-form numbers, warnings, and which models can represent it."""

from __future__ import annotations

import math
from collections.abc import Iterator

from coilspring import InputError, Scene
from coilspring.scene import SEATS
from coilspring.scene.sizing import Sizes, sizes
from equivbeam.model import build_model
from validation.study.scenewarnings import warnings
from wirefe.mesh import mesh_wire

STEEPEST = 7.5  # degrees; EN 13906-1:2013, to which its formulas apply
LEFT_OUT = "; what keeps its coils from sliding with --sliding scene alone"
ELEMENTS_PER_TURN = 40  # of the wire model, where nothing is said


def report(scene: Scene) -> tuple[list[str], list[str]]:
    """Lines that say what a scene is, and warnings."""
    found = sizes(scene)
    models = [f"  {model:<13} {verdict}" for model, verdict in _models(scene)]
    lines = [f"{scene.name}: a valid scene", *_lines(scene, found), *models]
    return lines, [*warnings(scene), *_of_formulas(found)]


def _lines(scene: Scene, found: Sizes) -> Iterator[str]:
    spring = scene.spring
    low, high = found.index
    index = f"{low:.3g}" if math.isclose(low, high) else f"{low:.3g} to {high:.3g}"
    yield f"  wire          {spring.wire_diameter:g} mm, {found.wire_length:.4g} mm long; index D/d {index}"
    kind = f"{spring.ends} ends" if spring.end_turns else "no end turns"
    parts = f" in {len(spring.sections)} sections" if spring.sections else ""
    yield (
        f"  coils         {spring.active_coils:g} active{parts}, {found.total_coils:g} in all; "
        f"{kind}, {spring.hand}-handed"
    )
    over = "over the ground ends" if scene.supports.seat == "plate" else "over the wire"
    yield (
        f"  length        free {found.free_length:.4g} mm, solid {found.solid_length:.4g} mm, {over}; "
        f"active {spring.active_height:g} mm"
    )
    gap = "none below one coil" if found.least_gap is None else f"{found.least_gap:.3g} mm at least"
    yield f"  gap           {gap}, between neighbouring active coils"
    yield f"  helix angle   {math.degrees(found.helix_angle):.3g} degrees at most"
    yield f"  rate          {found.rate:.4g} N/mm (G d^4 / 8 D^3 n of EN 13906-1, summed over the coils)"
    beam, coiled = found.wire_rates
    yield f"  {'':<13} {beam:.4g} N/mm by a wire of beams, by 3D elasticity {_known(coiled, '.4g', ' N/mm')}"
    first, last = found.closing
    yield f"  closing       first coil at about {first:.3g} N, last at {last:.3g} N, by the same formula"
    yield f"  axial load    {_axial(found)}"
    yield (
        f"  stress        {found.stress:.3g} MPa (8 F D / pi d^3 with Bergstraesser's factor "
        f"{found.stress_factor:.3f} of EN 13906-1)"
    )
    wahl, elastic = found.inner_factors
    yield f"  {'':<13} factor by Wahl {wahl:.3f}, at the inside by 3D elasticity {_known(elastic, '.3f')}"


def _known(value: float, form: str, unit: str = "") -> str:
    return "unknown (Poisson's ratio below 0)" if math.isnan(value) else f"{value:{form}}{unit}"


def _axial(found: Sizes) -> str:
    """What the axial load does."""
    if math.isinf(found.force):
        return f"none shortens it by {found.shortening:.3g} mm: solid before"
    return (
        f"{found.force:.4g} N, which shortens it by {found.shortening:.3g} mm, "
        f"by the same formula: coils that close give no more"
    )


def _of_formulas(found: Sizes) -> Iterator[str]:
    """What the numbers of this report leave out."""
    angle = math.degrees(found.helix_angle)
    if angle > STEEPEST:
        yield f"helix angle up to {angle:.3g} degrees, above {STEEPEST:g}: the formulas leave it out"
    if found.force < 0.0:
        yield "the axial load pulls: the formulas are those of a compression spring"


def _models(scene: Scene) -> Iterator[tuple[str, str]]:
    """What each model says to a scene, with its usual mesh."""
    for model, accept in (("equivbeam", build_model), ("wirefe", _mesh)):
        try:
            accept(scene)
            yield model, "represents it" + (LEFT_OUT if model == "equivbeam" and _sticks(scene) else "")
        except InputError as error:
            yield model, str(error)


def _sticks(scene: Scene) -> bool:
    """Whether coils that touch do more than push."""
    return scene.contact.enabled and scene.contact.sliding != "free"


def _mesh(scene: Scene) -> None:
    """The wire model's part that may refuse a scene; its spheres are many where coils are."""
    seat = scene.supports.require_supported("wirefe", SEATS)
    mesh_wire(scene.spring, ELEMENTS_PER_TURN, seat == "plate")
