"""``nomad-mj train``."""

from contextlib import AbstractContextManager, closing, nullcontext
from dataclasses import asdict, dataclass, fields
from pathlib import Path
from typing import Any

from rich.console import Console

from nomad_agents.checkpoint import load_checkpoint, save_checkpoint
from nomad_agents.cli.common import console, interruptible, output_file, print_json
from nomad_agents.cli.progress import TrainingProgress
from nomad_agents.cli.resuming import require_same_files, require_same_training, training_of
from nomad_agents.cli.train_deep import run_deep_training
from nomad_agents.curves import Curves, has_curves
from nomad_agents.deep import LEARNERS
from nomad_agents.deep.environment import make_env
from nomad_agents.deep.extra import require_extra
from nomad_agents.deep.training import require_budget
from nomad_agents.paths import expanded
from nomad_agents.reactive_planner import CONFIGS, ReactivePlanner
from nomad_agents.registry import find_agent, find_config
from nomad_agents.studies.digest import digests
from nomad_agents.task_options import TaskOptions
from nomad_agents.training import Training, TrainingConfig, train, training_report
from nomad_mj.envs import PathFinding
from nomad_mj.errors import ConfigError, OutputError

_OF_REACTIVE_PLANNER = ("config", "max_passes", "max_decisions", "resume")
_OF_DEEP_LEARNERS = ("observation", "decisions")


@dataclass(frozen=True)
class Train(TaskOptions):
    """Train an agent.

    The reactive planner learns until a greedy test solves every start of the room; sac, td3 and ppo
    learn from so many decisions, and cannot resume: a training of theirs starts anew.
    """

    agent: str = "reactive_planner"
    """reactive_planner, or a checkpoint of it, .npz, to go on learning with what it knows; or a
    deep learner: sac, td3 or ppo."""
    config: str = "faithful"
    """Parameters: faithful (the paper's) or tuned (fewer virtual collisions in such rooms)."""
    observation: str = "situation"
    """What a deep learner is shown: situation (26 numbers) or ranges (all range readings)."""
    decisions: int = 10_000
    """A deep learner learns from so many decisions."""
    tensorboard: str = ""
    """Folder for the curves of the training, for TensorBoard."""
    seed: int = 0
    """Of all randomness."""
    max_passes: int = 100
    """Give up after so many passes over the starts."""
    max_decisions: int = 0
    """Give up after so many decisions, at the end of an episode; 0: no limit."""
    out: str = "renders"
    """Checkpoint to write, .npz, or a folder for it (ROOM_ROBOT_AGENT_CONFIG_SEED.npz; of a deep
    learner with the observation in place of CONFIG)."""
    resume: bool = False
    """Go on from the checkpoint --out, if there is one, to the same bits."""
    overwrite: bool = False
    """Begin anew though --out is there: it is replaced."""
    json: bool = False
    """Print one line of JSON last on standard output."""

    def run(self) -> int:
        """Train; return the exit code."""
        self._refuse(_OF_REACTIVE_PLANNER if self.agent in LEARNERS else _OF_DEEP_LEARNERS)
        return self._train_deep() if self.agent in LEARNERS else self._train_reactive_planner()

    def _refuse(self, names: tuple[str, ...]) -> None:
        """Raise ConfigError if one of the options that the agent does not have is given."""
        for each in fields(self):
            if each.name in names and getattr(self, each.name) != each.default:
                option = f"--{each.name.replace('_', '-')}"
                why = ": its training can only start anew" if each.name == "resume" else ""
                raise ConfigError(f"{option} is no option of agent {self.agent!r}{why}")

    def _train_deep(self) -> int:
        screen, settings = console(json_wanted=self.json), LEARNERS[self.agent]()
        require_budget(self.decisions, 0, self.seed, settings)
        require_extra(curves=bool(self.tensorboard))
        with self.path_finding() as test, interruptible():
            name = self._name(test, self.observation)
            path = output_file(self.out, name, ".npz")
            self._require_free(path, name)
            task, goal = self._task_kwargs(), self._goal_place()
            made = make_env(settings, self.observation, self.room, self.robot, task, goal)
            with closing(made) as env:
                report = run_deep_training(
                    env,
                    test,
                    settings,
                    self.seed,
                    self.decisions,
                    path,
                    screen,
                    self.conditions(),
                    self._curves_folder(name),
                )
        told = f"solved {report['solved']} of {report['starts']} starts"
        screen.print(f"{told} after {report['decisions']} decisions: {path}", soft_wrap=True)
        if self.json:
            print_json(report)
        return 0

    def _train_reactive_planner(self) -> int:
        settings = TrainingConfig(
            self.seed, max_passes=self.max_passes, max_decisions=self.max_decisions
        )
        screen = console(json_wanted=self.json)
        with self.path_finding() as env, interruptible():
            name = self._name(env, self.config)
            path = output_file(self.out, name, ".npz")
            self._require_free(path, name)
            resume = self.resume and path.exists()
            if self.resume and not resume:
                screen.print(f"no checkpoint {path}: training begins anew", soft_wrap=True)
            agent, training = self._resume(env, path) if resume else (self._begin(env), Training())
            conditions = self.conditions() | {"files": digests(self.robot, self.room)}
            with self._curves(name, resume=resume) as curves:
                run_training(env, agent, settings, training, path, screen, conditions, curves)
            report = training_report(env, agent, training)
            screen.print(f"{_verdict(report, training)}: {path}", soft_wrap=True)
        if self.json:
            print_json(report)
        return 0

    def _name(self, env: PathFinding, variant: str) -> str:
        """Return what tells this training from others: two in a folder keep out of each other."""
        agent = self.agent if self.agent in LEARNERS else ReactivePlanner.name
        scene = env.scene
        return f"{scene.arena.name}_{scene.robot.name}_{agent}_{variant}_{self.seed}"

    def _curves(self, name: str, *, resume: bool) -> AbstractContextManager[Curves | None]:
        """Return what writes the curves of a run, None where none are wanted."""
        folder = self._curves_folder(name)
        return nullcontext() if folder is None else Curves(folder, resume=resume)

    def _curves_folder(self, name: str) -> Path | None:
        return expanded(self.tensorboard) / name if self.tensorboard else None

    def _require_free(self, path: Path, name: str) -> None:
        """Raise OutputError if what is there would be lost."""
        curves = self._curves_folder(name)
        goes_on = self.resume and path.exists()
        if curves is not None and has_curves(curves) and not (goes_on or self.overwrite):
            raise OutputError(
                f"{str(curves)!r} holds the curves of a training already: --overwrite replaces "
                "them; or choose another --tensorboard"
            )
        if self.resume and self.overwrite:
            raise ConfigError("--resume goes on, --overwrite begins anew: give one of them")
        if path.exists() and not (self.resume or self.overwrite):
            goes_on = "" if self.agent in LEARNERS else "--resume goes on from there, "
            raise OutputError(
                f"{str(path)!r} is there already: {goes_on}--overwrite replaces it; or choose "
                "another --out"
            )

    def _begin(self, env: PathFinding) -> ReactivePlanner:
        """Return the agent to train: a new one, or what a checkpoint has learnt elsewhere."""
        agent = find_agent(self.agent, env.scene.robot.layout, find_config(self.config))
        if not isinstance(agent, ReactivePlanner):
            raise ConfigError(
                f"agent {self.agent!r} does not learn; try {ReactivePlanner.name!r}, or anew "
                f"{' or '.join(LEARNERS)}"
            )
        if agent.config != find_config(self.config):
            raise ConfigError(
                f"checkpoint {self.agent!r} has other parameters than --config {self.config}; "
                f"choose the one it was trained with of: {', '.join(CONFIGS)}"
            )
        agent.plannings = 0
        return agent

    def _resume(self, env: PathFinding, path: Path) -> tuple[ReactivePlanner, Training]:
        """Return the agent of the checkpoint to go on from, and how far it is."""
        if self.agent != ReactivePlanner.name:
            raise ConfigError(f"--agent {self.agent!r}: --resume goes on with the agent in --out")
        checkpoint = load_checkpoint(path)
        require_same_training(checkpoint, path, env.scene, self.seed, find_config(self.config))
        require_same_files(checkpoint, path, digests(self.robot, self.room))
        self.require_same(checkpoint.conditions, str(path))
        return checkpoint.agent, training_of(checkpoint, path, len(env.scene.arena.starts))


def run_training(
    env: PathFinding,
    agent: ReactivePlanner,
    settings: TrainingConfig,
    training: Training,
    path: Path,
    screen: Console,
    conditions: dict[str, Any],
    curves: Curves | None = None,
) -> None:
    """Train with a progress bar; write a checkpoint after each pass and at the end.

    `conditions` are those of `TaskOptions.conditions`, for the checkpoint to tell.
    Interrupted, it writes one as of the last whole episode and raises KeyboardInterrupt: training
    can go on from there to the same bits.
    """

    def save() -> None:
        scene = env.scene
        state = {**asdict(training), "seed": settings.seed}
        names = scene.arena.name, scene.robot.name
        try:
            if curves is not None:
                curves.flush()
        finally:  # what was learnt is kept, whatever becomes of its curves
            save_checkpoint(path, agent, *names, state, conditions)

    with TrainingProgress(screen, len(env.scene.arena.starts)) as progress:

        def after_episode(now: Training) -> None:
            progress.show(now, agent)
            if curves is not None:
                curves.add(now, agent)
            if now.next_start == 0:
                save()

        save()
        if curves is not None:
            curves.begin(training)
        try:
            train(env, agent, settings, training, after_episode, curves and curves.watch)
        finally:
            save()


def _verdict(report: dict[str, Any], training: Training) -> str:
    solved = f"solved {report['solved']} of {report['starts']} starts"
    return (
        f"{solved} after {report['reactions']} reactions"
        if training.done
        else (f"stopped, having {solved}, after {training.decisions} decisions")
    )
