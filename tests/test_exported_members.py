"""The public names: what is here, users may rely on; removing one breaks them."""

import importlib
import inspect

import pytest

PUBLIC = {
    "nomad_mj": (
        "BatchMotor BatchPathFinding BatchTimeStep BumperNoise Crosstalk FiringOrder Gyroscope "
        "InfraredEffects MotorConfig MotorEnvironment MovingGoal MovingObstacles NomadError "
        "OdometryNoise Outcome PathFinding PathFindingConfig RangeNoise SonarEffects Walkers "
        "list_robots list_rooms load load_batch"
    ),
    "nomad_mj.batch": (
        "BatchEnvironment BatchMotor BatchPathFinding BatchTimeStep Worlds load_batch world_seed"
    ),
    "nomad_mj.perception": (
        "OBSERVATIONS GridSpec Observation Percept SituationSpec attraction_force cell_centres "
        "certainty_grid code_grid code_percept code_ranges code_signal coded_size perceive pool"
    ),
    "nomad_mj.motion": (
        "SAFE_CLEARANCE ActionSpec CarDrive Drive MotionConfig Move Outcome StraightMove "
        "SynchroDrive WheeledDrive displacement ramp_speed reinforcement"
    ),
    "nomad_mj.arenas": "Arena FloorPlan Geodesic Nearby check_arena goal_site near_model",
    "nomad_mj.movers": (
        "Drift Movers Moving MovingBody MovingGoal MovingObstacles Stroll Walk Walker Walkers "
        "add_obstacles find_room_for place_goal read_moving"
    ),
    "nomad_mj.rooms": (
        "Box Cylinder FREE OCCUPIED Occupancy Polygon Room UNKNOWN concave_room convex_room "
        "furnish maze_room merge_cells random_room read_floor_image read_plan read_room "
        "read_ros_map room_of_map to_mjcf wide_room"
    ),
    "nomad_mj.robots": (
        "PREFIX RayIndex RobotDescription Sheet adopt collides describe_robot find_sheet "
        "group_rays reach read_sheet report_surfaces robot_geoms set_rays_per_cone "
        "solid_radius unclip_surfaces"
    ),
    "nomad_mj.tasks": (
        "BumperNoise Crosstalk FiringOrder Gyroscope InfraredEffects MotorConfig MotorEnvironment "
        "MotorTask NavigationPhysics OdometryNoise RangeNoise SonarEffects Start resolve_start"
    ),
    "nomad_mj.envs": (
        "DEFAULT_ROBOT DEFAULT_ROOM TASKS PathFinding PathFindingConfig load percept_of"
    ),
    "nomad_mj.gym": "MotorEnv NavigationEnv NavigationVectorEnv PathFindingEnv register",
}
ERRORS = (
    "CheckpointError ConfigError ModelError NomadError OutputError RenderError StartError "
    "UnknownNameError WorkerError"
)


@pytest.mark.parametrize("name", PUBLIC)
def test_the_public_names_are_these(name: str) -> None:
    module = importlib.import_module(name)
    assert sorted(module.__all__) == sorted(PUBLIC[name].split())
    assert len(set(module.__all__)) == len(module.__all__)


@pytest.mark.parametrize("name", PUBLIC)
def test_every_public_class_and_function_says_what_it_is(name: str) -> None:
    module = importlib.import_module(name)
    assert module.__doc__
    for member in (getattr(module, public) for public in module.__all__):
        if inspect.isclass(member) or inspect.isfunction(member):
            assert member.__module__.startswith("nomad_mj.")
            assert inspect.getdoc(member)


def test_every_error_of_a_user_is_one_family() -> None:
    errors = importlib.import_module("nomad_mj.errors")
    found = {
        name: member
        for name, member in inspect.getmembers(errors, inspect.isclass)
        if member.__module__ == errors.__name__
    }
    assert sorted(found) == ERRORS.split()
    assert all(issubclass(error, errors.NomadError) for error in found.values())


def test_subpackages_are_not_hidden_behind_functions_of_their_name() -> None:
    package = importlib.import_module("nomad_mj")
    for name in ("arenas", "envs", "motion", "movers", "perception", "robots", "tasks"):
        importlib.import_module(f"nomad_mj.{name}")
        assert inspect.ismodule(getattr(package, name))


def test_the_version_is_the_distributions() -> None:
    metadata = importlib.import_module("importlib.metadata")
    try:
        version = metadata.version("nomad-mj")
    except metadata.PackageNotFoundError:
        pytest.skip("run from a checkout that is not installed")
    assert importlib.import_module("nomad_mj").__version__ == version
