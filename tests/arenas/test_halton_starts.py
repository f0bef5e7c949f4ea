from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import shapely

from nomad_mj.arenas import FloorPlan
from nomad_mj.arenas.halton import halton_starts, main
from nomad_mj.assets import list_rooms
from nomad_mj.errors import StartError

OwnRoom = Callable[..., Path]

RING = shapely.box(-1, -1, 9, 5) - shapely.box(0, 0, 8, 4)
PLAN = FloorPlan([("ring", RING), ("box", shapely.box(3, 1, 5, 3))])


def test_starts_fill_the_interior_and_keep_every_condition() -> None:
    starts = halton_starts(PLAN, 40, [1, 1])
    np.testing.assert_allclose(starts[0], [2, 8 / 3])  # the second point: 1/4, 2/3 of the interior
    assert (PLAN.clearance(starts, 0.265) > 0.12).all()
    assert (np.linalg.norm(starts - [1, 1], axis=1) >= 1.2).all()
    np.testing.assert_array_equal(halton_starts(PLAN, 10, [1, 1]), starts[:10])


def test_too_many_starts() -> None:
    with pytest.raises(StartError, match="only 0 of 5 starts"):
        halton_starts(PLAN, 5, [1, 1], min_goal_distance=20.0)


def test_prints_the_sites_of_a_room(capsys: pytest.CaptureFixture[str]) -> None:
    path = list_rooms()["paper_room"]
    main([str(path), "50"])
    printed = capsys.readouterr().out
    assert printed.count("\n") == 50
    assert printed in path.read_text(encoding="utf-8")


def test_the_goal_may_be_on_a_body(own_room: OwnRoom, capsys: pytest.CaptureFixture[str]) -> None:
    goal = ('<site name="goal" pos="3 3 0"/>', '<body pos="3 3 0"><site name="goal"/></body>')
    printed: list[str] = []
    for path in (own_room(), own_room("", goal)):
        main([str(path), "5"])
        printed.append(capsys.readouterr().out)
    assert printed[0] == printed[1]


def test_a_room_that_cannot_be_read(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit, match="2"):
        main(["no_such_room.xml"])
    assert "room 'no_such_room.xml'" in capsys.readouterr().err.splitlines()[-1]
