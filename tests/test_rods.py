"""Any wire, beside what `validation.verification.rodcases` has: whole paths, limit points, bad input."""

import numpy as np
import pytest

import wirefe
from coilspring import EquilibriumNotFound, InputError, Material, spring_a
from coilspring.scene.wire import Section, round_section
from validation.verification import rodcases
from validation.verification.rodcases import line
from wirefe.results.linear import tip_flexibility


class Straight:
    """A curve without a normal."""

    def points(self, phi):
        return np.outer(phi, [1.0, 0.0, 0.0])

    def derivatives(self, phi):
        return np.tile([1.0, 0.0, 0.0], (len(phi), 1)), np.zeros((len(phi), 3))


HINGED = wirefe.straight_rod(line(1.0, 2), Section(1.0, 1.0, 1.0, 1.0)).holding(0, "ux", "uy", "uz")
HINGED = HINGED.holding(-1, "uy", "uz").loaded(-1, force=(-1.0, 0.0, 0.0))  # it may spin about itself


@pytest.mark.parametrize(
    ("rod", "half"),
    [(rodcases.rolling(8), (-10.0, 20.0 / np.pi, 0.0)), (rodcases.unrolling(4), (0.0, 20.0 / np.pi, 0.0))],
)
def test_half_the_moment_makes_a_half_circle(rod, half):
    """G2 and G3, exact: a straight rod bent to it, a circle opened to it. Measured 2e-10."""
    path = wirefe.solve_rod(rod, steps=2)
    np.testing.assert_allclose(path.displacements(-1)[0], half, atol=1e-8)


def test_shear_flexible_cantilever():
    """G4, Nachbagauer 2011: small load, measured 1e-6 at 64 elements; second order under the large one."""
    small = rodcases.shear_flexible(64, 5e5)
    np.testing.assert_allclose(small, [-1.8884916e-7, -8.0990325e-4], rtol=1e-5)
    errors = [abs(rodcases.shear_flexible(n)[0] + 0.15097114) for n in (8, 16, 32)]
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.15)


@pytest.mark.parametrize("rod", [rodcases.lees_frame(80), rodcases.arch(20)])
def test_a_path_ends_at_its_limit_load(rod):
    """G10 and G11; the loads are those of `rodcases`."""
    with pytest.raises(EquilibriumNotFound) as caught:
        wirefe.solve_rod(rod, steps=5)
    assert caught.value.outcome == "limit_point"
    assert (caught.value.path.times < caught.value.critical_time).all()


def test_lees_frame_past_its_limit_points():
    """G10: traced over the limit load at w = 48.74, through the snap-back beyond 61, up to load 3."""
    path = wirefe.trace_rod(rodcases.lees_frame(80), points=400)
    load, w = rodcases.LEE * path.times, -path.displacements(48)[:, 1]  # of the loaded node
    assert path.times[-1] >= 1.0
    peak = np.argmax(load[: len(load) // 3])
    assert load[peak] == pytest.approx(1.85445, rel=1e-4)
    assert w[peak] == pytest.approx(48.74, abs=0.5)  # points are spaced, the peak is flat
    assert w[:-1][np.diff(w) < 0.0].max() == pytest.approx(61.0, abs=0.5)  # snap-back begins
    falling = np.diff(load) < 0.0
    assert (path.negative_pivots[1:][falling] == 1).mean() > 0.9
    assert path.negative_pivots[0] == path.negative_pivots[-1] == 0


def test_flexibility_of_a_cantilever():
    """L^3/(3 EI) + L/GA, exact for any number of elements, of a bar in any direction."""
    section = round_section(2.0, Material())
    rod = wirefe.straight_rod(line(100.0, 3) @ [[0.6, 0.0, 0.8], [0.0, 1.0, 0.0], [-0.8, 0.0, 0.6]], section)
    assert tip_flexibility(rod, rod.points[-1])[1, 1] == pytest.approx(
        1e6 / (3.0 * section.EI) + 100.0 / section.GA, rel=1e-9
    )


def test_euler_column_bifurcates():
    """Clamped-free column, exact: pi^2 EI / (4 L^2); nearly inextensible. Second order in the mesh."""
    rod = wirefe.straight_rod(line(1.0, 40), Section(1e8, 1e8, 1.0, 1.0)).holding(0).in_plane()
    with pytest.raises(EquilibriumNotFound) as caught:
        wirefe.solve_rod(rod.loaded(-1, force=(-5.0, 0.0, 0.0)), steps=3)
    assert caught.value.outcome == "bifurcation"
    assert 5.0 * caught.value.critical_time == pytest.approx(np.pi**2 / 4, rel=2e-4)


def test_a_traced_column_goes_straight_on_where_it_may_buckle():
    """Time goes on as before past the bifurcation, beyond which the straight column is unstable."""
    rod = wirefe.straight_rod(line(1.0, 20), Section(1e4, 1e4, 1.0, 1.0)).holding(0).in_plane()
    euler = np.pi**2 / 4
    path = wirefe.trace_rod(rod.loaded(-1, force=(-3.0 * euler, 0.0, 0.0)), points=120)
    assert path.outcome == "completed"
    assert path.times[-1] >= 1.0
    assert (np.diff(path.times) > 0.0).all()
    np.testing.assert_allclose(path.displacements(-1)[:, 1], 0.0, atol=1e-9)
    assert path.negative_pivots.tolist() == (path.times > 1.0 / 3.0).astype(int).tolist()
    assert "another path branches off (bifurcation), which is not taken" in path.message


def test_scene_and_rod_are_one_model():
    """A spring without end turns, built as a rod by hand: the loads act at the wire's last point there."""
    spring = spring_a().spring
    rod = wirefe.curved_rod(spring, np.linspace(0.0, spring.phase_end, 117), round_section(1.5, Material()))
    rod = rod.holding(0).holding(-1, "uz", "rotx", "roty").loaded(-1, force=(0.0, -4.0, 0.0))
    path = wirefe.solve_rod(rod, steps=2)
    assert path.outcome == "completed"
    assert path.rotations.shape == (2, 117, 4)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda rod: rod.holding(0, "up"), "dofs must be one of ux"),
        (lambda rod: wirefe.solve_rod(rod.holding(0)), "loads must not all be zero"),
        (lambda rod: wirefe.straight_rod(np.zeros((3, 3)), Section(1, 1, 1, 1)), "points must differ"),
        (lambda rod: wirefe.straight_rod("abc", Section(1, 1, 1, 1)), "points must be numbers, got 'abc'"),
        (
            lambda rod: wirefe.straight_rod(line(1.0, 2), "x"),
            "section must be a coilspring.scene.wire.Section",
        ),
        (
            lambda rod: wirefe.straight_rod(line(1.0, 2), Section(-1, 1, 1, 1)),
            r"section\.EA must be finite and a",
        ),
        (lambda rod: wirefe.curved_rod(spring_a().spring, [2.0, 1.0], Section(1, 1, 1, 1)), "rising numbers"),
        (
            lambda rod: wirefe.curved_rod(spring_a().spring, "x", Section(1, 1, 1, 1)),
            "parameters must be num",
        ),
        (lambda rod: wirefe.curved_rod(Straight(), [0.0, 1.0], Section(1, 1, 1, 1)), "curve must be curved"),
        (lambda rod: wirefe.solve_rod(rod.loaded(1, force=(1, 0, 0))), "held must leave no rigid motion"),
        (lambda rod: wirefe.solve_rod(HINGED), "held must leave no rigid motion"),
        (lambda rod: wirefe.straight_rod(np.zeros((1, 3)), Section(1, 1, 1, 1)), "points must be finite"),
        (lambda rod: wirefe.solve_rod(rod.loaded(1, force=(1, 0, 0)), steps=0), "steps must be an integer"),
    ],
)
def test_bad_rods(change, words):
    with pytest.raises(InputError, match=words):
        change(wirefe.straight_rod(line(1.0, 2), Section(1.0, 1.0, 1.0, 1.0)))


@pytest.mark.parametrize("steps", [1, 5, 50])
def test_a_moment_in_space_makes_no_claim_on_stability(steps):
    """In its plane the end rolls up, exactly; free to leave it, the matrix is not definite, though the wire
    is stable, and the path ended in a bifurcation or a limit point, where it did by the number of steps."""
    section = round_section(2.0, Material())
    rod = wirefe.straight_rod(line(100.0, 40), section).holding(0)
    rod = rod.loaded(-1, moment=(0.0, 0.0, 0.04 * section.EI))
    shorter = 100.0 * (np.sin(4.0) / 4.0 - 1.0)
    path = wirefe.solve_rod(rod.in_plane(), steps=steps)
    assert path.displacements(-1)[-1, 0] == pytest.approx(shorter, rel=1e-9)
    assert "stable" not in path.message
    with pytest.raises(EquilibriumNotFound) as caught:
        wirefe.solve_rod(rod, steps=steps)
    assert caught.value.outcome == "not_converged"
    assert caught.value.critical_time is None
    assert "though there may be one: the moment on node 40" in caught.value.message
    with pytest.raises(EquilibriumNotFound, match="has no potential"):
        wirefe.trace_rod(rod)
    small = wirefe.solve_rod(rod.loaded(-1, moment=(0.0, 0.0, -0.03 * section.EI)), steps=steps)
    assert "whether it is stable is not known" in small.message


def test_what_is_no_rod_is_refused():
    with pytest.raises(InputError, match=r"rod must be a wirefe\.Rod, got 'x'"):
        wirefe.solve_rod("x")


def test_a_path_that_ends_before_its_first_step_says_so():
    """A column under 1.1 times Euler's load, in one step."""
    section = round_section(2.0, Material())
    euler = np.pi**2 * section.EI / (4.0 * 200.0**2)
    rod = wirefe.straight_rod(line(200.0, 20), section).holding(0).loaded(-1, force=(-1.1 * euler, 0.0, 0.0))
    with pytest.raises(EquilibriumNotFound, match="bifurcation") as found:
        wirefe.solve_rod(rod, steps=1)
    assert len(found.value.path.times) == 0
    assert found.value.critical_time == pytest.approx(1.0 / 1.1, rel=1e-3)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda rod: rod.holding(9), r"node must be an integer in \[-5, 4\], got 9"),
        (lambda rod: rod.loaded(-1, force=(0.0, 0.0, np.nan)), "force must be a finite number"),
        (lambda rod: rod.loaded(-1, force=(1.0, 2.0)), "force must be three numbers"),
        (lambda rod: round_section(-2.0, Material()), "diameter must be a finite number"),
    ],
)
def test_bad_nodes_loads_and_sections(change, words):
    with pytest.raises(InputError, match=words):
        change(wirefe.straight_rod(line(10.0, 4), round_section(1.0, Material())))
