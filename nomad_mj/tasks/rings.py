"""The rings that an option names, found on a robot."""

from nomad_mj.errors import ConfigError
from nomad_mj.types import RangeRing, SensorLayout


def ring_slices(
    what: str, names: tuple[str, ...], layout: SensorLayout
) -> list[tuple[RangeRing, slice]]:
    """Return the rings of these names, and where their cones are among those of all rings.

    Parameters
    ----------
    what : str
        What they are to be, for the message.
    names : tuple of str
        Names of rings.
    layout : SensorLayout
        The robot's.

    Raises
    ------
    ConfigError
        The robot has no such ring.
    """
    found: dict[str, tuple[RangeRing, slice]] = {}
    first = 0
    for ring in layout.rings:
        found[ring.name] = ring, slice(first, first + len(ring.bearings))
        first += len(ring.bearings)
    for name in names:
        if name not in found:
            raise ConfigError(
                f"{what} ring {name!r}: the robot has no such ring; rings it has: "
                f"{', '.join(found)}"
            )
    return [found[name] for name in names]
