"""Driving by hand: keys, speeds, the pace, and a session of a robot in a room."""

import contextlib
import math
from collections.abc import Generator
from pathlib import Path
from typing import Any

import pytest
from dm_control.rl.control import PhysicsError
from hypothesis import given, settings
from hypothesis import strategies as st
from known_view import Clock
from nomad_agents.baselines import Straight
from nomad_agents.reactive_planner import FAITHFUL
from nomad_agents.viewer import Session
from nomad_agents.viewer.controls import Controls
from nomad_agents.viewer.pace import Pace
from nomad_agents.viewer.report import Reporter
from nomad_agents.viewer.teleoperation import KEYS, PATIENCE, Teleoperator, Twist, Wish, wish_of

import nomad_mj
from nomad_mj.errors import UnknownNameError
from nomad_mj.types import MotionLimits

DT = 0.05
shares = st.floats(-1, 1)
wishes = st.builds(Wish, shares, shares, shares)
positive = st.floats(0.05, 5)
limits = st.builds(MotionLimits, positive, positive, positive, positive)


@settings(max_examples=40)
@given(limits, st.lists(st.tuples(wishes, st.floats(0, 1)), max_size=30), st.booleans())
def test_no_speed_leaves_the_limits_nor_changes_faster_than_the_motors_follow(
    robot: MotionLimits, pressed: list[tuple[Wish, float]], wheel: bool
) -> None:
    operator, now = Teleoperator(robot, DT, wheel=wheel), 0.0
    before = operator.twist(now)
    for wish, wait in pressed:
        operator.hold(wish, now)
        now += wait
        twist = operator.twist(now)
        assert math.hypot(twist.forward, twist.sideways) <= robot.translate * (1 + 1e-9)
        assert abs(twist.turn) <= robot.turn * (1 + 1e-9)
        change = math.hypot(twist.forward - before.forward, twist.sideways - before.sideways)
        assert change <= robot.translate_acceleration * DT + 1e-9
        assert abs(twist.turn - before.turn) <= robot.turn_acceleration * DT + 1e-9
        before = twist


@settings(max_examples=40)
@given(limits, wishes)
def test_a_wish_that_is_held_comes_true_and_ends_when_no_key_is_heard_of(
    robot: MotionLimits, wish: Wish
) -> None:
    operator, now, twist = Teleoperator(robot, DT), 0.0, Twist()
    ramp = max(
        2 * robot.translate / robot.translate_acceleration, robot.turn / robot.turn_acceleration
    )
    steps = math.ceil(ramp / DT) + 1
    for _ in range(steps):
        operator.hold(wish, now)
        twist = operator.twist(now)
        now += DT
    reach = max(math.hypot(wish.forward, wish.sideways), 1.0)
    assert twist.forward == pytest.approx(robot.translate * wish.forward / reach, abs=1e-6)
    assert twist.turn == pytest.approx(robot.turn * wish.turn, abs=1e-6)
    now += PATIENCE
    for _ in range(steps):
        twist = operator.twist(now)
    assert max(map(abs, twist)) < 1e-9


@given(st.sets(st.sampled_from(sorted(KEYS))))
def test_keys_add_up_and_opposite_ones_cancel(held: set[str]) -> None:
    wish = wish_of(held)
    assert wish.forward == ("forward" in held) - ("back" in held)
    assert wish.turn == ("left" in held) - ("right" in held)
    assert wish.sideways == ("aside_left" in held) - ("aside_right" in held)


def test_a_key_that_there_is_not_is_refused() -> None:
    with pytest.raises(UnknownNameError, match="unknown key 'up'; there are: aside_left, "):
        wish_of(["up"])


def test_a_car_that_backs_up_turns_the_other_way() -> None:
    robot = MotionLimits(1.0, 10.0, 1.0, 10.0)
    for wheel, side in ((True, -1.0), (False, 1.0)):
        operator, twist = Teleoperator(robot, DT, wheel=wheel), Twist()
        for _ in range(20):
            operator.hold(Wish(-1.0, 0.0, 1.0), 0.0)
            twist = operator.twist(0.0)
        assert math.copysign(1.0, twist.turn) == side


@given(st.lists(st.floats(0, 0.4), max_size=40))
def test_the_pace_is_real_time_or_slower(work: list[float]) -> None:
    clock = Clock()
    begin = clock.now

    def sleep(seconds: float) -> None:
        clock.now += seconds

    pace = Pace(DT, clock, sleep)
    for seconds in work:
        clock.now += seconds
        pace.wait()
    assert clock.now - begin >= DT * len(work) - 1e-6 - 0.25
    assert pace.late <= 0.25 + 1e-9


@contextlib.contextmanager
def session_in(
    room: str | Path, robot: str = "nomad200", **options: Any
) -> Generator[tuple[Session, Clock], None, None]:
    clock = Clock()
    with nomad_mj.load("path_finding", room, robot) as env:
        session = Session(env, Controls(clock), clock=clock, **options)

        def tick() -> None:
            clock.now += DT

        session.on_step = tick
        yield session, clock


def hold(session: Session, seconds: float, *keys: str) -> None:
    for _ in range(round(seconds / DT)):
        session.controls.hold(wish_of(keys))
        session.advance()


@pytest.mark.parametrize("robot", ["nomad200", "pioneer", "omnibot", "racer"])
def test_every_kind_of_robot_is_driven_by_the_same_keys(robot: str) -> None:
    with session_in("empty_room", robot, start=(5.0, 5.0, 0.0)) as (session, _):
        physics = session.env.physics
        hold(session, 1.5, "forward")
        ahead = physics.pose()
        assert ahead.x > 5.2 and ahead.y == pytest.approx(5.0, abs=0.02)
        hold(session, 1.0, "forward", "left")
        assert physics.pose().heading > ahead.heading + 0.2
        hold(session, 2.0)
        assert abs(session.speed) < 0.02
        hold(session, 1.0, "back")
        assert session.speed < -0.1
        if session.env.scene.robot.drive.kind == "omni":
            hold(session, 1.0)
            before = physics.pose()
            hold(session, 1.0, "aside_left")
            way = physics.pose().y - before.y, physics.pose().x - before.x
            aside = way[0] * math.cos(before.heading) - way[1] * math.sin(before.heading)
            assert aside > 0.1


def test_it_stops_when_the_keyboard_falls_silent() -> None:
    with session_in("empty_room", start=(5.0, 5.0, 0.0)) as (session, _):
        hold(session, 1.5, "forward")
        assert session.speed > 0.5
        limits = session.env.scene.robot.limits
        for _ in range(
            round((PATIENCE + limits.translate / limits.translate_acceleration) / DT) + 4
        ):
            session.advance()
        assert abs(session.speed) < 0.01


def test_what_is_touched_is_reported_from_where_it_is() -> None:
    with session_in("empty_room", start=(8.8, 5.0, 0.0)) as (session, _):
        hold(session, 3.0, "forward")
        state = Reporter(session).state()
        assert state["news"] == "bumper touched"
        assert state["touched"] and max(map(abs, state["touched"])) < math.radians(40)
        session.controls.ask("reset")
        hold(session, 1.0, "back")
        state = Reporter(session).state()
        assert state["news"] == "" and state["touched"] == [] and session.episodes == 2


def test_the_keyboard_takes_over_from_an_agent_and_gives_back(small_room: Path) -> None:
    with session_in(small_room, start=(0.0, 1.7)) as (session, _):
        session.agent = Straight(session.env.scene.robot.layout, FAITHFUL)
        session.agent_drives = True
        steps: list[str] = []
        tick = session.on_step

        def press_at_the_tenth() -> None:
            tick()
            steps.append(session.driver)
            if len(steps) == 10:
                session.controls.hold(wish_of(["left"]))

        session.on_step = press_at_the_tenth
        session.advance()
        assert steps == ["straight"] * 10 and session.driver == "hand"
        hold(session, 0.5, "left")
        session.on_step = tick
        session.controls.hold(Wish())
        session.controls.ask("agent")
        for _ in range(20):
            session.advance()
            if session.driver == "hand":
                break
        assert session.news == "goal reached"


def test_an_agent_that_cannot_start_says_so() -> None:
    with session_in("empty_room", start=(9.4, 5.0, 0.0)) as (session, _):
        session.agent = Straight(session.env.scene.robot.layout, FAITHFUL)
        session.agent_drives = False
        hold(session, 2.0, "forward")
        session.controls.hold(Wish())
        session.controls.ask("agent")
        session.advance()
        assert session.news.startswith("straight cannot start here: start (")
        assert session.driver == "hand" and session.episodes == 1


def test_a_simulation_that_diverges_starts_again(monkeypatch: pytest.MonkeyPatch) -> None:
    with session_in("empty_room") as (session, _):

        def diverge(action: object) -> None:
            raise PhysicsError("the simulation diverged at 1.000 s")

        monkeypatch.setattr(session.env.motor, "step", diverge)
        session.advance()
        assert session.news == "started again: the simulation diverged at 1.000 s"
        assert session.episodes == 2
