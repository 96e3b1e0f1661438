"""Shared checks: derivatives by differences, and a store of the session's own."""

from __future__ import annotations

import os

import numpy as np
import pytest


@pytest.fixture(scope="session", autouse=True)
def _store_of_the_session(tmp_path_factory):
    """Nothing is read from or left in the user's store."""
    os.environ["COILCHECK_STORE"] = str(tmp_path_factory.mktemp("store"))


@pytest.fixture
def own_store(tmp_path_factory, monkeypatch):
    """A store of the test alone, empty."""
    folder = tmp_path_factory.mktemp("own-store")
    monkeypatch.setenv("COILCHECK_STORE", str(folder))
    return folder


@pytest.fixture
def first_order_elements(monkeypatch):
    """Curved elements of the first order, with which springs were found that are hard to follow: with those
    of the second they are others."""
    monkeypatch.setattr("wirefe.rod.second_order", lambda *given: given[-1].fill(0.0))
    monkeypatch.setattr("validation.campaign.wireparts._second", lambda twists, _: 0.0 * twists[:6])


@pytest.fixture
def check_derivatives():
    """Compare a gradient and a Hessian with central differences, relative to their largest entry.

    The returned function takes ``energy(step) -> (value, gradient, Hessian)`` at small steps from
    the state and the number of dofs. Steps are extrapolated once (h and h/2).
    """

    def check(energy, size, h=2e-4, tolerance=1e-6):
        _, g, H = energy(np.zeros(size))

        def central(step):
            columns = []
            for i in range(size):
                e = np.zeros(size)
                e[i] = step
                ahead, behind = energy(e), energy(-e)
                columns.append(((ahead[0] - behind[0]) / (2 * step), (ahead[1] - behind[1]) / (2 * step)))
            return np.array([c[0] for c in columns]), np.array([c[1] for c in columns])

        (g1, H1), (g2, H2) = central(h), central(h / 2)
        slope, rows = (4 * g2 - g1) / 3, (4 * H2 - H1) / 3
        assert np.abs(slope - g).max() <= tolerance * np.abs(g).max()
        # along spins the gradient turns: its difference is the Hessian up to a skew part that the
        # symmetric one leaves out, so compare the symmetric parts
        assert np.abs(0.5 * (rows + rows.T) - H).max() <= tolerance * np.abs(H).max()
        assert np.abs(H - H.T).max() <= 1e-12 * np.abs(H).max()

    return check
