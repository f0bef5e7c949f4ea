"""The ids under which `gymnasium.make` knows the environments."""

import gymnasium

PATH_FINDING = "nomad_mj/PathFinding-v0"
MOTOR = "nomad_mj/Motor-v0"
DECISIONS = 100  # after so many an episode is given up, as everywhere in this package
CONTROL_STEPS = 2400  # two minutes at 20 Hz


def register() -> None:
    """Register the environments; more than once does no harm."""
    if PATH_FINDING not in gymnasium.registry:
        gymnasium.register(
            PATH_FINDING,
            entry_point="nomad_mj.gym.path_finding:PathFindingEnv",
            vector_entry_point="nomad_mj.gym.vector_entries:path_finding_vector_env",
            max_episode_steps=DECISIONS,
        )
    if MOTOR not in gymnasium.registry:
        gymnasium.register(
            MOTOR,
            entry_point="nomad_mj.gym.motor:MotorEnv",
            vector_entry_point="nomad_mj.gym.vector_entries:motor_vector_env",
            max_episode_steps=CONTROL_STEPS,
        )
