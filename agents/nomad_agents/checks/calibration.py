"""What test patterns tell of odometry: the numbers with which it would be right.

After J. Borenstein and L. Feng, "Measurement and correction of systematic odometry errors in mobile
robots", IEEE Trans. Robotics and Automation 12 (1996), for one straight way and one turn.
"""

import math
from collections.abc import Sequence

from nomad_agents.checks.patterns import Drift
from nomad_mj.motion import WheeledDrive
from nomad_mj.scene import Scene

_SLIP = 0.005  # of the way, or of the turn, that odometry may be off
_MISSED = 1.0  # [m] from where the straight way should end: no wheel is so wrongly measured
_OVERSHOT = 0.05  # [m] likewise, but by odometry: a robot that can stop when it should is nearer


def calibrate(scene: Scene, drifts: Sequence[Drift]) -> dict[str, float]:
    """Return numbers for the data sheet of a differential drive, none where odometry is right.

    Parameters
    ----------
    scene : Scene
        The robot as it drove.
    drifts : sequence of Drift
        Of `drive_patterns`.

    Returns
    -------
    dict
        ``wheel_radius`` [m], as if all wheels were alike, and ``track`` [m].
    """
    straight, turn, _ = drifts
    drive = scene.robot.drive
    numbers: dict[str, float] = {}
    if not isinstance(drive, WheeledDrive) or drive.kind != "differential":
        return numbers
    if not straight.stretch > 0 or not turn.turned:  # it did not move at all
        return numbers
    stretch = straight.stretch if abs(straight.stretch - 1) > _SLIP else 1.0
    if stretch != 1.0:
        gear = float(scene.model.actuator_gear[scene.robot.motors[0], 0])
        numbers["wheel_radius"] = stretch * abs(gear / drive.gains[0])
    # With other wheels odometry would have turned by as much more.
    off = (turn.turned + turn.off_heading) / (turn.turned * stretch)
    if turn.finished and abs(off - 1) > _SLIP:
        arms = [row[2] / row[0] for row in drive.rows]
        numbers["track"] = (max(arms) - min(arms)) / off
    return numbers


def find_drift_faults(scene: Scene, drifts: Sequence[Drift]) -> list[str]:
    """Return what test patterns tell is wrong, one line each, with what would be better."""
    faults = [f"{drift.name}: did not come to its end" for drift in drifts if not drift.finished]
    straight, turn, _ = drifts
    if straight.finished and straight.off_target > _MISSED:
        faults.append(
            f"{straight.name}: ends {straight.off_target:.2f} m from its target; does each motor "
            "do what its name says, in that direction?"
        )
    elif straight.finished and straight.off_target - straight.off_odometry > _OVERSHOT:
        faults.append(
            f"{straight.name}: ends {straight.off_target:.2f} m from its target; its motors may be "
            "too weak to stop it in time: give them more force, or less translate_max_acceleration"
        )
    if abs(straight.stretch - 1) > _SLIP:
        faults.append(
            f"odometry is off by {straight.stretch - 1:+.1%} straight ahead: the wheels slip "
            "(castors that drag or carry the weight, weak friction) or are not as large as said"
        )
    if abs(turn.off_heading) > _SLIP * 2 * math.pi:
        faults.append(f"odometry is off by {math.degrees(turn.off_heading):.0f} deg after a turn")
    numbers = ", ".join(f"{name}: {value:.4g}" for name, value in calibrate(scene, drifts).items())
    if numbers:
        faults.append(f"odometry would be nearer the truth with {{{numbers}}} in its data sheet")
    return faults
