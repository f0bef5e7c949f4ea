"""Seeds as users give them."""

import numpy as np

from nomad_mj.errors import ConfigError


def seed_sequence(seed: int | np.random.SeedSequence | None) -> np.random.SeedSequence:
    """Return a seed as a SeedSequence, None as a new one; raise ConfigError if it is none."""
    try:
        is_sequence = isinstance(seed, np.random.SeedSequence)
        return seed if is_sequence else np.random.SeedSequence(seed)
    except (TypeError, ValueError):
        raise ConfigError(f"seed {seed!r}: must be a whole number from 0 on") from None
