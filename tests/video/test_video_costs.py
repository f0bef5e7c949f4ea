import pytest

import nomad_mj
from nomad_mj.video import frame_costs


@pytest.mark.gl
def test_costs_of_both_kinds_of_frames_are_measured() -> None:
    env = nomad_mj.load("path_finding", room="paper_room")
    env.reset(seed=1)
    before = env.physics.get_state()
    costs = frame_costs(env, frames=8, size=(160, 120))
    assert costs.bare_us > 100 and costs.recorded_us > 100
    assert costs.ratio == costs.recorded_us / costs.bare_us
    assert (env.physics.get_state() == before).all()
    env.close()
