"""Worlds that wait, begin anew or start elsewhere leave the others as they are."""

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from identity import Env, check_same, drawn_actions, singles

from nomad_mj import BatchPathFinding, NomadError, load, load_batch
from nomad_mj.batch import world_seed

ROOMS = ["paper_room", "hall", "paper_room"]
COUNT = len(ROOMS)
STARTS: list[Any] = [2, None, (5.0, 1.5, 1.0)]
masks = st.lists(st.booleans(), min_size=COUNT, max_size=COUNT)


@pytest.fixture(scope="module", params=["motor", "path_finding"])
def pair(request: pytest.FixtureRequest) -> Any:
    ones = singles(request.param, ROOMS, "nomad200", {})
    many = load_batch(request.param, room=ROOMS, task_kwargs={"random": 0}, threads=2)
    yield many, ones
    many.close()
    for one in ones:
        one.close()


@settings(max_examples=12)
@given(
    st.lists(
        st.tuples(st.sampled_from(["step", "reset", "seed", "start"]), masks),
        min_size=1,
        max_size=8,
    )
)
def test_any_sequence_of_masked_steps_and_resets_is_that_of_the_single_environments(
    pair: tuple[Any, list[Env]], script: list[tuple[str, list[bool]]]
) -> None:
    many, ones = pair
    last = [one.reset(seed=7 + world) for world, one in enumerate(ones)]
    check_same(many.reset(seed=7), last, "begin")
    for number, (actions, (what, mask)) in enumerate(
        zip(drawn_actions(many, len(script)), script, strict=True)
    ):
        if what == "step":
            told = many.step(actions, mask)
        else:
            told = many.reset(
                seed=number if what == "seed" else None,
                starts=STARTS if what == "start" else None,
                mask=mask,
            )
        for world in np.flatnonzero(mask).tolist():
            if what == "step":
                last[world] = ones[world].step(actions[world])
            else:
                seed = number + world if what == "seed" else None
                start = STARTS[world] if what == "start" else None
                last[world] = ones[world].reset(seed, start)
        check_same(told, last, (number, what, mask))


def test_moves_by_the_control_step_are_those_of_whole_steps() -> None:
    """Nobody waits: whoever has finished begins its next move at once."""
    ones = singles("path_finding", ROOMS, "nomad200", {}, time_limit=8.0)
    kwargs: dict[str, Any] = {"room": ROOMS, "task_kwargs": {"random": 0}}
    many: BatchPathFinding
    with load_batch(environment_kwargs={"time_limit": 8.0}, threads=2, **kwargs) as many:
        many.reset()
        actions = list(drawn_actions(many, 5))
        done = [0] * COUNT
        alone = [one.reset() for one in ones]
        busy: set[int] = set()
        while min(done) < len(actions):
            free = np.array([d < len(actions) for d in done]) & ~many.moving
            chosen = np.array([actions[min(d, len(actions) - 1)][w] for w, d in enumerate(done)])
            many.start_moves(chosen, free)
            finished = many.advance()
            ended = finished | (free & ~many.moving & ~finished)
            for world in np.flatnonzero(ended).tolist():
                alone[world] = ones[world].step(actions[done[world]][world])
                done[world] += 1
                told = many.time_step().world(world)
                assert told[:3] == alone[world][:3]
                for name, value in alone[world].observation.items():
                    assert told.observation[name].tobytes() == np.asarray(value).tobytes(), name
            busy.add(int(many.moving.sum()))
        assert len(busy) > 1  # they did end at different times
    for one in ones:
        one.close()


def test_seeds_of_worlds_are_those_of_single_environments() -> None:
    sequence = np.random.SeedSequence(5, spawn_key=(1,))
    with load_batch("motor", 3, threads=1) as many, load("motor") as one:
        for seed in (40, sequence):
            told = many.reset(seed=seed)
            check_same(told, [one.reset(seed=world_seed(seed, w)) for w in range(3)], seed)
        told = many.reset(seed=[9, sequence, 9])
        check_same(told, [one.reset(seed=s) for s in (9, sequence, 9)], "each")
        assert sequence.n_children_spawned == 0
        first = many.reset(seed=[1, 2, 3]).world(1)
        again = many.reset(seed=[None, 2, None], mask=[False, True, False]).world(1)
        assert first.observation["sonar"].tobytes() == again.observation["sonar"].tobytes()


@pytest.mark.parametrize(
    ("method", "arguments", "says"),
    [
        ("reset", {"starts": [0, 0, 99]}, "world 2: start 99: the room's are numbered"),
        ("reset", {"starts": ["x", 0, 0]}, "world 0: unknown start 'x'; there are"),
        ("reset", {"starts": [0]}, "starts: there are 1, but 3 worlds"),
        ("reset", {"seed": -3}, "seed -3: must be a whole number"),
        ("reset", {"seed": [1, 2]}, "seed [1, 2]: must be a whole number, or one for each of 3"),
        ("reset", {"seed": [50, -1, 7], "starts": [1, 1, 1]}, "seed -1: must be a whole number"),
        ("reset", {"mask": [True]}, "mask: must be 3 times True or False"),
        ("step", {"actions": np.zeros((3, 2)), "mask": [1, 0, 0]}, "mask: must be 3 times True"),
    ],
)
def test_what_is_wrong_is_told_in_a_line_and_changes_nothing(
    method: str, arguments: dict[str, Any], says: str
) -> None:
    options: dict[str, Any] = {"count": 3, "threads": 1, "task_kwargs": {"random": 1}}
    with load_batch(**options) as many, load_batch(**options) as twin:
        before, _ = many.reset(), twin.reset()
        with pytest.raises(NomadError) as caught:
            getattr(many, method)(**arguments)
        assert says in str(caught.value) and "\n" not in str(caught.value)
        after = many.time_step()
        for world in range(3):
            check_same(after, [before.world(w) for w in range(3)], world)
        then = twin.reset()
        check_same(many.reset(), [then.world(w) for w in range(3)], "the next reset")


def test_actions_that_make_no_sense_name_the_world() -> None:
    with load_batch(count=2, threads=1) as many:
        many.reset()
        with pytest.raises(ValueError, match=r"world 1: action .* two finite numbers"):
            many.step([[0, 0], [np.nan, 0]])
        with pytest.raises(ValueError, match=r"actions of shape \(2,\): must be \(2, 2\)"):
            many.step([0, 0])
        many.start_moves([[1, 0], [1, 0]])
        many.advance()
        with pytest.raises(ValueError, match="world 0: its move is under way"):
            many.start_moves([[1, 0], [1, 0]])
        with pytest.raises(ValueError, match="world 0: its move is under way"):
            many.step([[1, 0], [1, 0]], mask=[False, True])


def test_the_tasks_of_worlds_tell_what_they_sense_now() -> None:
    with load_batch("motor", 2, task_kwargs={"random": 1}, threads=1) as many:
        told = many.reset().observation
        for _ in range(20):
            told = many.step(np.full((2, 3), 0.2)).observation
        for world, task in enumerate(many.tasks):
            assert task.odometry == tuple(told["odometry"][world])
            np.testing.assert_array_equal(task.encoders, told["encoders"][world])
            np.testing.assert_array_equal(task.bumpers, told["bumpers"][world])
