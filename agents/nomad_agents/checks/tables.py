"""What a check has found, as tables for people and as values for programs."""

import math
from dataclasses import asdict
from pathlib import Path

from rich.table import Table

from nomad_agents.checks.patterns import Drift
from nomad_mj.robots import find_sheet
from nomad_mj.scene import Scene


def robot_table(scene: Scene, path: Path) -> Table:
    """Return what a robot's file at `path` offers."""
    robot, limits = scene.robot, scene.robot.limits
    table = Table("what", "found", title=f"Robot {robot.name}")
    sheet = find_sheet(path)
    table.add_row("file", str(path))
    table.add_row("data sheet", str(sheet) if sheet else "none")
    table.add_row("drive", robot.drive.kind)
    table.add_row("stands on", "a free joint" if robot.footing.free else "slide joints")
    table.add_row("motors", ", ".join(_motors(scene)))
    table.add_row("radius, height", f"{robot.layout.radius:.3g} m, {robot.height:.3g} m")
    table.add_row("mass", f"{_mass(scene):.3g} kg")
    table.add_row(
        "driving", f"{limits.translate:.3g} m/s, {limits.translate_acceleration:.3g} m/s2"
    )
    turn, turn_acceleration = map(math.degrees, (limits.turn, limits.turn_acceleration))
    table.add_row("turning", f"{turn:.0f} deg/s, {turn_acceleration:.0f} deg/s2")
    table.add_row("bumpers", str(len(robot.bumpers)))
    return table


def _motors(scene: Scene) -> list[str]:
    ranges = scene.model.actuator_ctrlrange[scene.robot.controls]
    return [
        f"{name} {low:.3g} to {high:.3g}"
        for name, (low, high) in zip(scene.robot.drive.motors, ranges, strict=True)
    ]


def _mass(scene: Scene) -> float:
    model = scene.model
    root = model.body_rootid[scene.robot.footing.base]
    return float(model.body_mass[model.body_rootid == root].sum())


def sensor_table(scene: Scene) -> Table:
    """Return the rings of range sensors of a scene's robot."""
    robot = scene.robot
    table = Table(
        "ring", "cones", "rays", "bearings [deg]", "cone [deg]", "range [m]", title="Range sensors"
    )
    first = 0
    edges = [*robot.rays.first.tolist(), len(robot.rays.address)]
    for ring in robot.layout.rings:
        count = len(ring.bearings)
        rays = edges[first + count] - edges[first]
        bearings = [str(round(math.degrees(b))) for b in ring.bearings]
        shown = " ".join(bearings if count <= 16 else [*bearings[:8], "...", bearings[-1]])
        table.add_row(
            ring.name,
            str(count),
            str(rays),
            shown,
            f"{2 * math.degrees(ring.half_angle):.0f}",
            f"{ring.min_range:g} to {ring.max_range:g}",
        )
        first += count
    return table


def drift_table(drifts: list[Drift]) -> Table:
    """Return what became of test patterns."""
    table = Table(
        "pattern",
        "from target [mm]",
        "[deg]",
        "from odometry [mm]",
        "[deg]",
        "time [s]",
        title="Test patterns, without noise",
    )
    for drift in drifts:
        table.add_row(
            drift.name + ("" if drift.finished else " (not finished)"),
            f"{1000 * drift.off_target:.1f}",
            f"{math.degrees(drift.off_facing):.2f}",
            f"{1000 * drift.off_odometry:.1f}",
            f"{math.degrees(drift.off_heading):.2f}",
            f"{drift.seconds:.1f}",
        )
    return table


def robot_values(scene: Scene) -> dict[str, object]:
    """Return what a scene's robot offers."""
    robot = scene.robot
    return {
        "robot": robot.name,
        "drive": robot.drive.kind,
        "motors": list(robot.drive.motors),
        "radius": robot.layout.radius,
        "height": robot.height,
        "limits": asdict(robot.limits),
        "rings": {ring.name: len(ring.bearings) for ring in robot.layout.rings},
        "bumpers": len(robot.bumpers),
    }


def room_values(scene: Scene) -> dict[str, object]:
    """Return what a scene's room offers."""
    x0, y0, x1, y1 = scene.plan.bounds.tolist()
    arena = scene.arena
    return {
        "room": arena.name,
        "floor": f"{x1 - x0:.3g} x {y1 - y0:.3g} m",
        "obstacles": len(scene.plan.footprints),
        "goal": ", ".join(f"{value:g}" for value in arena.goal.tolist()),
        "starts": len(arena.starts),
        "cameras": ", ".join(arena.cameras) or "none",
        "moving_obstacles": len(scene.moving.obstacles),
        "free_floor": f"{scene.free_space.area:.1f} m2",
    }
