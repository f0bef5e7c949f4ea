"""The motor task: drive the motors at 20 Hz on sensor readings."""

import math
from collections import OrderedDict
from typing import Any

import numpy as np
from dm_control.rl import control
from dm_env import specs

from nomad_mj.errors import ConfigError
from nomad_mj.movers import Movers, find_room_for
from nomad_mj.scene import CONTROL_TIMESTEP, Scene
from nomad_mj.tasks.config import MotorConfig
from nomad_mj.tasks.physics import NavigationPhysics, Placeable, Posed
from nomad_mj.tasks.ranging import Ranging
from nomad_mj.tasks.seeds import seed_sequence
from nomad_mj.tasks.self_sensing import SelfSensing
from nomad_mj.tasks.starts import Start, resolve_start, start_movers
from nomad_mj.types import FloatArray, Travel

REWARD_MARGIN = 5.0  # [m] from the goal at which the reward has fallen to 0.1


class MotorTask(control.Task):
    """Reach the goal with motor velocities as actions.

    Observations, all float64: one array of ranges [m] for each ring, under the ring's name;
    ``bumpers`` (0 or 1); ``encoders`` (way of each motor in this control step [m] or its angle
    [rad], in the order of the drive's `encoders`); ``odometry`` (x, y [m], heading of the robot,
    or of its wheels where these are steered, and of its range sensors [rad]); ``goal``, the vector
    from the odometry's position to the goal [m]. The reward is 1 at the goal and falls
    smoothly with the true distance to it.

    Parameters
    ----------
    scene : Scene
        Robot and room.
    config : MotorConfig
        Options.
    random : int, SeedSequence or None
        Seed; the n-th episode after it is the same whatever was done in the ones before.

    Attributes
    ----------
    start_pose : Pose
        Where the present episode started.
    ranges : array (layout.count,)
        The range readings of this control step, all rings concatenated [m].
    bumpers : array (B,)
        What the bumpers report of it, 0 or 1.
    encoders : array (E,)
        What the encoders read of it, as observed.
    odometry : (float, float, float, float)
        What the odometry tells after it, as observed.
    goal_xy : (float, float)
        Where the goal is now [m].
    ranging : Ranging
        Its range sensors.
    own : SelfSensing
        What it senses of itself.
    movers : Movers or None
        Where the goal and the obstacles that move are now; None if nothing moves.
    random : numpy.random.Generator
        For dm_control's wrappers, which look for it here; the task draws nothing from it.
    """

    def __init__(
        self,
        scene: Scene,
        config: MotorConfig | None = None,
        random: int | np.random.SeedSequence | None = None,
    ) -> None:
        self.scene = scene
        self.config = config or MotorConfig()
        if self.config.range_noise.grazing is not None and not len(scene.robot.rays.specular):
            raise ConfigError(
                "range noise grazing: needs a scene that was built with its specular_rings"
            )
        self.ranging = Ranging(self.config.range_noise, self.config.sonar, scene.robot)
        self._start: Start = None
        self.seed(random)
        self.slices: list[tuple[str, int, int]] = []
        first = 0
        for ring in scene.robot.layout.rings:
            self.slices.append((ring.name, first, first + len(ring.bearings)))
            first += len(ring.bearings)
        self._limits: FloatArray = scene.model.actuator_ctrlrange[scene.robot.controls]
        self._goal: FloatArray = scene.arena.goal
        self.goal_xy: tuple[float, float] = tuple(self._goal.tolist())
        radius = scene.robot.layout.radius
        moving = scene.moving
        self.movers = Movers(moving, scene.plan, self._goal, radius) if moving else None
        self._begin(None)
        if self.movers is not None:
            find_room_for(self.movers, scene.arena.starts)

    def seed(self, random: int | np.random.SeedSequence | None) -> None:
        """Start the sequence of episodes anew from a seed."""
        self._seed = seed_sequence(random)
        self._episode = 0

    def start_next_at(self, start: Start) -> None:
        """Let the next episode start there (see `starts.resolve_start`), checked now."""
        resolve_start(self.scene, start, np.random.default_rng(0))
        self._start = start

    def _begin(self, physics: NavigationPhysics | None) -> None:
        """Set up the streams and sensors of an episode; place the robot if there is a physics."""
        key = (*self._seed.spawn_key, self._episode)
        # What comes later in this list must not change the bits of what comes before.
        streams = np.random.SeedSequence(self._seed.entropy, spawn_key=key).spawn(10)
        choice, ranges, odometry, free, *moving = map(np.random.default_rng, streams[:6])
        self.random = free
        wanted, self._start = self._start, None  # of this episode, even if it fails
        start = resolve_start(self.scene, wanted, choice)
        if physics is not None:
            self._episode += 1  # also if it is refused: the next one is another
            if self.movers is not None:
                again = choice if wanted is None else None
                start = start_movers(self.movers, self.scene, start, again, *moving)
                self._show(self.movers, physics)
            physics.place(start)
        self.ranging.start(ranges, *streams[6:8])
        robot = self.scene.robot
        self.own = SelfSensing(robot, self.config, start, odometry, *streams[8:])
        self._sensed = False
        self.ranges: FloatArray = np.zeros(robot.layout.count)
        self.bumpers: FloatArray = np.zeros(len(robot.bumpers))
        self.encoders: FloatArray = np.zeros(len(robot.drive.encoders))
        self.odometry = (*start, 0.0)
        self.start_pose = start

    def initialize_episode(self, physics: NavigationPhysics) -> None:
        """Place the robot and reseed the sensors."""
        self._begin(physics)

    def before_step(self, action: Any, physics: NavigationPhysics) -> None:
        """Command the motors in the order of the drive's: see `Drive.motors`."""
        physics.command(action)
        self._sensed = False
        if self.movers is not None:
            self.move_movers(physics)

    def move_movers(self, physics: Placeable) -> None:
        """Let what moves beside the robot go on for a control step."""
        if self.movers is not None:
            self.movers.advance(CONTROL_TIMESTEP, physics.pose()[:2])
            self._show(self.movers, physics)

    def _show(self, movers: Movers, physics: Placeable | None) -> None:
        """Let the goal be where it has moved, and the bodies of all that moves."""
        self._goal = movers.goal
        self.goal_xy = tuple(self._goal.tolist())
        if physics is not None:
            physics.move_bodies(movers.rows, movers.body_places())

    def action_spec(self, physics: NavigationPhysics) -> specs.BoundedArray:
        """Return the motors' limits, (M,)."""
        return self.motor_spec()

    def observation_spec(self, physics: NavigationPhysics) -> "OrderedDict[str, specs.Array]":
        """Return the shapes and limits of the observations."""
        return self.sensor_spec()

    def motor_spec(self) -> specs.BoundedArray:
        """Return the motors' limits, (M,)."""
        low, high = self._limits.T
        motors = self.scene.robot.drive.motors
        return specs.BoundedArray((len(motors),), np.float64, low, high, name="\t".join(motors))

    def sensor_spec(self) -> "OrderedDict[str, specs.Array]":
        """Return the shapes and limits of the observations."""
        robot = self.scene.robot
        result: OrderedDict[str, specs.Array] = OrderedDict()
        for ring in robot.layout.rings:
            result[ring.name] = specs.BoundedArray(
                (len(ring.bearings),), np.float64, ring.min_range, ring.max_range, name=ring.name
            )
        result["bumpers"] = specs.BoundedArray(
            (len(robot.bumpers),), np.float64, 0.0, 1.0, name="bumpers"
        )
        encoders = len(robot.drive.encoders)
        for name, size in (("encoders", encoders), ("odometry", 4), ("goal", 2)):
            result[name] = specs.Array((size,), np.float64, name=name)
        return result

    def sense(self, physics: NavigationPhysics) -> None:
        """Read the sensors, unless they were read in this control step: errors are drawn once."""
        if self._sensed:
            return
        self.ranges = self.ranging.read(physics.cone_ranges())
        self.encoders = physics.encoders()
        self.odometry = self.own.reckon(self.encoders.tolist(), physics.pose)
        self.bumpers = self.own.tell_bumpers(physics.bumpers())
        self._sensed = True

    def get_observation(self, physics: NavigationPhysics) -> "OrderedDict[str, FloatArray]":
        """Return the readings of this control step, drawn once."""
        self.sense(physics)
        odometry = np.array(self.odometry)
        result: OrderedDict[str, FloatArray] = OrderedDict()
        ranges = self.ranges.copy()  # what is handed out is not what the robot drives by
        for name, first, last in self.slices:
            result[name] = ranges[first:last]
        result["bumpers"] = self.bumpers.copy()
        result["encoders"] = self.encoders.copy()
        result["odometry"] = odometry
        result["goal"] = self._goal - odometry[:2]
        return result

    @property
    def travel(self) -> Travel:
        """What the encoders tell of this control step, without drift."""
        return self.own.travel

    @property
    def goal(self) -> FloatArray:
        """Where the goal is now, (2,) [m]: the one that is told, ends the episode and is drawn."""
        return self._goal.copy()

    def goal_distance(self, physics: Posed) -> float:
        """Return the true distance from the robot's centre to the goal [m]."""
        pose, goal = physics.pose(), self.goal_xy
        return math.hypot(goal[0] - pose.x, goal[1] - pose.y)

    def reward_at(self, distance: float) -> float:
        """Return the reward at a true distance from the goal [m], in [0, 1]."""
        beyond = max(distance - self.config.goal_radius, 0.0)
        # dm_control's tolerance() with its defaults, which takes a tenth of the control step.
        return 0.1 ** (beyond / REWARD_MARGIN) ** 2

    def ends_at(self, distance: float) -> bool:
        """Return whether the episode ends at a true distance from the goal [m]."""
        return self.config.ends_at_goal and distance <= self.config.goal_radius

    def reaches_goal(self, distance: float) -> bool:
        """Return whether a true distance from the goal [m] is near enough."""
        return distance <= self.config.goal_radius

    def get_reward(self, physics: NavigationPhysics) -> float:
        """Return 1 at the goal, less the farther away, in [0, 1]."""
        return self.reward_at(self.goal_distance(physics))

    def get_termination(self, physics: NavigationPhysics) -> float | None:
        """Return discount 0 at the goal, else None: the episode goes on."""
        if not self.config.ends_at_goal:  # and the distance need not be known
            return None
        return 0.0 if self.ends_at(self.goal_distance(physics)) else None
