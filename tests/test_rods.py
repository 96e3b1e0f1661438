"""Any wire, against exact and published solutions; every case names its source and the measured error."""

from dataclasses import dataclass

import numpy as np
import pytest

import wirefe
from coilspring import EquilibriumNotFound, InputError, Material, spring_a
from coilspring.scene.wire import Section, round_section


@dataclass(frozen=True)
class Arc:
    """Circular arc in a plane: `radius` times (cos, sin) of the angle, along two axes."""

    radius: float
    first: tuple[float, float, float]
    second: tuple[float, float, float]

    def points(self, phi):
        c, s = np.cos(phi)[:, None], np.sin(phi)[:, None]
        return self.radius * (c * np.array(self.first) + s * np.array(self.second))

    def derivatives(self, phi):
        return self.points(phi + 0.5 * np.pi), -self.points(phi)


def line(length, elements):
    x = np.linspace(0.0, length, elements + 1)
    return np.stack((x, 0 * x, 0 * x), axis=-1)


@pytest.mark.parametrize(("force", "tip"), [
    (300.0, (-7.04464, -11.93178, 40.19239)),
    (450.0, (-10.78126, -18.47242, 48.50349)),
    (600.0, (-13.60463, -23.56058, 53.47548)),
])  # fmt: skip
def test_bathe_bolourchi_bend(force, tip):
    """G1, 45 degree bend: exact rod with GJ = G 2I (our own, by shooting), ours with curved elements.

    Measured at 8 elements: 2e-5. Published values differ in the torsion constant that they use.
    """
    section = Section(EA=1e7, GA=5e6 * 5 / 6, GJ=5e6 / 6, EI=1e7 / 12)
    arc = Arc(100.0, (-1.0, 0.0, 0.0), (0.0, 1.0, 0.0))
    rod = wirefe.curved_rod(arc, np.linspace(0.0, np.pi / 4, 9), section).holding(0)
    path = wirefe.solve_rod(rod.loaded(-1, force=(0.0, 0.0, force)), steps=4)
    np.testing.assert_allclose(path.displacements(-1)[-1], tip, rtol=2e-4)


def test_rolling_up_by_an_end_moment():
    """G2, exact: 2 pi EI / L closes the circle. Measured 2e-10 at 8 elements: exact for any number."""
    rod = wirefe.straight_rod(line(10.0, 8), Section(1e4, 1e4, 100.0, 100.0)).holding(0).in_plane()
    path = wirefe.solve_rod(rod.loaded(-1, moment=(0.0, 0.0, 20 * np.pi)), steps=2)
    half = 10.0 / np.pi  # diameter of the half circle at half the moment
    expected = [[-10.0, 2 * half, 0.0], [-10.0, 0.0, 0.0]]
    np.testing.assert_allclose(path.displacements(-1), expected, atol=1e-8)


def test_unrolling_a_circle():
    """G3, exact: displacements (0, 6.366) at half the moment, (10, 0) straight. Measured 2e-10."""
    section = Section(EA=1200.0, GA=500.0, GJ=100.0, EI=100.0)
    arc = Arc(10.0 / (2 * np.pi), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0))
    rod = wirefe.curved_rod(arc, np.linspace(0.0, 2 * np.pi, 5), section).holding(0).in_plane()
    path = wirefe.solve_rod(rod.loaded(-1, moment=(0.0, 0.0, -20 * np.pi)), steps=2)
    np.testing.assert_allclose(path.displacements(-1), [[0.0, 20 / np.pi, 0.0], [10.0, 0.0, 0.0]], atol=1e-8)


def nachbagauer(elements, force):
    h, b, nu, young = 0.5, 0.1, 0.3, 2.07e11
    shear = young / (2 * (1 + nu)) * h * b * 10 * (1 + nu) / (12 + 11 * nu)
    section = Section(young * h * b, shear, 1e8, young * b * h**3 / 12)
    rod = wirefe.straight_rod(line(2.0, elements), section).holding(0).in_plane()
    return wirefe.solve_rod(rod.loaded(-1, force=(0.0, -force * h**3, 0.0)), steps=2).displacements(-1)[-1]


def test_shear_flexible_cantilever():
    """G4, Nachbagauer 2011: large and small load; second order. Measured at 64: 2e-6 and 1e-6."""
    np.testing.assert_allclose(nachbagauer(64, 5e8)[:2], [-0.15097114, -0.71056860], rtol=1e-5)
    np.testing.assert_allclose(nachbagauer(64, 5e5)[:2], [-1.8884916e-7, -8.0990325e-4], rtol=1e-5)
    errors = [abs(nachbagauer(n, 5e8)[0] + 0.15097114) for n in (8, 16, 32)]
    np.testing.assert_allclose(np.log2(np.array(errors[:-1]) / errors[1:]), 2.0, atol=0.15)


@pytest.mark.parametrize(("load", "u", "w"), [
    (1.0, 0.05643324, 0.30172077),
    (2.0, 0.16064172, 0.49345748),
    (5.0, 0.38762836, 0.71379152),
    (10.0, 0.55499560, 0.81060902),
])  # fmt: skip
def test_elastica(load, u, w):
    """G5, P L^2/EI: exact elastica (our own; agrees with Mattiasson). Measured 3e-7 at 64 elements."""
    rod = wirefe.straight_rod(line(1.0, 64), Section(1e8, 1e8, 1.0, 1.0)).holding(0).in_plane()
    path = wirefe.solve_rod(rod.loaded(-1, force=(0.0, load, 0.0)), steps=2)
    np.testing.assert_allclose(path.displacements(-1)[-1, :2], [-u, w], rtol=1e-6)


def test_uniform_helix_under_a_wrench():
    """G9: Spring A's wire, 3 turns, clamped below; exact with shear and stretch (our own closed form).

    Measured at 16 curved elements per turn: 1e-7 of the deflection.
    """
    rod = wirefe.curved_rod(
        spring_a().spring, np.linspace(0.0, 6 * np.pi, 49), round_section(1.5, Material())
    )
    force, moment = (0.0, -19.998380153, 0.254541242), (0.42943653, 1.27390492, 100.08607929)
    path = wirefe.solve_rod(rod.holding(0).loaded(-1, force=force, moment=moment), steps=4)
    exact = np.array([-4.606e-5, -1.2155943661, -0.0813165661])
    assert np.abs(path.displacements(-1)[-1] - exact).max() <= 3e-7 * 1.2155943661


def lees_frame(n):
    """Rod of Lee's frame and the loaded node; 3 is more than its first limit load."""
    young, area, inertia = 720.0, 6.0, 2.0
    column = line(120.0, n)[:, [1, 0, 2]]
    beam = line(120.0, n) + np.array([0.0, 120.0, 0.0])
    section = Section(young * area, young / 2.6 * area * 5 / 6, 1e3, young * inertia)
    rod = wirefe.straight_rod(np.concatenate((column, beam[1:])), section).in_plane()
    rod = rod.holding(0, "ux", "uy").holding(2 * n, "ux", "uy")
    return rod.loaded(n + n // 5, force=(0.0, -3.0, 0.0)), n + n // 5


def test_lees_frame_has_its_limit_load():
    """G10: first limit load 1.85445 with axial and shear flexibility (our own, shooting). Measured 2e-6."""
    rod, _ = lees_frame(40)
    with pytest.raises(EquilibriumNotFound) as caught:
        wirefe.solve_rod(rod, steps=5)
    assert caught.value.outcome == "limit_point"
    assert 3.0 * caught.value.critical_time == pytest.approx(1.85445, rel=1e-5)
    assert (caught.value.path.times < caught.value.critical_time).all()


def test_lees_frame_past_its_limit_points():
    """G10: traced over the limit load at w = 48.74, through the snap-back beyond 61, up to load 3."""
    rod, node = lees_frame(40)
    path = wirefe.trace_rod(rod, points=400)
    load, w = 3.0 * path.times, -path.displacements(node)[:, 1]
    assert path.times[-1] >= 1.0
    peak = np.argmax(load[: len(load) // 3])
    assert load[peak] == pytest.approx(1.85445, rel=1e-4)
    assert w[peak] == pytest.approx(48.74, abs=0.5)  # points are spaced, the peak is flat
    assert w[:-1][np.diff(w) < 0.0].max() == pytest.approx(61.0, abs=0.5)  # snap-back begins
    falling = np.diff(load) < 0.0
    assert (path.negative_pivots[1:][falling] == 1).mean() > 0.9
    assert path.negative_pivots[0] == path.negative_pivots[-1] == 0


def test_dadeppo_schmidt_arch():
    """G11: hinged-clamped arch, critical force 897 (literature, not verified here). The angle is the one that
    fits, 215 degrees: with 145 there is no critical force. Measured 897.4 at 20 curved elements.
    """
    half = np.radians(215.0) / 2
    arc = Arc(100.0, (0.0, 1.0, 0.0), (1.0, 0.0, 0.0))
    rod = wirefe.curved_rod(arc, np.linspace(-half, half, 21), Section(1e8, 1e8, 1e6, 1e6)).in_plane()
    rod = rod.holding(0).holding(20, "ux", "uy").loaded(10, force=(0.0, -1000.0, 0.0))
    with pytest.raises(EquilibriumNotFound) as caught:
        wirefe.solve_rod(rod, steps=4)
    assert caught.value.outcome == "limit_point"
    assert 1000.0 * caught.value.critical_time == pytest.approx(897.3, rel=1e-3)


def test_euler_column_bifurcates():
    """Clamped-free column, exact: pi^2 EI / (4 L^2); nearly inextensible. Second order in the mesh."""
    rod = wirefe.straight_rod(line(1.0, 40), Section(1e8, 1e8, 1.0, 1.0)).holding(0).in_plane()
    with pytest.raises(EquilibriumNotFound) as caught:
        wirefe.solve_rod(rod.loaded(-1, force=(-5.0, 0.0, 0.0)), steps=3)
    assert caught.value.outcome == "bifurcation"
    assert 5.0 * caught.value.critical_time == pytest.approx(np.pi**2 / 4, rel=2e-4)


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
        (lambda rod: wirefe.straight_rod(np.zeros((1, 3)), Section(1, 1, 1, 1)), "points must be finite"),
        (lambda rod: wirefe.solve_rod(rod.loaded(1, force=(1, 0, 0)), steps=0), "steps must be an integer"),
    ],
)
def test_bad_rods(change, words):
    with pytest.raises(InputError, match=words):
        change(wirefe.straight_rod(line(1.0, 2), Section(1.0, 1.0, 1.0, 1.0)))


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
