"""Straight moves of an ideal robot, which does at once what it is told, among ideal walls."""

import math
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj.motion import MotionConfig, Outcome, StraightMove, ramp_speed
from nomad_mj.types import MotionLimits

DT = 0.05
LIMITS = MotionLimits(0.6, 0.76, 1.05, 0.87)
CONFIG = MotionConfig()

headings = st.floats(-4.0, 4.0)
lengths = st.floats(0.0, 1.5)
motors = st.builds(
    MotionLimits,
    translate=st.floats(0.1, 2.0),
    translate_acceleration=st.floats(0.2, 3.0),
    turn=st.floats(0.3, 3.0),
    turn_acceleration=st.floats(0.3, 5.0),
)


class Drive:
    """Carries out one move along a line, with walls ahead and behind at given distances."""

    def __init__(
        self,
        heading: float,
        length: float,
        wheels: float,
        ahead: float = math.inf,
        behind: float = math.inf,
        motors: MotionLimits = LIMITS,
        config: MotionConfig = CONFIG,
        bumps: frozenset[int] = frozenset(),
    ) -> None:
        self.move = StraightMove(heading, length, wheels, motors, config, DT)
        self.heading, self.wheels = heading, wheels
        self.progress, self.farthest, self.time = 0.0, 0.0, 0.0
        self.commands: list[tuple[float, float]] = [(0.0, 0.0)]
        distance, step = 0.0, 0
        while True:
            forward = math.cos(self.move.motion_heading - heading) > 0
            free = ahead - self.progress if forward else behind + self.progress
            command = self.move.command(distance, self.wheels, free, step in bumps)
            if self.move.done:
                return
            assert self.time < 100, "the move never ends"
            self.commands.append(command)
            distance = command[0] * DT
            self.wheels += command[1] * DT
            self.progress += distance * math.cos(self.wheels - heading)
            self.farthest = max(self.farthest, self.progress)
            self.time += DT
            step += 1

    @property
    def off_course(self) -> float:
        """Angle between the wheels' axis and the heading of the move [rad]."""
        return abs(math.remainder(self.wheels - self.heading, math.pi))


def assert_gentle(drive: Drive, motors: MotionLimits) -> None:
    """No command is beyond a speed, no change of command beyond an acceleration."""
    speeds, steers = zip(*drive.commands, strict=True)
    for values, top, acceleration in (
        (speeds, motors.translate, motors.translate_acceleration),
        (steers, motors.turn, motors.turn_acceleration),
    ):
        assert max(map(abs, values)) <= top + 1e-9
        changes = [abs(b - a) for a, b in pairwise(values)]
        assert max(changes, default=0) <= acceleration * DT + 1e-9


@given(headings, lengths, headings, motors)
def test_a_free_move_arrives_gently_and_never_overshoots(
    heading: float, length: float, wheels: float, motors: MotionLimits
) -> None:
    config = replace(CONFIG, time_out=60.0)
    drive = Drive(heading, length, wheels, motors=motors, config=config)
    assert drive.move.outcome is Outcome.MOVED
    assert_gentle(drive, motors)
    assert drive.off_course < math.radians(1)
    assert length - 0.006 <= drive.progress
    assert drive.farthest <= length + 0.006


@given(headings, lengths, headings, st.floats(0.0, 2.0), st.floats(0.0, 2.0))
def test_no_move_reaches_a_wall_ahead_or_behind(
    heading: float, length: float, wheels: float, ahead: float, behind: float
) -> None:
    drive = Drive(heading, length, wheels, ahead, behind)
    assert_gentle(drive, LIMITS)
    assert drive.farthest < max(ahead, 1e-9)
    assert drive.progress > min(-behind, -1e-9)
    blocked = ahead < length + CONFIG.security_distance - 0.01
    clear = ahead > length + CONFIG.security_distance + 0.01
    if blocked:
        assert drive.move.outcome is Outcome.VIRTUAL_COLLISION
    if clear:
        assert drive.move.outcome is Outcome.MOVED


@given(headings, st.floats(0.1, 1.0), headings, st.floats(0.0, 0.9))
def test_after_a_virtual_collision_it_backs_off_the_length_of_a_retreat(
    heading: float, length: float, wheels: float, share: float
) -> None:
    drive = Drive(heading, length, wheels, ahead=share * length)
    assert drive.move.outcome is Outcome.VIRTUAL_COLLISION
    assert drive.farthest - drive.progress == pytest.approx(CONFIG.retract, abs=0.03)
    assert math.cos(drive.move.motion_heading - heading) == pytest.approx(-1)


@given(headings, st.floats(0.05, 1.5), headings, motors, st.floats(0.1, 6.0))
def test_a_move_out_of_time_comes_to_rest_gently(
    heading: float, length: float, wheels: float, motors: MotionLimits, time_out: float
) -> None:
    config = replace(CONFIG, time_out=time_out)
    drive = Drive(heading, length, wheels, motors=motors, config=config)
    assert drive.move.outcome in (Outcome.MOVED, Outcome.TIMED_OUT)
    assert_gentle(drive, motors)
    assert drive.time < config.longest
    stopping = motors.translate / motors.translate_acceleration
    turning = motors.turn / motors.turn_acceleration
    assert drive.time <= time_out + max(stopping, turning) + 3 * DT
    assert max(map(abs, drive.commands[-1])) < 0.02


def test_a_robot_that_never_stands_still_is_given_up() -> None:
    move = StraightMove(0.0, 0.5, 0.0, LIMITS, CONFIG, DT)
    steps = 0
    while not move.done:
        move.command(0.01 * (-1) ** steps, 0.0, math.inf, False)
        steps += 1
        assert steps * DT <= CONFIG.longest + DT
    assert move.outcome is Outcome.TIMED_OUT


@given(headings, lengths, headings, st.integers(-3, 3), st.integers(-3, 3))
def test_full_turns_of_heading_or_wheels_change_nothing(
    heading: float, length: float, wheels: float, turns: int, wheel_turns: int
) -> None:
    one = Drive(heading, length, wheels)
    turned = Drive(heading + turns * math.tau, length, wheels + wheel_turns * math.tau)
    for (speed, steer), (other, other_steer) in zip(one.commands, turned.commands, strict=False):
        assert abs(speed) == pytest.approx(abs(other), abs=1e-6)
        assert abs(steer) == pytest.approx(abs(other_steer), abs=1e-6)
    assert abs(len(one.commands) - len(turned.commands)) <= 1
    assert turned.progress == pytest.approx(one.progress, abs=0.01)


@given(headings, headings)
def test_it_never_steers_by_more_than_a_right_angle(heading: float, wheels: float) -> None:
    drive = Drive(heading, 0.3, wheels)
    assert abs(drive.wheels - wheels) <= math.pi / 2 + math.radians(1)


def test_a_contact_ends_the_move_and_starts_a_retreat() -> None:
    # That the bumper bounces does not matter.
    drive = Drive(0.0, 1.0, 0.0, bumps=frozenset({20, 22}))
    assert drive.move.outcome is Outcome.BUMPED
    contact = sum(speed * DT for speed, _ in drive.commands[:21])
    assert contact - drive.progress == pytest.approx(CONFIG.retract, abs=0.01)
    assert_gentle(drive, LIMITS)


def test_a_contact_behind_ends_the_retreat() -> None:
    whole = Drive(0.0, 1.0, 0.0, bumps=frozenset({20}))
    way = np.cumsum([speed * DT for speed, _ in whole.commands])
    again = int(np.argmax((way < way[20] - 0.12) & (np.arange(len(way)) > 20)))
    drive = Drive(0.0, 1.0, 0.0, bumps=frozenset({20, again}))
    assert drive.move.outcome is Outcome.BUMPED
    assert 0.1 < way[20] - drive.progress < CONFIG.retract - 0.02


@settings(max_examples=200)
@given(st.floats(-1, 5), st.floats(0.1, 2), st.floats(0.1, 3), st.floats(0.001, 0.1))
def test_one_can_stop_within_the_distance_from_the_speed_of_a_ramp(
    distance: float, limit: float, acceleration: float, timestep: float
) -> None:
    speed = ramp_speed(distance, limit, acceleration, timestep)
    assert 0 <= speed <= limit
    assert speed**2 / (2 * acceleration) <= max(distance, 0) + 1e-9
    assert speed * timestep <= max(distance, 0) + 1e-9
    assert ramp_speed(distance + 0.1, limit, acceleration, timestep) >= speed
