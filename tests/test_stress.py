"""Stresses along the wire against closed forms: the axially loaded helical spring, and pure bending."""

import math
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

import equivbeam
import wirefe
from coilspring import Contact, EquilibriumPath, InputError, Load, Scene, Spring, Supports, spring_a, spring_b
from coilspring.scene.sizing import sizes
from validation.cli.command import main
from validation.study.partialsolve import partial_path
from wirefe.contact.plates import BORDERS
from wirefe.contact.stations import ROTATION
from wirefe.element.rotations import quaternion_from_matrix
from wirefe.results.between import station_loads
from wirefe.results.export import section_results
from wirefe.results.stress import resultants, sections_of, stresses
from wirefe.rod import frenet_frames
from wirestates import plate_forces

D, WIRE, FORCE = 20.0, 1.5, 1e-2
FREE = Contact(enabled=False)
AXIAL = Scene(
    "axial",
    Spring(WIRE, D, 10.0, 25.0, end_turns=0.0),
    Load((0.0, -FORCE), steps=1),
    supports=Supports(("ux", "rotz")),
    contact=FREE,
)


@pytest.mark.parametrize(("element", "count"), [("straight", 40), ("curved", 4)])
@pytest.mark.parametrize("hand", ["left", "right"])
def test_axially_loaded_helical_spring(element, count, hand):
    """8 F D / (pi d^3), in which the textbook leaves out the pitch: T = F R cos a + C sin a and
    M = F R sin a - C cos a, C being the couple that keeps the top from turning. Moments across the axis
    average out over whole turns."""
    scene = replace(AXIAL, spring=replace(AXIAL.spring, hand=hand))
    found = wirefe.stress(wirefe.solve(scene, element=element, elements_per_turn=count))
    slope = math.atan(2.5 / (math.pi * D))
    torsion, bending = abs(found.torsion.mean()), abs(found.bending_in.mean())
    assert torsion * math.cos(slope) + bending * math.sin(slope) == pytest.approx(FORCE * D / 2.0, rel=2e-3)
    textbook = 8.0 * FORCE * D / (math.pi * WIRE**3)
    assert found.torsion_stress.mean() == pytest.approx(textbook, rel=4e-3)
    index = D / WIRE
    assert_allclose(found.shear_corrected, found.torsion_stress * (index + 0.5) / (index - 0.75), rtol=1e-12)
    checked = sizes(scene)
    assert found.shear_corrected.mean() == pytest.approx(checked.stress, rel=4e-3)
    assert found.axial_force.mean() == pytest.approx(-FORCE * math.sin(slope), rel=1e-3)
    assert found.shear_force.mean() == pytest.approx(FORCE * math.cos(slope), rel=1e-3)


def test_pure_bending():
    """A helix bent to another curvature, its torsion unchanged: M = EI (k' - k) everywhere, no torque. M
    turns with the wire then, but does not within an element: measured 4.8e-5 of it about it at nodes."""
    path = wirefe.solve(AXIAL, element="curved", elements_per_turn=64)
    spring, mesh, E = AXIAL.spring, path.shape.mesh, AXIAL.material.E
    c = spring.rise(np.zeros(1))[0]
    square = (D / 2.0) ** 2 + c**2
    k, tau, more = D / 2.0 / square, c / square, 2e-3
    rate = math.hypot(k + more, tau)  # of the phase, per length of wire
    pitch = 2.0 * math.pi * tau / rate**2
    bent = Spring(WIRE, 2.0 * (k + more) / rate**2, 11.0, 11.0 * pitch, end_turns=0.0)
    turned = mesh.phases * math.sqrt(square) * rate
    before, after = frenet_frames(spring, mesh.phases), frenet_frames(bent, turned)
    turns = after @ np.swapaxes(before, 1, 2)
    rows = np.concatenate((bent.points(turned), quaternion_from_matrix(turns)), axis=1)
    rows[-1, :3] -= turns[-1] @ mesh.arm
    found = stresses(path.shape, rows.reshape(1, -1), None)
    moment = E * math.pi * WIRE**4 / 64.0 * more
    assert_allclose(np.abs(found.bending_in), moment, rtol=1e-4)
    assert_allclose(found.bending_stress, E * WIRE / 2.0 * more, rtol=1e-4)
    assert_allclose(found.torsion, 0.0, atol=1e-4 * moment)
    index = D / WIRE
    assert_allclose(
        found.bending_corrected / found.bending_stress, (index + 0.07) / (index - 0.75), rtol=1e-3
    )
    assert_allclose(found.equivalent, found.bending_corrected, rtol=1e-3)


@pytest.mark.parametrize("end_turns", [0.0, 1.0])
@pytest.mark.parametrize(("element", "count"), [("straight", 40), ("curved", 4)])
def test_the_clamped_end_carries_the_moment_of_the_load(element, count, end_turns):
    """By statics: the most stressed section of one coil with a free top, whose end turn goes on at another
    slope. Measured 2e-9 off."""
    force, spring = (-20.0, -50.0), Spring(2.0, 16.0, 1.0, 5.0, end_turns=end_turns)
    path = wirefe.solve(
        Scene("coil", spring, Load(force, 1), contact=FREE), element=element, elements_per_turn=count
    )
    found, (ux, uy, _) = wirefe.stress(path), path.tips[-1]
    moment = (ux - 8.0) * force[1] - (5.0 + uy) * force[0]
    _, rise, across = spring.tangents(np.array([1e-6]))[0]
    carried = (found.torsion[0] * across + found.bending_in[0] * rise) / math.hypot(rise, across)
    assert carried == pytest.approx(moment, rel=1e-6)
    assert (found.turns[0], found.turns[-1]) == (0.0, 1.0)
    assert found.largest() == (path.max_stress[-1], 0.0)


def test_sections_at_a_node_are_on_both_sides_of_it():
    """Spheres press on nodes: shear jumps there, moments do not, whose largest are often at a node."""
    found = wirefe.stress(wirefe.solve(spring_a(), steps=1, element="curved", elements_per_turn=4))
    low = np.flatnonzero(np.diff(found.turns) == 0.0)
    assert len(low) == 14.5 * 4 - 1
    for moment in (found.torsion, found.bending_moment):
        assert_allclose(moment[low], moment[low + 1], atol=1e-5 * np.abs(moment).max())
    assert np.abs(found.shear_force[low] - found.shear_force[low + 1]).max() > 0.5


def test_it_is_the_same_on_all_meshes():
    """Section forces between few nodes follow from statics. Measured 6e-4 at most."""
    for make in (spring_a, spring_b):
        coarse, fine = (
            wirefe.stress(wirefe.solve(make(), steps=5, element="curved", elements_per_turn=count))
            for count in (4, 16)
        )
        for name in ("torsion_stress", "shear_corrected", "bending_corrected", "equivalent"):
            assert coarse.largest(name)[0] == pytest.approx(fine.largest(name)[0], rel=2e-3)
            assert coarse.largest(name)[1] == pytest.approx(fine.largest(name)[1], abs=0.05)


def test_the_path_has_the_largest_one():
    path = wirefe.solve(spring_b(), steps=4, element="curved", elements_per_turn=4)
    by_step = [wirefe.stress(path, step).largest()[0] for step in range(4)]
    assert_allclose(path.table["max_stress"], by_step, rtol=1e-12)
    beam = equivbeam.solve(spring_b(), steps=4)
    assert beam.max_stress is None
    assert "max_stress" not in beam.table
    with pytest.raises(InputError, match="stress needs a path of the model wirefe"):
        wirefe.stress(beam)
    with pytest.raises(InputError, match="step must be one of the 4"):
        wirefe.stress(path, 4)
    with pytest.raises(InputError, match=r"name must be one of torsion_stress, .*, equivalent, got 'foo'"):
        wirefe.stress(path).largest("foo")


@pytest.mark.parametrize(
    "read",
    [
        wirefe.stress,
        wirefe.frequencies,
        section_results,
        EquilibriumPath.centreline,
        EquilibriumPath.circle_centres,
    ],
)
def test_a_step_is_the_number_of_one_that_is_stored(read):
    path = wirefe.solve(spring_a(), steps=2, element="curved", elements_per_turn=4)
    read(path, np.int64(-2))
    for step in (2, -3, 1.5, True, "last", slice(1)):
        with pytest.raises(
            InputError, match=r"step must be one of the 2 of the path, an integer in \[-2, 1\]"
        ):
            read(path, step)
    with pytest.raises(InputError, match="step must be one of the 0 of the path, got -1"):
        read(path.select(slice(0)), -1)


def test_elastic_end_turns_have_stresses_too():
    """On plates the wire goes on beyond the active coils."""
    spring = Spring(1.5, 12.0, 4.0, 16.0)
    plates = Scene("plates", spring, Load((0.0, -20.0), 2), supports=Supports(("ux", "rotz"), seat="plate"))
    found = wirefe.stress(wirefe.solve(plates, elements_per_turn=16))
    assert (found.turns[0], found.turns[-1]) == pytest.approx((-1.0, 5.0), abs=1e-12)
    middle = (found.turns > 1.0) & (found.turns < 3.0)
    assert found.torsion_stress[middle].mean() == pytest.approx(
        8.0 * 20.0 * 12.0 / (math.pi * 1.5**3), rel=0.03
    )


def test_solve_writes_stresses_where_asked(tmp_path, capsys):
    arguments = ["solve", "spring-b", "--model", "wirefe", "--elements-per-turn", "8", "--steps", "2"]
    arguments += ["--out", str(tmp_path)]
    assert main([*arguments, "--stress"]) == 0
    rows = np.genfromtxt(tmp_path / "stress.csv", delimiter=",", names=True)
    path = np.genfromtxt(tmp_path / "path.csv", delimiter=",", names=True)
    assert rows["shear_corrected"].max() == pytest.approx(path["max_stress"][-1])
    assert f"stress {path['max_stress'][-1]:.4g} MPa at most" in capsys.readouterr().out
    assert main(arguments) == 0
    assert not (tmp_path / "stress.csv").exists()


@pytest.mark.parametrize("sliding", ["none", "coulomb"])
def test_forces_of_pairs_are_those_on_the_stations_but_for_a_share_of_friction(sliding):
    """The slip's part along the normal, over the gap, of the tangential force: (W9g)."""
    contact = Contact(
        stiffness=5e4, sliding=sliding, geometry="wires", friction=0.3 if sliding == "coulomb" else None
    )
    spring, load = Spring(2.0, 16.0, 5.0, 18.0, end_turns=0.0), Load((1.0, -170.0), steps=5)
    path = wirefe.solve(
        Scene("pressed", spring, load, contact=contact), element="curved", elements_per_turn=8
    )
    vectors, tangential = path.shape.pair_vectors(path.states[-1:])[0], path.friction.force[-1]
    normal = path.contact_forces[-1][:, None] * vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    on_stations = station_loads(path.shape.data, path.states[-1:], path.histories[-1:])[0, ..., :3].sum(
        axis=1
    )
    for sign, side in zip((1.0, -1.0), path.shape.data.contact.pairs.T, strict=True):
        np.subtract.at(on_stations, side, sign * (tangential - normal))
    assert 0.0 < np.abs(on_stations).max() < 1e-3 * np.abs(tangential).max()


@pytest.mark.parametrize(("element", "count"), [("curved", 4), ("curved", 16), ("straight", 20)])
def test_sections_of_an_end_turn_balance_the_plate_below_them(element, count):
    """The plate's pressure within an element acts on its nodes: with 4 a turn the shear was off by 23 %."""
    spring, load = Spring(1.5, 10.0, 5.0, 20.0), Load((0.0, -80.0), steps=2)
    scene = Scene("seated", spring, load, supports=Supports(("rotz",), seat="plate")).without_contact()
    path = wirefe.solve(scene, element=element, elements_per_turn=count)
    shape, state = path.shape, path.states[-1:]
    plates, at, cut = shape.data.plates, shape.mesh.phases, sections_of(shape)
    borders, up, _ = plate_forces(path)
    borders = borders[: len(up)]
    node = np.repeat(plates.node, BORDERS)[: len(up)]
    place = at[node] + plates.parts[: len(up), ROTATION] * (at[node + 1] - at[node])
    force, moment, _ = (each[0] for each in resultants(shape, state, path.histories[-1:], cut))
    x, tip = shape.centreline(state[0], cut.phases), -force[0] * (1.0, 0.0, 1.0)
    seen = 0
    for row, phase in enumerate(cut.phases):
        if phase > 0.0 or np.abs(at - phase).min() < 1e-9:
            continue  # in the active coils, or at a node
        share = 0.5 * sum(place < phase + side for side in (-1e-9, 1e-9))
        below = (share * up)[:, None] * (0.0, 1.0, 0.0)
        assert_allclose(force[row], -tip - below.sum(axis=0), atol=1e-6)
        about = np.cross(x[0] - x[row], tip) + np.cross(borders - x[row], below).sum(axis=0)
        assert_allclose(moment[row, [0, 2]], -about[[0, 2]], atol=1e-5)
        seen += 1
    assert seen > 10


@pytest.mark.parametrize(("friction", "count"), [(None, 4), (0.2, 4), (None, 32)])
def test_sections_balance_all_that_acts_on_the_wire_above_them(friction, count):
    """Contact within an element acts on its nodes, and the force was the element's all along it: where coils
    touch bending stresses were up to 12 % low with 4 elements per turn."""
    contact = Contact(
        stiffness=5e4, sliding="free" if friction is None else "coulomb", geometry="wires", friction=friction
    )
    spring, load = Spring(2.0, 16.0, 5.0, 18.0, end_turns=0.0), Load((1.0, -170.0), steps=2)
    scene = Scene("pressed", spring, load, contact=contact)
    path = partial_path(wirefe.solve, scene, element="curved", elements_per_turn=count)
    assert path.active_contacts[-1] > 20
    shape, state = path.shape, path.states[-1:]
    given = station_loads(shape.data, state, path.histories[-1:])[0]
    points, at = shape.data.contact, shape.mesh.phases
    ends = np.minimum(points.attached[:, None] + (0, 1), len(at) - 1)
    place = at[ends[:, 0]] + points.parts[:, ROTATION] * np.diff(at[ends])[:, 0]
    arms = state.reshape(-1, 7)[ends, :3]
    cut = sections_of(shape)
    elements, phases = cut.element, cut.phases
    force, moment, _ = (each[0] for each in resultants(shape, state, path.histories[-1:], cut))
    x = shape.centreline(state[0], phases)
    for row, phase in enumerate(phases):
        if elements[row] != elements[row - 1] or elements[row] != elements[(row + 1) % len(elements)]:
            continue  # at a node
        # of a station at the section half is above; what is at the top is in the last section's force
        share = 0.5 * sum(place > phase + side for side in (-1e-9, 1e-9)) * (place < phases[-1] - 1e-9)
        share = share[:, None, None]
        forces, moments = share * given[..., :3], share * given[..., 3:]
        assert_allclose(force[row], force[-1] + forces.sum(axis=(0, 1)), atol=1e-4)
        about = moment[-1] + np.cross(x[-1] - x[row], force[-1])
        about += (moments + np.cross(arms - x[row], forces)).sum(axis=(0, 1))
        assert_allclose(moment[row], about, atol=1e-3)
