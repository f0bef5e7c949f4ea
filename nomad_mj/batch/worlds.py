"""N robots, each in its own room: sensed, reset and advanced together."""

import math
from collections import OrderedDict
from collections.abc import Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from nomad_mj.batch.lot import Moved
from nomad_mj.batch.simulations import Simulations
from nomad_mj.batch.world import World
from nomad_mj.errors import ConfigError, NomadError, StartError
from nomad_mj.scene import Scene
from nomad_mj.tasks import MotorConfig, MotorTask, NavigationPhysics, Start, resolve_start
from nomad_mj.tasks.ranging import RangingOfMany
from nomad_mj.tasks.seeds import seed_sequence
from nomad_mj.types import FloatArray, IntArray

Seed = int | np.random.SeedSequence | None
Mask = npt.NDArray[np.bool_] | Sequence[bool] | None


class Worlds:
    """What the motor task and path finding have in common for many robots.

    Each world has a `MotorTask` of its own: its streams of chance, its odometry, what moves in its
    room. An episode begins in a simulation of the single environment, one a scene, and is handed
    over to the engine's batch. From then on readings are taken from all worlds at once.

    Parameters
    ----------
    scenes : list of Scene, length N
        One a world, of the same robot.
    config : MotorConfig
        Options of the motor task.
    random : int, SeedSequence, sequence of these or None
        See `world_seed`; or one for each world.
    threads : int
        To run on.

    Attributes
    ----------
    count : int
        Number of worlds N.
    tasks : list of MotorTask
        One a world.
    worlds : list of World
        Each as its task sees it.
    ranges : array (N, C)
        The range readings of the present control step [m].
    bumpers, encoders, odometry, goal : array (N, B), (N, E), (N, 4), (N, 2)
        The other observations, as of `MotorTask`.
    """

    def __init__(
        self,
        scenes: list[Scene],
        config: MotorConfig,
        random: "Seed | Sequence[Seed]",
        threads: int,
    ) -> None:
        first = scenes[0]
        self.count = len(scenes)
        self.tasks = [
            MotorTask(scene, config, seed)
            for scene, seed in zip(scenes, self.seeds(random), strict=True)
        ]
        self._nurseries = {id(scene): _nursery(scene, config) for scene in scenes}
        self._simulations = Simulations(scenes, config, threads)
        self._moved: Moved = {}
        self._ranging = RangingOfMany([task.ranging for task in self.tasks])
        self._goals = [(0.0, 0.0)] * self.count  # where each goal is now [m]
        self._has_movers = any(task.movers is not None for task in self.tasks)
        robot = first.robot
        self._bumpers_err = config.bumper_noise.active

        def rows(size: int) -> FloatArray:
            return np.zeros((self.count, size))

        self.ranges, self.bumpers = rows(robot.layout.count), rows(len(robot.bumpers))
        self.encoders, self.odometry = rows(len(robot.drive.encoders)), rows(4)
        self.goal = rows(2)
        self.touched = rows(len(robot.bumpers))
        self.worlds = [
            World(number, self._simulations, self._moved, self.touched[number])
            for number in range(self.count)
        ]
        self._poses = [world.pose for world in self.worlds]

    def seed(self, seeds: "Sequence[np.random.SeedSequence | None]", worlds: IntArray) -> None:
        """Start the sequences of episodes of worlds (n,) anew, where a seed (N) is not None."""
        for world in worlds.tolist():
            seed = seeds[world]
            if seed is not None:
                self.tasks[world].seed(seed)

    def start_at(self, starts: "Sequence[Start]", worlds: IntArray) -> None:
        """Let the next episodes of worlds (n,) start where `starts` (N) say, all checked first.

        Raises
        ------
        StartError
            Naming the world.
        """
        if len(starts) != self.count:
            raise ConfigError(
                f"starts: there are {len(starts)}, but {self.count} worlds; give one for each, or "
                "None for any"
            )
        chosen = [world for world in worlds.tolist() if starts[world] is not None]
        for world in chosen:
            self._check_start(world, starts[world])
        for world in chosen:
            self.tasks[world].start_next_at(starts[world])

    def _check_start(self, world: int, start: Start) -> None:
        try:
            resolve_start(self.tasks[world].scene, start, np.random.default_rng(0))
        except NomadError as error:
            raise StartError(f"world {world}: {error}") from None

    def reset(self, worlds: IntArray) -> None:
        """Begin an episode in each of some worlds (n,).

        Raises
        ------
        StartError
            Where what moves finds no place, naming the world. All of these must be reset then.
        """
        for world in worlds.tolist():
            task = self.tasks[world]
            nursery = self._nurseries[id(task.scene)]
            try:
                with nursery.reset_context():
                    task.initialize_episode(nursery)
            except StartError as error:
                raise StartError(f"world {world}: {error}") from None
            told = task.get_observation(nursery)
            self._simulations.take(world, nursery)
            self.touched[world] = nursery.bumpers()
            self.ranges[world] = task.ranges
            self.bumpers[world] = told["bumpers"]
            self.encoders[world] = told["encoders"]
            # The rows themselves: the task's go on with them.
            task.ranges, task.bumpers = self.ranges[world], self.bumpers[world]
            task.encoders = self.encoders[world]
            self.odometry[world] = told["odometry"]
            self.goal[world] = told["goal"]
            self._ranging.go_on(world)
            self._goals[world] = task.goal_xy

    def step(self, worlds: IntArray, commands: FloatArray) -> None:
        """Advance worlds (n,), ascending, by a control step, and sense.

        Parameters
        ----------
        worlds : array (n,)
            Numbers of the worlds.
        commands : array (n, M)
            Their motors' commands.

        Raises
        ------
        PhysicsError
            Naming the worlds that diverged; all of these must be reset then.
        """
        if not len(worlds):
            return
        chosen: list[int] = worlds.tolist()
        self._moved.clear()
        if self._has_movers:
            for world in chosen:
                self.tasks[world].move_movers(self.worlds[world])
                self._goals[world] = self.tasks[world].goal_xy
        self._simulations.step(worlds, commands, self._moved)
        self._sense(worlds, chosen)

    def _sense(self, worlds: IntArray, chosen: list[int]) -> None:
        """Read the sensors of worlds (n,), `chosen` the same as a list."""
        cones, bumpers, encoders = self._simulations.read(worlds)
        tasks, poses = self.tasks, self._poses
        self.ranges[worlds] = self._ranging.read(worlds, cones)
        self.encoders[worlds] = encoders
        pairs = zip(chosen, encoders.tolist(), strict=True)
        for world, own in pairs:
            tasks[world].odometry = tasks[world].own.reckon(own, poses[world])
        odometry = np.array([tasks[world].odometry for world in chosen])
        self.odometry[worlds] = odometry
        self.touched[worlds] = bumpers
        if self._bumpers_err:
            told = zip(chosen, bumpers, strict=True)
            bumpers = np.array([tasks[world].own.tell_bumpers(own) for world, own in told])
        self.bumpers[worlds] = bumpers
        goals = np.array([self._goals[world] for world in chosen])
        self.goal[worlds] = goals - odometry[:, :2]

    def goal_distances(self, worlds: IntArray) -> list[float]:
        """Return the true distances of the robots of worlds (n,) to their goals [m]."""
        goals = [self._goals[world] for world in worlds.tolist()]
        places = self._simulations.places(worlds).tolist()
        return [
            math.hypot(goal_x - x, goal_y - y)
            for (goal_x, goal_y), (x, y) in zip(goals, places, strict=True)
        ]

    def observe(self) -> "OrderedDict[str, FloatArray]":
        """Return the observations of all worlds, copied, each with N rows."""
        result: OrderedDict[str, FloatArray] = OrderedDict()
        for name, first, last in self.tasks[0].slices:
            result[name] = self.ranges[:, first:last].copy()
        result["bumpers"] = self.bumpers.copy()
        result["encoders"] = self.encoders.copy()
        result["odometry"] = self.odometry.copy()
        result["goal"] = self.goal.copy()
        return result

    def chosen(self, mask: Mask) -> IntArray:
        """Return the numbers of the worlds that a mask (N,) of truth values chooses, None: all."""
        if mask is None:
            return np.arange(self.count)
        given = np.asarray(mask)
        if given.dtype != np.bool_ or given.shape != (self.count,):
            raise ConfigError(f"mask: must be {self.count} times True or False, one for each world")
        return np.flatnonzero(given)

    def seeds(self, seed: Any) -> "Sequence[np.random.SeedSequence | None]":
        """Return a seed for each world, given one for all or one each; raise ConfigError."""
        if isinstance(seed, np.integer):
            seed = int(seed)
        if seed is None or isinstance(seed, int | np.random.SeedSequence):
            given: list[Any] = [world_seed(seed, world) for world in range(self.count)]
        elif isinstance(seed, Sequence | np.ndarray) and not isinstance(seed, str):
            given = list(seed)
        else:
            given = []
        if len(given) != self.count:
            raise ConfigError(
                f"seed {seed!r}: must be a whole number, or one for each of {self.count} worlds"
            )
        return [None if each is None else seed_sequence(each) for each in given]

    def close(self) -> None:
        """Free all simulations."""
        self._simulations.close()
        for nursery in self._nurseries.values():
            nursery.free()
        self._nurseries.clear()


def world_seed(seed: Seed, world: int) -> Seed:
    """Return the seed with which a single environment is the world of a number.

    A whole number s becomes s + `world`, as in Gymnasium's vector environments; a SeedSequence
    becomes its child of that number, without being used up; None stays None: another each time.
    """
    if isinstance(seed, np.random.SeedSequence):
        return np.random.SeedSequence(seed.entropy, spawn_key=(*seed.spawn_key, world))
    is_whole = isinstance(seed, int | np.integer)
    return seed + world if is_whole else seed  # what it cannot be, the task refuses


def _nursery(scene: Scene, config: MotorConfig) -> NavigationPhysics:
    """Return a simulation in which episodes of a scene begin."""
    return NavigationPhysics.from_scene(scene, config.range_noise.grazing, config.infrared)
