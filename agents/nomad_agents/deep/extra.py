"""Whether the optional packages of the deep learners are there."""

from nomad_agents.extras import need

DEEP_PACKAGES = ("torch", "stable-baselines3")  # whose versions change what is learnt
CPU_BUILD = "--extra-index-url https://download.pytorch.org/whl/cpu"


def require_extra(*, curves: bool) -> None:
    """Raise ConfigError, with what to install, if PyTorch or Stable-Baselines3 is missing.

    So if TensorBoard is, for a training that writes `curves`.
    """
    for module in ("torch", "stable_baselines3"):
        need(module, "deep", "a deep learner", CPU_BUILD)
    if curves:
        need("tensorboard.summary", "tensorboard", "TensorBoard's curves")
