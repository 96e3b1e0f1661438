"""Sphere contact of the wire model: by hand, by differences, and in balance."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from coilspring.contact import forces as pairforces
from coilspring.contact import law as pairlaw
from coilspring.contact import pairs
from coilspring.contact.forces import tangential_forces
from coilspring.contact.kinematics import BETWEEN, approach, spheres
from coilspring.contact.law import PairLaw, arc, normal_law, pair_potential, tangential_stiffness
from coilspring.contact.pairs import accept, update
from coilspring.contact.results import PairReader
from coilspring.contact.transitions import FINEST, TOUCHING, update_bound
from pairrecords import held, pair_records
from wirefe.contact.spheres import pair_matrix

D, K = 1.5, 1.0e4


def law(k=1.0, mu=0.0):
    return PairLaw(D, K, tangential_stiffness(K, k, D), k, mu)


LAW = law()
FREE = pair_records()[0]
ARMS = np.array([[0.3, -0.2, 0.7], [5.0, 0.4, -0.8]])  # of spheres on rigid ends


def pair(d, gap, k=1.0, history=FREE):
    """Pair with the nodes moved by d = (x, spin, x, spin) from a state with the given gap."""
    arms = [Rotation.from_rotvec(d[3:6]).apply(ARMS[0]), Rotation.from_rotvec(d[9:]).apply(ARMS[1])]
    direction = np.array([0.2, 0.9, -0.1]) / np.linalg.norm([0.2, 0.9, -0.1])
    w = (D + gap) * direction + d[6:9] + arms[1] - ARMS[1] - d[:3] - arms[0] + ARMS[0]
    f, H = np.empty(3), np.empty((3, 3))
    energy = pair_potential(w, np.linalg.norm(w), law(k), history, np.empty(3), f, H)
    g, full = np.empty(12), np.empty((12, 12))
    pair_matrix(f, H, *arms, g, full)
    return energy, g, full


def stuck(bound=np.inf, rise=0.0):
    return held(np.array([0.25, 1.42, -0.2]), bound, rise=rise)


def test_force_by_hand():
    f, H = np.empty(3), np.empty((3, 3))
    energy = pair_potential(np.array([0.0, 1.4, 0.0]), 1.4, LAW, FREE, np.empty(3), f, H)
    assert energy == pytest.approx(50.0)
    np.testing.assert_allclose(f, [0.0, -1000.0, 0.0])
    np.testing.assert_allclose(H, np.diag([-1000 / 1.4, 1e4, -1000 / 1.4]), atol=1e-9)


def test_normal_law_is_a_potential():
    for k in (1.0, 1.5, 3.0):
        energies, forces, _ = zip(*(normal_law(0.1 + step, K, k) for step in (-1e-6, 0.0, 1e-6)), strict=True)
        assert normal_law(0.1, K, k)[1] == pytest.approx((energies[2] - energies[0]) / 2e-6)
        assert normal_law(0.1, K, k)[2] == pytest.approx((forces[2] - forces[0]) / 2e-6)


def _stiffening(penetration, K, k):
    """Another law, with a branch: twice as stiff from 0.05 mm on."""
    beyond = max(penetration - 0.05, 0.0)
    F = K * (penetration + beyond)
    return 0.5 * K * (penetration**2 + beyond**2), F, K * (2.0 if beyond > 0.0 else 1.0)


class Reader(PairReader):
    """Two pairs along y: one that penetrates by 0.1 mm, one that is open."""

    pair_law = LAW
    update_history = None

    def pair_vectors(self, states):
        return np.array([[[0.0, D - 0.1, 0.0], [0.0, D + 0.1, 0.0]]])


def test_an_edited_law_is_that_of_kernels_of_readers_and_of_friction(monkeypatch):
    for module in (pairlaw, pairs, pairforces):
        monkeypatch.setattr(module, "normal_law", _stiffening)
    f, H = np.empty(3), np.empty((3, 3))
    g = np.array([0.0, D - 0.1, 0.0])
    energy = pair_potential(g, D - 0.1, LAW, FREE, np.empty(3), f, H)
    assert energy == pytest.approx(0.5 * K * (0.1**2 + 0.05**2))
    assert H[1, 1] == pytest.approx(2.0 * K)
    np.testing.assert_allclose(f, [0.0, -1500.0, 0.0])
    np.testing.assert_allclose(Reader().pair_forces(None), [[1500.0, 0.0]])
    history = pair_records(closed=True, normal=(0.0, 1.0, 0.0), bound=1.0, whole=K)
    update(spheres(), law(mu=0.3), (g[None], g[None], g[None]), history)
    assert history[0].bound == pytest.approx(0.3 * 1500.0 * (D - 0.1) / D)


def test_sliding_potential_by_hand():
    """0.1 mm of slip along x holds back with 1000 N; what goes along n0 is not slip."""
    f, H = np.empty(3), np.empty((3, 3))
    history = held(np.array([0.0, 1.45, 0.0]))
    energy = pair_potential(np.array([0.1, 1.6, 0.0]), np.hypot(0.1, 1.6), LAW, history, np.empty(3), f, H)
    assert energy == pytest.approx(0.5 * K * 0.1**2)
    np.testing.assert_allclose(f, [1000.0, 0.0, 0.0], atol=1e-9)
    np.testing.assert_allclose(H, np.diag([K, 0.0, K]))


@pytest.mark.parametrize("k", [1.0, 1.5, 2.0])
@pytest.mark.parametrize(
    "history",
    [FREE, stuck(), stuck(300.0), stuck(1e4), stuck(300.0, 0.5)],
    ids=["frictionless", "no-sliding", "friction", "sticking", "rising"],
)
def test_derivatives_closed(check_derivatives, k, history):
    check_derivatives(lambda d: pair(d, -0.05, k, history), 12, h=1e-4)


def test_derivatives_just_closed(check_derivatives):
    check_derivatives(lambda d: pair(d, -1e-3), 12, h=1e-5)


def test_open_pair_does_nothing():
    energy, g, H = pair(np.zeros(12), 1e-6)
    assert energy == 0.0
    assert not g.any()
    assert not H.any()


@pytest.mark.parametrize(
    "history", [FREE, stuck(), stuck(300.0)], ids=["frictionless", "no-sliding", "friction"]
)
def test_pair_sums_to_zero_force_and_moment(history):
    """Moments about node A; without sliding the tangential force acts along g only up to the slip."""
    _, g, _ = pair(np.zeros(12), -0.05, history=history)
    np.testing.assert_allclose(g[:3] + g[6:9], 0.0, atol=1e-9)
    w = (D - 0.05) * np.array([0.2, 0.9, -0.1]) / np.linalg.norm([0.2, 0.9, -0.1])
    centre_to_centre = w
    moment = g[3:6] - np.cross(ARMS[0], g[:3]) + g[9:] - np.cross(ARMS[1], g[6:9])
    np.testing.assert_allclose(moment, 0.0, atol=1e-9)  # each node's moment is its arm x its force
    if not history.closed:
        np.testing.assert_allclose(np.cross(centre_to_centre, g[6:9]), 0.0, atol=1e-9)


def sliding(bound=300.0, rise=0.0):
    """Record of a pair that had its direction along y, and held its bound from the beginning."""
    return held(np.array([0.0, D, 0.0]), bound, rise=rise, held=bound, before=bound / K)


def tilted(angle, h):
    """Vector between the centres, tilted by an angle from y to x."""
    return h * np.array([np.sin(angle), np.cos(angle), 0.0])


def accepted(row, g, mu):
    """The record after a state with the vector g was accepted."""
    history = np.rec.array(np.array([row], dtype=row.dtype))
    accept(spheres(), law(mu=mu), g[None], history)
    return history[0]


def test_friction_by_hand():
    """An arc of 0.1 mm against a bound of 300 N: 0.03 mm is elastic, 0.07 mm slides; what slid stays.

    The bound is one at the arm d, so that the force is larger by d/h, and it turns with the pair.
    """
    f, H, e = np.empty(3), np.empty((3, 3)), np.empty(3)
    row, h, angle = sliding(), 1.4, 0.1 / D
    g = tilted(angle, h)
    energy = pair_potential(g, h, LAW, row, e, f, H)
    assert energy == pytest.approx(0.5 * K * 0.1**2 + 0.5 * K * 0.03**2 + 300.0 * 0.07)
    f += 1000.0 * g / h  # less the normal force
    np.testing.assert_allclose(f, 300.0 * D / h * np.array([np.cos(angle), -np.sin(angle), 0.0]), atol=1e-9)
    assert H[2, 2] == pytest.approx(300.0 * D / h**2 / np.tan(angle) - 1000.0 / h)
    row = accepted(row, g, 0.3)
    np.testing.assert_allclose([row.bound, row.slid, row.work], [300.0, 0.07, 21.0])
    np.testing.assert_allclose(row.normal, tilted(angle - 0.03 / D, 1.0))
    np.testing.assert_allclose(tangential_forces(g, row, D), f)


def test_a_pair_slides_with_the_bound_that_it_meets():
    """From 100 N of 600 N to 400 N of 300 N: they meet at 350 N. One that opens half way, where it would hold
    200 N, meets its bound at 1200 / 7 N, and slides by 200 N / K up to there."""
    row = sliding()
    row.held, row.before, row.deep = 600.0, 100.0 / K, 0.01
    g = tilted(400.0 / K / D, D - 1e-12)
    work = 0.5 * (350.0 + 300.0) * 100.0 / K
    assert accepted(row, g, 0.3).work == pytest.approx(work)
    row.bound = 0.0
    g = tilted(300.0 / K / D, D + 0.01)
    work = 0.5 * 1200.0 / 7.0 * 200.0 / K
    assert accepted(row, g, 0.3).work == pytest.approx(work)
    assert accepted(row, g, 0.3).slid == pytest.approx(200.0 / K)


def test_the_work_of_a_pair_that_opens_does_not_depend_on_its_lead():
    """From 300 N one way to 700 N the other way, and half way it opens; its reference is ahead, or is not."""
    works = []
    for ahead in (0.0, 0.02, -0.02):
        row = sliding(0.0)
        row.held, row.before, row.deep, row.ahead = 300.0, -0.03 - ahead, 0.01, ahead
        g = tilted((0.07 - ahead) / D, D + 0.01)
        works.append(accepted(row, g, 0.3).work)
    slip = 0.5 * (0.07 - 0.03)
    share = (300.0 + 0.03 * K) / (300.0 + 0.03 * K + K * slip)
    np.testing.assert_allclose(works, 0.5 * 300.0 * (1.0 - share) * slip)


def test_a_pair_that_opens_before_it_turns_round_gives_up_what_it_held():
    """From -300 N it would hold 100 N at the end, and opens after a tenth of that: at -260 N."""
    row = sliding(0.0)
    row.held, row.before, row.deep = 300.0, -300.0 / K, 0.001
    g = tilted(100.0 / K / D, D + 0.009)
    work = 0.5 * 300.0 * 260.0 / K
    assert accepted(row, g, 0.3).work == pytest.approx(work)


def test_rising_bound_by_hand():
    """300 N that rise by 10 % a mm: K (0.1 - s) = 300 (1 + 0.1 s); the work is that of the mean bound."""
    f, H, e = np.empty(3), np.empty((3, 3)), np.empty(3)
    row, g = sliding(rise=0.1), tilted(0.1 / D, D)
    slip = (K * 0.1 - 300.0) / (K + 30.0)
    force = 300.0 * (1.0 + 0.1 * slip)
    energy = pair_potential(g, D, LAW, row, e, f, H)
    assert energy == pytest.approx(0.5 * force**2 / K + 0.5 * (300.0 + force) * slip)
    assert np.linalg.norm(f) == pytest.approx(force)
    row = accepted(row, g * (1.0 - 1e-12), 0.3)
    np.testing.assert_allclose([row.bound, row.slid, row.work], [force, slip, 0.5 * (300.0 + force) * slip])


def vectors(*rows):
    return [np.array([row]) for row in rows]


def test_a_pair_is_held_from_where_it_touches_first_on_the_predicted_way():
    """It comes down along y and moves along x: on the straight line to what was predicted."""
    history = pair_records(1)
    before, ahead, trial = vectors([0.0, 1.01 * D, 0.0], [0.2, 0.99 * D, 0.0], [0.2001, 0.991 * D, 0.0])
    update(spheres(), law(mu=np.inf), (before, ahead, trial), history)
    row = history[0]
    assert row.closed
    assert row.fresh
    assert np.linalg.norm(row.vector) == pytest.approx(D)
    share = row.vector[0] / 0.2
    assert row.vector == pytest.approx(before[0] + share * (ahead[0] - before[0]))
    assert share < row.cut < 1.0  # the straight way to the trial state touches elsewhere: it is in doubt
    near = before[0] + 1e-3 * (trial[0] - before[0])
    history = pair_records(1)
    update(spheres(), law(mu=np.inf), (vectors(near)[0] * 0.98, ahead, trial), history)
    assert history[0].vector == pytest.approx(near * 0.98)  # it touched there already


def test_a_touch_on_the_way_is_predicted_where_a_sticking_pair_is_open_at_its_end():
    """It passes at 0.9 d. Without friction nothing is remembered of it."""
    mu, (before, after) = np.inf, vectors([-D, 0.9 * D, 0.0], [D, 0.9 * D, 0.0])
    assert approach(before, after, D, mu)[1] == BETWEEN
    assert approach(before, after, D, 0.0)[1] == 1.0
    inside = np.array([[-0.1 * D, 0.9 * D, 0.0]])
    touch = before[0] + approach(before, inside, D, mu)[1] * (inside[0] - before[0])
    assert np.linalg.norm(touch) == pytest.approx(D, rel=2e-4)
    assert approach(*vectors([-D, 1.01 * D, 0.0], [D, 1.01 * D, 0.0]), D, mu)[1] == 1.0


@pytest.mark.parametrize("share", [-1.0, 0.0, 0.5, 2.0])
def test_a_pair_that_touches_but_for_rounding_sticks(share):
    """Whichever sign rounding gives its gap at rest; one with friction holds nothing while it is open."""
    gap = share * TOUCHING * D
    history = pair_records(1)
    for _ in range(2):  # it stays so
        least = accept(spheres(), law(mu=np.inf), vectors([0.0, D + gap, 0.0])[0], history)
        assert history[0].closed == (share < 1.0)
        assert not history[0].opening
        assert least <= 0.0 or share > 1.0
    if gap >= 0.0:
        history = pair_records(1)
        accept(spheres(), law(mu=0.3), vectors([0.0, D + gap, 0.0])[0], history)
        assert not history[0].closed


def test_a_pair_that_has_touched_at_rest_alone_has_done_no_work():
    """The bound of its friction is not known yet."""
    row = held(np.array([0.0, D, 0.0]), held=np.inf)
    with np.errstate(invalid="ignore"):
        assert accepted(row, np.array([0.0, D, 0.0]), 0.3).work == 0.0


def test_an_opening_pair_that_sticks_gives_back_what_it_held_as_dissipated():
    """K e = 500 N are held at 0.05 mm of slip; released over 0.02 mm more, half of them work."""
    row = held(np.array([0.0, D, 0.0]))
    row = accepted(row, np.array([0.05, 1.001 * D, 0.0]), np.inf)
    assert row.opening
    assert row.closed
    assert [row.kept, row.held] == pytest.approx([1.0, 500.0])
    row.released = 1.0
    g = np.array([0.07, 1.001 * D, 0.0])
    assert np.linalg.norm(tangential_forces(g, row, D)) == 0.0
    row = accepted(row, g, np.inf)
    assert not row.closed
    assert not row.opening
    assert [row.work, row.slid] == pytest.approx([0.5 * 500.0 * 0.07, 0.07])


def test_a_release_in_parts_loses_as_much_as_at_once():
    """On a line from 500 N at 0.05 mm to none at 0.07 mm, as a linear spring takes it."""
    row = accepted(held(np.array([0.0, D, 0.0])), np.array([0.05, 1.001 * D, 0.0]), np.inf)
    for stretch, force in ((0.055, 375.0), (0.06, 250.0), (0.07, 0.0)):
        assert row.opening
        row.released = 1.0 - force / (K * stretch)
        g = np.array([stretch, 1.001 * D, 0.0])
        assert np.linalg.norm(tangential_forces(g, row, D)) == pytest.approx(force)
        row = accepted(row, g, np.inf)
    assert not row.closed
    assert row.work == pytest.approx(0.5 * 500.0 * 0.07)


def test_a_pair_that_touches_again_grazes_with_what_it_holds():
    """It sticks from there with the whole stiffness; what it lost is the energy that is missing."""
    row = accepted(held(np.array([0.0, D, 0.0])), np.array([0.05, 1.001 * D, 0.0]), np.inf)
    row.released = 1.0 - 250.0 / (K * 0.06)
    g = 0.99999 * D * np.array([np.sin(0.04), np.cos(0.04), 0.0])
    before = tangential_forces(g, row, D)
    assert np.linalg.norm(before) == pytest.approx(250.0, rel=1e-3)
    row = accepted(row, g, np.inf)
    assert row.grazes
    # across the pair as it is now
    np.testing.assert_allclose(tangential_forces(g, row, D), before, rtol=2e-3, atol=15.0)
    work, slip = row.work, row.slid
    assert min(work, slip) > 0.0
    row = accepted(row, g, np.inf)
    assert [row.work, row.slid] == pytest.approx([work, slip])


@pytest.mark.parametrize("rise", [0.0, 0.1, -0.1])
def test_renewed_bound_is_met_at_the_slip_found(rise):
    """However the bound rises: the force at this very state is then the bound asked for."""
    row, g, e, f = sliding(rise=rise), tilted(0.1 / D, D), np.empty(3), np.empty(3)
    assert update_bound(D * arc(g, D, row, e), 250.0, LAW.d, row) > 0.0
    pair_potential(g, D, LAW, row, e, f, np.empty((3, 3)))
    assert np.linalg.norm(f) == pytest.approx(250.0)
    assert update_bound(D * arc(g, D, row, e), 250.0, LAW.d, row) == pytest.approx(0.0, abs=1e-10)


def test_a_slide_of_rounding_size_is_perpendicular_to_the_pair():
    """What is left of the pair's direction would be a stiffness below zero, of hard contact a large one."""
    rng, t = np.random.default_rng(1), np.empty(3)
    for _ in range(20):
        row = held(rng.normal(size=3))
        g = np.asarray(row.normal) + 5e-12 * rng.normal(size=3)
        arc(g, np.linalg.norm(g), row, t)
        assert np.linalg.norm(t) == pytest.approx(1.0)
        assert abs(t @ g) < 1e-15


def test_a_pair_that_just_touches_slides_no_sooner_than_positions_are_rounded():
    hard = PairLaw(D, 1e9, 1e9, 1.0, 0.3)
    row = held(np.array([0.0, D, 0.0]))
    row.whole = hard.kt
    for bound, stiffness in ((1.0, 1e9), (1e-6, 1e-6 / (FINEST * D))):
        update_bound(0.0, bound, hard.d, row)
        assert row.stiffness == pytest.approx(stiffness)
