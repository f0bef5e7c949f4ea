"""What cannot be loaded, and simulations that diverge."""

from typing import Any

import numpy as np
import pytest
from dm_control.rl.control import PhysicsError
from identity import check_same, singles

from nomad_mj import NomadError, load, load_batch
from nomad_mj.errors import ConfigError


@pytest.mark.parametrize("rooms", [["paper_room"], ["paper_room", "hall"]])
def test_a_world_that_diverges_is_named_and_all_begin_anew(rooms: list[str]) -> None:
    options: dict[str, Any] = {"random": 3}
    with load_batch("motor", 4, rooms, task_kwargs=options, threads=2) as many:
        many.reset()
        commands = np.zeros(many.action_spec().shape)
        many.step(commands)
        wrong = commands.copy()
        wrong[2, 0] = np.nan
        with pytest.raises(PhysicsError, match=r"^world 2: the simulation diverged at .*BADCTRL"):
            many.step(wrong)
        assert many.time_step().last().all()
        assert many.step(commands).first().all()
        told = many.reset(seed=0)
        ones = singles("motor", [rooms[w % len(rooms)] for w in range(4)], "nomad200", {})
        check_same(told, [one.reset() for one in ones], "reset")
        told = many.step(commands)
        check_same(told, [one.step(commands[0]) for one in ones], "step")
        for one in ones:
            one.close()


def test_when_worlds_of_several_lots_diverge_all_are_named_and_none_goes_on() -> None:
    rooms = ["paper_room"] + ["hall"] * 15
    with load_batch("motor", 16, rooms, task_kwargs={"random": 3}, threads=2) as many:
        many.reset(seed=0)
        commands = np.zeros(many.action_spec().shape)
        wrong = commands.copy()
        wrong[[0, 3], 0] = np.nan
        with pytest.raises(PhysicsError, match=r"^world 0: .*BADCTRL; world 3: .*BADCTRL$"):
            many.step(wrong)
        told = many.reset(seed=0)
        ones = singles("motor", rooms, "nomad200", {})
        check_same(told, [one.reset() for one in ones], "reset")
        for _ in range(3):
            told = many.step(commands)
            check_same(told, [one.step(commands[0]) for one in ones], "step")
        for one in ones:
            one.close()


@pytest.mark.parametrize(
    ("options", "says"),
    [
        ({"count": 0}, "count 0: must be 1, 2, 3, ..."),
        ({"count": 2, "threads": 1.5}, "threads 1.5: must be 1, 2, 3, ..."),
        ({"room": []}, "room: the list of rooms is empty"),
        ({"count": 2, "room": ["hall", "nowhere"]}, "unknown room 'nowhere'; there are"),
        ({"count": 3, "goal": [None, (5, 5)]}, "goal: there are 2, but 3 worlds"),
        ({"count": 1, "task_kwargs": {"nosie": 1}}, "unknown task option 'nosie'; there are"),
        ({"count": 1, "environment_kwargs": {"time_limit": -1}}, "time limit -1: must be above 0"),
        ({"task_name": "flying"}, "unknown task 'flying'; there are: motor, path_finding"),
        ({"count": 1, "task_kwargs": {"random": "x"}}, "seed 'x': must be a whole number"),
    ],
)
def test_what_cannot_be_loaded_is_told_in_one_line(options: dict[str, Any], says: str) -> None:
    with pytest.raises(NomadError) as caught:
        load_batch(**options)
    assert says in str(caught.value) and "\n" not in str(caught.value)


def test_after_close_every_call_says_so() -> None:
    many = load_batch("motor", 2)
    many.reset()
    many.close()
    for call in (many.reset, many.time_step, lambda: many.step(np.zeros((2, 3)))):
        with pytest.raises(RuntimeError, match="has been closed"):
            call()


def test_a_seed_for_each_world_can_be_loaded() -> None:
    with load_batch("motor", 2, task_kwargs={"random": [5, 6]}) as many:
        seen = many.reset().observation["sonar"]
    for seed, row in zip((5, 6), seen, strict=True):
        with load("motor", task_kwargs={"random": seed}) as single:
            np.testing.assert_array_equal(row, single.reset().observation["sonar"])
    with pytest.raises(ConfigError, match="one for each of 3 worlds"):
        load_batch("motor", 3, task_kwargs={"random": [5, 6]})
