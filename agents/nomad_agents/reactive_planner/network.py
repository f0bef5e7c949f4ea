"""The modular network: categories, their exemplars and weights to the action units (section 3.2).

A module is one category and its exemplars. Both are made on demand and kept in growing arrays.
"""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from nomad_mj.types import FloatArray, IntArray

_FIRST_CAPACITY = 128
CATEGORY_FIELDS = ("prototype", "value", "initial_value", "trace", "best_action")
EXEMPLAR_FIELDS = ("situation", "weights", "category")


class Match(NamedTuple):
    """The winner of a categorisation.

    Attributes
    ----------
    category : int
        The winning category, -1 where no exemplar matches.
    activation : array (n,)
        Output of every exemplar (Eq 9).
    """

    category: int
    activation: FloatArray


class Network:
    """Categories and exemplars in arrays, n of them in use at a time.

    Attributes
    ----------
    prototype : array (categories, 2)
        Prototypical actions.
    value, initial_value : array (categories,)
        Expected cumulative reinforcement b_j, now and as the planner promised it.
    trace : array (categories,)
        h_j of Eq 14.
    best_action : array (categories, 2)
        ba_j of section 5.
    situation : array (exemplars, size)
        Exemplars' coordinates.
    weights : array (exemplars, 2)
        To the action units.
    category : array (exemplars,)
        The category of each exemplar.
    """

    def __init__(self, size: int) -> None:
        self._categories = self._exemplars = 0
        room = _FIRST_CAPACITY
        self._store: dict[str, np.ndarray] = {
            "prototype": np.zeros((room, 2)),
            "value": np.zeros(room),
            "initial_value": np.zeros(room),
            "trace": np.zeros(room),
            "best_action": np.zeros((room, 2)),
            "situation": np.zeros((room, size)),
            "weights": np.zeros((room, 2)),
            "category": np.zeros(room, dtype=np.intp),
        }
        self._refresh()

    def _refresh(self) -> None:
        """Point the public names at the part of the store that is in use."""
        store, c, e = self._store, self._categories, self._exemplars
        self.prototype: FloatArray = store["prototype"][:c]
        self.value: FloatArray = store["value"][:c]
        self.initial_value: FloatArray = store["initial_value"][:c]
        self.trace: FloatArray = store["trace"][:c]
        self.best_action: FloatArray = store["best_action"][:c]
        self.situation: FloatArray = store["situation"][:e]
        self.weights: FloatArray = store["weights"][:e]
        self.category: IntArray = store["category"][:e]

    def __getstate__(self) -> dict[str, np.ndarray]:
        """Return what a copy needs; the public arrays are views, which would not survive it."""
        return self._store | self.arrays()

    def __setstate__(self, state: dict[str, np.ndarray]) -> None:
        self._store = state
        self.restore(state)

    def arrays(self) -> dict[str, np.ndarray]:
        """Return copies of all that has been learnt, by name."""
        return {name: getattr(self, name).copy() for name in CATEGORY_FIELDS + EXEMPLAR_FIELDS}

    def restore(self, arrays: Mapping[str, np.ndarray]) -> None:
        """Take over what `arrays` returned of another network of the same size.

        Raises
        ------
        ValueError
            An array that is missing, of another shape or kind, or refers to no category.
        """
        for name in CATEGORY_FIELDS + EXEMPLAR_FIELDS:
            if name not in arrays:
                raise ValueError(f"it lacks the array {name!r}")
        categories, exemplars = len(arrays["value"]), len(arrays["category"])
        store: dict[str, np.ndarray] = {}
        for names, count in ((CATEGORY_FIELDS, categories), (EXEMPLAR_FIELDS, exemplars)):
            for name in names:
                own, array = self._store[name], arrays[name]
                if array.shape != (count, *own.shape[1:]) or array.dtype != own.dtype:
                    raise ValueError(f"array {name!r} has shape {array.shape}, type {array.dtype}")
                if not np.isfinite(array).all():
                    raise ValueError(f"array {name!r} holds numbers that are not finite")
                room = max(count, _FIRST_CAPACITY)
                store[name] = np.zeros((room, *own.shape[1:]), dtype=own.dtype)
                store[name][:count] = array
        owners = arrays["category"]
        if exemplars and not (owners.min() >= 0 and owners.max() < categories):
            raise ValueError("an exemplar belongs to no category")
        self._store, self._categories, self._exemplars = store, categories, exemplars
        self._refresh()

    def _make_room(self, names: tuple[str, ...], used: int) -> None:
        for name in names:
            if used == len(self._store[name]):
                old = self._store[name]
                self._store[name] = np.concatenate([old, np.zeros_like(old)])

    def add_category(self, prototype: FloatArray, value: float) -> int:
        """Return the number of a new category with this prototypical action (2,) and value."""
        self._make_room(CATEGORY_FIELDS, self._categories)
        self._categories += 1
        self._refresh()
        self.prototype[-1] = self.best_action[-1] = prototype
        self.value[-1] = self.initial_value[-1] = value
        self.trace[-1] = 0.0
        return self._categories - 1

    def find_category(self, prototype: FloatArray, value: float, tolerance: float) -> int:
        """Return the category that a plan belongs to, -1 where there is none.

        Its prototypical action is the same and its initial value differs by no more than
        `tolerance`; the nearest such value wins.
        """
        off = np.abs(self.initial_value - value)
        off = np.where((self.prototype == prototype).all(axis=1), off, np.inf)
        best = int(np.argmin(off)) if len(off) else -1
        return best if best >= 0 and off[best] <= tolerance else -1

    def add_exemplar(self, situation: FloatArray, category: int) -> None:
        """Store a situation (size,) as a new exemplar of a category, in one shot."""
        self._make_room(EXEMPLAR_FIELDS, self._exemplars)
        self._exemplars += 1
        self._refresh()
        self.situation[-1] = situation
        self.weights[-1] = 0.0
        self.category[-1] = category

    def classify(self, situation: FloatArray, k_dist: float, k_ind: float) -> Match:
        """Return the category that a situation (size,) belongs to (section 3.2.1).

        Among the categories whose closest exemplar's output is within `k_ind` of the highest,
        the one with the highest value wins.
        """
        if not self._exemplars:
            return Match(-1, np.zeros(0))
        off = self.situation - situation
        distance = np.sqrt(np.einsum("ij,ij->i", off, off))
        activation = np.where(distance < k_dist, np.exp(-distance), 0.0)
        highest = activation.max()
        if highest == 0.0:
            return Match(-1, activation)
        rivals = self.category[activation >= max(highest - k_ind, np.finfo(float).tiny)]
        return Match(int(rivals[np.argmax(self.value[rivals])]), activation)

    def nearest(self, situation: FloatArray) -> Match:
        """Return the category of the nearest exemplar, however far it is."""
        return self.classify(situation, np.inf, 0.0)
