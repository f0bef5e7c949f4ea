"""Obstacles that move: what rays see and bumpers feel of them."""

import math

import numpy as np
import pytest
from known_movers import drawn_obstacles, movers_of

from nomad_mj import MotorEnvironment, MovingObstacles, list_robots, load
from nomad_mj.types import FloatArray


@pytest.mark.parametrize("robot", list_robots())
def test_the_robot_can_bump_into_an_obstacle_which_is_not_moved_by_it(robot: str) -> None:
    still = MovingObstacles(count=1, speed=1e-9)
    env = load("motor", "empty_room", robot, {"moving_obstacles": still, "ends_at_goal": False})
    env.reset(seed=0, start=(5.0, 5.0))
    (place,) = drawn_obstacles(env)
    heading = math.atan2(place[1] - 5, place[0] - 5)
    step = env.reset(seed=0, start=(5.0, 5.0, heading))
    ours = env.task.scene.robot
    gap = math.dist(place, (5, 5)) - 0.25 - ours.layout.radius
    ahead = ours.drive.twist(0.3, 0.0, 0.0, env.task.travel)
    for _ in range(int(gap / 0.3 / 0.05) + 60):
        step = env.step(ahead)
    assert step.observation["bumpers"].any() or not ours.bumpers
    np.testing.assert_allclose(drawn_obstacles(env)[0], place, atol=1e-6)
    reached = math.dist(env.physics.pose()[:2], (5, 5))
    inside = 0.07 if robot == "pioneer" else 0.02  # it is shorter ahead of its axle than behind
    assert gap - 0.02 < reached < gap + inside + 0.02
    env.close()


def test_rays_see_the_obstacles_where_they_are_at_that_instant(env: MotorEnvironment) -> None:
    """Every ray against the circles: to a millimetre, at the end of each control step."""
    scene = env.task.scene
    model, rays = scene.model, scene.robot.rays
    sensors = {int(model.sensor_adr[s]): s for s in range(model.nsensor)}
    own = [sensors[int(address)] for address in rays.address]
    at, cutoff = [int(model.sensor_objid[s]) for s in own], model.sensor_cutoff[own]
    movers = movers_of(env)
    seen = 0
    for seed in range(4):
        env.reset(seed=seed)
        for tick in range(60):
            if tick:
                env.step((0.2, 0.3, 0.4))
            data = env.physics.data
            hits = _to_circles(
                data.site_xpos[at][:, :2], data.site_xmat[at][:, 2::3], movers.obstacles, 0.25
            )
            read = data.sensordata[rays.address]
            walls = ~np.isfinite(hits)
            nearer = (read > 0) & (read < hits - 1e-3)  # something stands before it
            good = np.abs(read - hits, where=~walls, out=np.full_like(hits, np.inf)) < 1e-3
            far = hits > cutoff - 1e-3
            assert (walls | nearer | good | far).all()
            seen += int(good.sum())
    assert seen > 200


def _to_circles(
    start: FloatArray, axis: FloatArray, centres: FloatArray, radius: float
) -> FloatArray:
    """Return how far along each ray (R,) the first upright cylinder is, inf if none."""
    flat = np.hypot(axis[:, 0], axis[:, 1])
    toward = axis[:, :2] / flat[:, None]
    offset = centres - start[:, None]
    along = np.einsum("rnk,rk->rn", offset, toward)
    across = np.einsum("rnk,rnk->rn", offset, offset) - along**2
    depth = np.sqrt(np.where(across < (radius - 1e-3) ** 2, radius**2 - across, np.nan))
    met = np.where(np.isfinite(depth) & (along > 0), along - depth, np.inf)
    return met.min(axis=1) / flat
