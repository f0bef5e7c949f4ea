"""A robot that knows nothing of this package, with a data sheet beside it."""

from collections.abc import Callable
from pathlib import Path

import pytest

SERVOS = "".join(
    f'<velocity name="motor_{side}" joint="wheel_{side}" kv="1" ctrlrange="-15 15"/>'
    for side in "lr"
)
LIDAR = "rings:\n  lidar: {count: 24, height: 0.15, half_angle: 7.5, range: [0.02, 4.0]}\n"


@pytest.fixture
def cart(tmp_path: Path) -> Callable[..., Path]:
    """Return a function that writes the cart, with replacements, and its data sheet."""

    def write(*replacements: tuple[str, str], sheet: str = LIDAR, actuators: str = SERVOS) -> Path:
        text = (Path(__file__).parent / "cart.xml").read_text().replace("ACTUATORS", actuators)
        for old, new in replacements:
            assert old in text, f"the cart has no {old!r}"
            text = text.replace(old, new)
        path = tmp_path / "cart.xml"
        path.write_text(text)
        (tmp_path / "cart.yaml").write_text(sheet)
        return path

    return write
