"""End turns that are elastic and rest on plates."""

from dataclasses import replace

import numpy as np
import pytest

import wirefe
from coilspring import (
    CoilSection,
    Contact,
    EquilibriumNotFound,
    InputError,
    Load,
    Scene,
    Spring,
    Supports,
    load_scene,
)
from coilspring.compiling.packing import pack
from coilspring.contact.law import PAIR_HISTORY
from coilspring.scene.sizing import axial_rate
from wirefe import kernels, seated
from wirefe.contact.plates import BORDERS
from wirefe.contact.stations import ARMS, POSITION
from wirefe.model import build_model, matrix_size, rest_state
from wirefe.results.export import section_results
from wirefe.results.linear import linear_stiffness
from wirestates import dense, gaps_at, plate_forces, pressed

SPRING = Spring(1.5, 10.0, 5.0, 20.0)
GUIDED = ("ux", "rotz")


def scene_of(force=(0.0, -40.0), held=GUIDED, spring=SPRING, seat="plate", steps=10):
    supports, spheres = Supports(held, seat=seat), Contact(geometry="spheres")
    return Scene("seated", spring, Load(force, steps=steps), supports=supports, contact=spheres)


@pytest.mark.parametrize("element", ["straight", "curved"])
@pytest.mark.parametrize("held", [(), GUIDED])
def test_gradient_and_matrix_are_derivatives_of_the_energy(held, element, check_derivatives):
    scene = scene_of(held=held)
    data, mesh, rod = build_model(scene, 8, 4, element)
    arrays, rest = pack(data), rest_state(rod, mesh.arm)
    history = np.zeros(len(data.contact.pairs), PAIR_HISTORY)
    free = (~rod.held).ravel().astype(float)
    n, state = free.size, np.empty_like(rest)
    shift = 1e-3 * free * np.random.default_rng(5).normal(size=n)
    kernels.retract(*arrays, rest, shift, 1.0, rest, 0.0, state)

    def energy(step):
        at, g, H = np.empty_like(state), np.empty(n), np.empty(matrix_size(data))
        kernels.retract(*arrays, state, step * free, 1.0, state, 0.0, at)
        value, _ = seated.assemble(*arrays, state, 0.0, history, at, g, H)
        return value, g, dense(data, H, n) * np.outer(free, free)

    touching = gaps_at(data.plates, state)[1] < 0.0
    low = data.plates.below * BORDERS
    for plate in (touching[:low], touching[low:]):
        assert 10 < np.count_nonzero(plate) < len(plate)
    check_derivatives(energy, n, h=3e-6, tolerance=1e-6)


@pytest.mark.parametrize(
    ("held", "force"), [(GUIDED, (0.0, -40.0)), (("rotz",), (4.0, -40.0)), ((), (-0.2, -20.0))]
)
def test_the_plates_carry_the_load_where_statics_puts_it(held, force):
    path = wirefe.solve(scene_of(force, held))
    x, low, high = plate_forces(path)
    assert low.sum() == pytest.approx(-path.scene.load.force[1], rel=1e-9)
    nodes = path.states[-1].reshape(-1, 7)
    top = nodes[-1]
    if held:
        assert high.sum() == pytest.approx(40.0, rel=1e-9)
        return
    # moment about Z through the tip, where the force along the plate is held
    tip = nodes[0]
    moment = (low * (x[: len(low), 0] - tip[0])).sum()
    fx, fy = path.scene.load.force
    given = (top[0] - tip[0]) * fy - (top[1] - tip[1]) * fx
    assert moment == pytest.approx(-given, rel=1e-4)
    assert (low == 0.0).any()
    assert (high == 0.0).any()


@pytest.mark.parametrize("element", ["straight", "curved"])
def test_a_small_load_meets_the_linear_complementarity_problem(element):
    """By the linear stiffness of the wire, and the pressed lengths found in plain numpy."""
    scene = scene_of((0.0, -0.04), steps=1).without_contact()
    data, mesh, rod = build_model(scene, 16, 4, element)
    n, plates = len(rod.points), data.plates
    carry = np.eye(6 * n)  # the wire's end stands off from the last node
    carry[6 * n - 6 : 6 * n - 3, 6 * n - 3 :] = -matrix_of(mesh.arm)
    K = carry.T @ linear_stiffness(rod).toarray() @ carry
    for axis in (0, 2):  # the hold of the tip along the plate
        hold = np.zeros(6 * n)
        hold[[6 * n - 12 + axis, 6 * n - 6 + axis]] = -1.0, 1.0
        K += plates.hold * np.outer(hold, hold)
    rows = np.zeros((len(plates.c), 6 * n))  # of the gaps: y of a border, or of the top end less that
    for row, (border, parts) in enumerate(zip(np.repeat(plates.node, BORDERS), plates.parts, strict=True)):
        sign = 1.0 if row < plates.below * BORDERS else -1.0
        p = parts[POSITION]
        for node, share, at in ((border, 1.0 - p, ARMS), (border + 1, p, ARMS + 3)):
            rows[row, 6 * node + 1] += sign * share
            rows[row, 6 * node + 3 : 6 * node + 6] -= sign * matrix_of(parts[at : at + 3])[1]
        rows[row, 6 * n - 5] += 0.5 - 0.5 * sign
    rest, u = gaps_at(plates, rest_state(rod, mesh.arm))[1], np.zeros(6 * n)
    free, load = np.flatnonzero(~rod.held), rod.loads.ravel()
    for _ in range(30):  # Newton's method
        force, slope = pressed(plates, rest + rows @ u)
        left = load - K @ u - rows.T @ force
        u[free] += np.linalg.solve((K + rows.T @ slope @ rows)[np.ix_(free, free)], left[free])
    assert np.abs(left[free]).max() < 1e-9
    path = wirefe.solve(scene, elements_per_turn=16, element=element)
    assert 0.1 < np.mean(force < 0.0) < 0.9
    np.testing.assert_allclose(np.concatenate(plate_forces(path)[1:]), -force, atol=2e-5 * 0.04)
    assert path.tips[-1, 1] == pytest.approx(u[6 * n - 5], rel=1e-4)  # the geometry's share at this load


def matrix_of(r):
    """The matrix of the cross product r x."""
    x, y, z = r
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])


def test_curved_elements_converge_to_what_fine_straight_ones_do():
    """Four of them a turn are nearer to it than forty straight ones."""
    scene = scene_of((0.0, -80.0), steps=4)
    exact = wirefe.solve(scene, element="curved", elements_per_turn=64).tips[:, 1]

    def error(element, count):
        found = wirefe.solve(scene, element=element, elements_per_turn=count).tips[:, 1]
        return np.abs(found - exact).max() / np.abs(exact).max()

    coarse, fine = (error("straight", count) for count in (40, 160))
    errors = [error("curved", count) for count in (4, 8, 16)]
    assert fine < 0.15 * coarse
    assert errors[0] < 0.25 * coarse
    assert errors[2] < 0.25 * errors[0]


def test_the_rate_lies_between_those_of_active_coils_and_of_all_coils():
    bare = scene_of(steps=2).without_contact()
    rigid = replace(bare, supports=Supports(GUIDED))
    soft = replace(rigid, spring=replace(SPRING, active_coils=7.0, active_height=28.0, end_turns=0.0))
    rates = [40.0 / -wirefe.solve(each).tips[-1, 1] for each in (rigid, bare, soft)]
    assert rates[0] > 1.05 * rates[1] > 1.05**2 * rates[2]
    assert rates[0] == pytest.approx(axial_rate(bare), rel=0.02)


def test_coils_that_settle_on_the_end_turns_make_it_stiffer():
    path = wirefe.solve(scene_of((0.0, -120.0), steps=30))
    rate = np.diff(path.loads[:, 1]) / np.diff(path.tips[:, 1])
    settled = path.active_contacts[1:-1] == 6
    assert path.active_contacts[0] == 2
    assert rate[1:][settled].min() > 1.15 * rate[:5].max()
    assert plate_forces(path)[1].sum() == pytest.approx(120.0, rel=1e-4)


def test_a_spring_turned_over_does_the_same():
    """Its top plate, which is held in the model by its own dofs, becomes the fixed bottom one."""
    cone = Spring(1.5, (12.0, 8.0), 5.0, 22.5, start_phase=0.3)
    # turned by half a turn about X: y -> H - y, z -> -z, and the wire begins at its other end
    over = Spring(1.5, (8.0, 12.0), 5.0, 22.5, start_phase=-0.3 - 2.0 * np.pi * 5.0)
    one, other = (wirefe.solve(scene_of((0.0, -60.0), spring=spring)) for spring in (cone, over))
    assert one.active_contacts[-1] == other.active_contacts[-1] > 0
    np.testing.assert_allclose(one.tips[:, 1], other.tips[:, 1], rtol=1e-4)  # the hold of the top tip yields
    for here, there in zip(plate_forces(one)[1:], plate_forces(other)[:0:-1], strict=True):
        np.testing.assert_allclose(here, there[::-1], atol=1e-2)


def test_a_node_one_turn_from_an_end_bears_at_both_ends_alike():
    """Coils of this barrel pass inside its end turns and reach the plates. By rounding of their phases, nodes
    one turn from its ends bore at one end only: the rate differed by 12 %, and the outcome under 70 N."""
    sections = [
        CoilSection(1.5, (2.4, 7.0), (20.0, 26.0)),
        CoilSection(2.0, (7.0, 7.0), (26.0, 26.0)),
        CoilSection(1.5, (5.0, 2.4), (26.0, 18.0)),
    ]
    over = [CoilSection(each.coils, each.pitch[::-1], each.mean_diameter[::-1]) for each in sections[::-1]]
    tips = []
    for coils, phase in ((sections, 0.0), (over, -2.0 * np.pi * 5.0)):
        barrel = Spring.of_sections(2.0, coils, end_turns=1.75, start_phase=phase)
        scene = replace(scene_of((0.0, -65.0), spring=barrel, steps=1), contact=Contact())
        tips.append(wirefe.solve(scene, elements_per_turn=20, pairs_per_turn=40).tips[-1, 1])
    assert tips[0] == pytest.approx(tips[1], rel=1e-5)


def test_a_spring_whose_load_leaves_its_base_turns_over():
    with pytest.raises(EquilibriumNotFound) as found:
        wirefe.solve(scene_of((-6.0, -60.0), ()))
    path = found.value.path
    assert path.outcome == "limit_point"
    # the resultant meets the bottom plate between the axis and the coil
    x, y = path.top[-1, :2]
    fx, fy = path.loads[-1]
    assert 3.0 < abs(x - y * fx / fy) < 5.75


def test_test_machine_stages_and_sections():
    machine = wirefe.solve(replace(scene_of(), load=Load(displacement=(-4.0, -6.0), steps=3)))
    force = wirefe.solve(scene_of((0.0, machine.loads[-1, 1])))
    np.testing.assert_allclose(force.tips[-1], machine.tips[-1], rtol=1e-4, atol=1e-9)
    stages = wirefe.solve(replace(scene_of(), load=Load(stages=((0.0, -60.0), (0.0, -40.0)), steps=4)))
    np.testing.assert_allclose(stages.tips[-1], wirefe.solve(scene_of()).tips[-1], rtol=1e-6, atol=1e-9)
    found = section_results(machine, -1)
    assert len(found.force) + 1 == len(found.points) == 7 * 40 + 1
    assert np.isfinite(found.curvature_change).all()
    # over a turn the torsion is that of the load on the coil's radius, wherever the load passes
    torsion = np.abs(found.moment[120:160, 0]).mean()
    assert torsion == pytest.approx(-5.0 * machine.loads[-1, 1], rel=0.05)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"spring": replace(SPRING, end_turns=0.0)}, ("spring.end_turns", "[0.5, 100]", "got 0")),
        ({"load": Load((0.0, 5.0))}, ("load.force", "below 0", "got 5.0")),
        ({"load": Load(stages=((0.0, -5.0), (0.0, 0.0)))}, ("load.stages", "below 0", "got 0.0")),
        ({"load": Load(displacement=(-1.0, 1.0))}, ("load.displacement", "below 0", "got 1.0")),
    ],
)
def test_what_plates_cannot_do_is_refused(change, words):
    with pytest.raises(InputError) as error:
        replace(scene_of(), **change)
    assert all(word in str(error.value) for word in words)


def test_the_mesh_is_refused_where_end_turns_are_no_whole_elements():
    with pytest.raises(InputError, match=r"spring\.end_turns must be a multiple of 1/40"):
        wirefe.solve(scene_of(spring=replace(SPRING, end_turns=0.777)))


def test_the_example_is_the_spring_of_these_tests():
    scene = load_scene("examples/plates.toml")
    assert scene.supports == Supports(GUIDED, seat="plate")
    assert scene.contact == Contact()
    assert scene.spring == SPRING


def test_a_driven_top_tells_what_its_guide_carries():
    """The force with which a top that is free in X reaches the same place, on plates too."""
    bare = Contact(enabled=False)
    driven = replace(
        scene_of(spring=Spring(2.0, 16.0, 4.5, 28.0)), load=Load(displacement=(-4.0,), steps=2), contact=bare
    )
    held = wirefe.solve(driven, elements_per_turn=20)
    assert abs(held.loads[-1, 0]) > 0.01 * abs(held.loads[-1, 1])
    free = replace(
        driven, load=Load(tuple(held.loads[-1]), steps=2), supports=Supports(("rotz",), seat="plate")
    )
    found = wirefe.solve(free, elements_per_turn=20).tips[-1]
    np.testing.assert_allclose(found, held.tips[-1], atol=1e-7)
