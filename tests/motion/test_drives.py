"""Drives of every kind: the encoders tell what was commanded, and a move ends at its target."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from nomad_mj.motion import CarDrive, Drive, MotionConfig, Outcome, SynchroDrive, WheeledDrive
from nomad_mj.types import MotionLimits, Travel

DT = 0.05
LIMITS = MotionLimits(0.6, 0.76, 1.5, 2.0)
HALF_TRACK, RADIUS = 0.16, 0.1


def omni_rows(wheels: int, arm: float = 0.15) -> tuple[tuple[float, float, float], ...]:
    around = [2 * math.pi * k / wheels for k in range(wheels)]
    return tuple((-math.sin(a), math.cos(a), arm) for a in around)


DIFFERENTIAL = WheeledDrive(
    LIMITS,
    ("left", "right"),
    ((1.0, 0.0, -HALF_TRACK), (1.0, 0.0, HALF_TRACK)),
    (1 / RADIUS, 1 / RADIUS),
    (1.0, 1.0),
    sees_behind=True,
)
BEHIND = WheeledDrive(  # its axle is ahead of its origin
    LIMITS, ("l", "r"), DIFFERENTIAL.rows, (1.0, 1.0), (1.0, 1.0), axle=-0.05, sees_behind=True
)
OMNI = WheeledDrive(LIMITS, ("a", "b", "c"), omni_rows(3), (1.0,) * 3, (2.0,) * 3)
CAR = CarDrive(LIMITS, ("drive",), (1.0,), ("steer",), 0.3, 0.15, 0.45, sees_behind=True)
DRIVES: dict[str, Drive] = {
    "synchro": SynchroDrive(LIMITS),
    "synchro without turret": SynchroDrive(LIMITS, turret=False),
    "differential": DIFFERENTIAL,
    "differential, axle ahead": BEHIND,
    "omni": OMNI,
    "car": CAR,
}
drives = pytest.mark.parametrize("drive", DRIVES.values(), ids=DRIVES.keys())


class Ideal:
    """A robot that does at once what its motors are told; encoders without error."""

    def __init__(self, drive: Drive, heading: float) -> None:
        self.drive = drive
        self.x = self.y = self.time = 0.0
        self.travel = Travel(0.0, 0.0, heading, 0.0 if drive.kind == "synchro" else heading)
        self.angles = [heading, 0.0]

    def encoders(self, command: tuple[float, ...]) -> list[float]:
        """Return what the encoders read after a control step."""
        if isinstance(self.drive, SynchroDrive):
            self.angles = [a + DT * v for a, v in zip(self.angles, command[1:], strict=False)]
            return [command[0] * DT, *self.angles[: len(command) - 1]]
        if isinstance(self.drive, WheeledDrive):
            return [DT * v / g for v, g in zip(command, self.drive.gains, strict=True)]
        return [command[0] * DT, command[1]]

    def step(self, command: tuple[float, ...]) -> None:
        before = self.travel.heading
        self.travel = self.drive.travel(self.encoders(command), before)
        middle = (before + self.travel.heading) / 2
        forward, sideways = self.travel[:2]
        self.x += forward * math.cos(middle) - sideways * math.sin(middle)
        self.y += forward * math.sin(middle) + sideways * math.cos(middle)
        self.time += DT

    def carry_out(self, heading: float, length: float, free: float = math.inf) -> Outcome:
        still = self.travel._replace(forward=0.0, sideways=0.0)
        move = self.drive.move(heading, length, still, MotionConfig(), DT)
        travel = still
        while True:
            command = move.command(travel, free, False)
            if move.done:
                return move.outcome
            assert len(command) == len(self.drive.motors)
            assert np.isfinite(command).all() and self.time < 60
            self.step(command)
            travel = self.travel


angles = st.floats(-math.pi, math.pi)


@drives
@settings(max_examples=40)
@given(facing=angles, heading=angles, length=st.floats(0.05, 1.5))
def test_a_move_ends_at_its_target(
    drive: Drive, facing: float, heading: float, length: float
) -> None:
    robot = Ideal(drive, facing)
    assert robot.carry_out(heading, length) is Outcome.MOVED
    target = length * math.cos(heading), length * math.sin(heading)
    off = math.hypot(robot.x - target[0], robot.y - target[1])
    swing = 0.08 if drive is BEHIND else 0.0  # about the axle, as it turns
    assert off < (0.06 if drive.kind == "car" else 0.01 + swing)


@drives
def test_nothing_is_driven_into_what_is_near(drive: Drive) -> None:
    robot = Ideal(drive, 0.3)
    outcome = robot.carry_out(2.0, 1.0, free=0.02)
    assert outcome in (Outcome.VIRTUAL_COLLISION, Outcome.TIMED_OUT)
    assert math.hypot(robot.x, robot.y) < (0.08 if drive is BEHIND else 0.05)


@drives
@given(forward=st.floats(-0.4, 0.4), sideways=st.floats(-0.3, 0.3), turn=st.floats(-0.8, 0.8))
def test_the_encoders_tell_the_twist_that_was_commanded(
    drive: Drive, forward: float, sideways: float, turn: float
) -> None:
    robot = Ideal(drive, 0.0)
    robot.step(drive.twist(forward, sideways, turn, robot.travel))
    travel = robot.travel
    assert travel.forward == pytest.approx(forward * DT, abs=1e-12)
    if drive.kind == "omni":
        assert travel.sideways == pytest.approx(sideways * DT, abs=1e-12)
    if drive.kind == "car":  # it turns as it drives, no tighter than its lock allows
        tightest = abs(forward) * math.tan(CAR.lock) / CAR.wheelbase
        assert abs(travel.heading) <= min(abs(turn), tightest) * DT + 1e-12
    else:
        assert travel.heading == pytest.approx(turn * DT, abs=1e-12)


@given(wheels=st.integers(3, 6), direction=angles)
def test_wheels_that_cannot_go_as_fast_keep_the_direction(wheels: int, direction: float) -> None:
    drive = WheeledDrive(
        LIMITS, tuple("abcdef"[:wheels]), omni_rows(wheels), (1.0,) * wheels, (0.1,) * wheels
    )
    robot = Ideal(drive, 0.0)
    robot.step(drive.twist(5 * math.cos(direction), 5 * math.sin(direction), 0.0, robot.travel))
    assert (
        max(map(abs, robot.encoders(drive.twist(5.0, 0.0, 0.0, robot.travel)))) <= 0.1 * DT + 1e-12
    )
    way = math.atan2(robot.travel.sideways, robot.travel.forward)
    assert math.remainder(way - direction, 2 * math.pi) == pytest.approx(0, abs=1e-9)


def test_an_omnidirectional_robot_keeps_its_heading() -> None:
    robot = Ideal(OMNI, 0.7)
    robot.carry_out(-2.0, 1.0)
    assert robot.travel.heading == pytest.approx(0.7, abs=1e-9)


def test_the_kind_of_wheels_is_told_by_what_they_can_do() -> None:
    assert (DIFFERENTIAL.kind, OMNI.kind) == ("differential", "omni")


@given(turn=st.floats(-0.1, 0.1))
def test_a_robot_on_two_wheels_turns_about_their_axle(turn: float) -> None:
    ways = [-HALF_TRACK * turn, HALF_TRACK * turn]
    travel = BEHIND.travel(ways, 0.0)
    assert (travel.forward, travel.heading) == pytest.approx((0.0, turn), abs=1e-12)
    assert travel.sideways == pytest.approx(-0.05 * turn, abs=1e-12)


@given(way=st.floats(0.001, 0.05), steering=st.floats(-0.45, 0.45))
def test_a_car_turns_about_the_axle_that_is_not_steered(way: float, steering: float) -> None:
    travel = CAR.travel([way, steering], 0.0)
    assert travel.heading == pytest.approx(way * math.tan(steering) / CAR.wheelbase)
    # The middle of the driven axle, behind the origin, goes straight ahead.
    assert travel.sideways - CAR.axle * travel.heading == pytest.approx(0, abs=1e-15)


def test_a_robot_that_does_not_see_behind_turns_round_instead_of_backing() -> None:
    for sees in (True, False):
        drive = WheeledDrive(
            LIMITS, ("l", "r"), DIFFERENTIAL.rows, (1.0, 1.0), (1.0, 1.0), sees_behind=sees
        )
        robot = Ideal(drive, 0.0)
        robot.carry_out(math.pi, 1.0)
        assert robot.x == pytest.approx(-1.0, abs=0.01)
        backed = abs(math.remainder(robot.travel.heading, 2 * math.pi)) < 0.1
        assert backed is sees
