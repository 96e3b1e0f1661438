"""What is read of contact pairs off a model's states, from the vectors between their centres."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any

import numpy as np

from coilspring.compiling.packing import pack
from coilspring.contact.forces import normal_forces, tangential_forces
from coilspring.contact.law import PAIR_HISTORY
from coilspring.path import Friction


class PairReader(ABC):
    """The part of `coilspring.path.Shape` that is the same for all models."""

    data: Any  # the model's arrays

    @property
    @abstractmethod
    def update_history(self) -> Callable:
        """The model's kernel, see `coilspring.solver.interface`."""

    @property
    @abstractmethod
    def pair_law(self) -> Any:
        """What holds the pairs: a `coilspring.contact.law.PairLaw`, or arrays with its fields."""

    @property
    def pair_stiffness(self) -> float | np.ndarray:
        """Penalty of all pairs, or of each, (pairs,), N/mm^k."""
        return float(self.pair_law.kc)

    @abstractmethod
    def pair_vectors(self, states: np.ndarray) -> np.ndarray:
        """Vectors between the centres of the pairs, shape (states, pairs, 3), mm."""

    def histories(self, given: np.ndarray | None, states: np.ndarray) -> np.ndarray:
        """The contact histories given, or of states where none is remembered, shape (states, pairs)."""
        return np.zeros((len(states), len(self.pair_law.pairs)), PAIR_HISTORY) if given is None else given

    def pair_gaps(self, states: np.ndarray) -> np.ndarray:
        """Gap of every pair, negative where it penetrates, shape (states, pairs), mm."""
        return np.linalg.norm(self.pair_vectors(states), axis=-1) - self.pair_law.d

    def pair_forces(self, states: np.ndarray) -> np.ndarray:
        """Normal force of every pair, shape (states, pairs), N."""
        return normal_forces(-self.pair_gaps(states), self.pair_stiffness, self.pair_law.k)

    def pair_friction(self, states: np.ndarray, histories: np.ndarray) -> Friction:
        """Tangential forces (states, pairs, 3), N, slips, mm, and frictional work, N mm, of every pair."""
        after, held = self.accepted(states, histories), histories["closed"]
        work = np.where(held, after["work"], histories["work"])
        return Friction(self.tangential_forces(states, histories), after["slid"] * held, work)

    def tangential_forces(self, states: np.ndarray, histories: np.ndarray) -> np.ndarray:
        """Tangential force of every pair, shape (states, pairs, 3), N."""
        return tangential_forces(self.pair_vectors(states), histories, self.pair_law.d)

    def accepted(self, states: np.ndarray, histories: np.ndarray) -> np.ndarray:
        """The contact histories with which a path goes on from each of the states, shape (states, pairs)."""
        data, after = pack(self.data), histories.copy()
        for state, history in zip(states, after, strict=True):
            self.update_history(*data, state, history)
        return after
