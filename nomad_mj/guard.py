"""MJCF that would keep the engine busy for ever is told before the engine reads it."""

import math
from pathlib import Path
from xml.etree import ElementTree

from nomad_mj.errors import ModelError

_MOST_ELEMENTS = 200_000  # once everything is replicated
_MOST_COPIES = 5_000  # the engine takes a time that grows with the square of them
_MOST_CELLS = 100_000_000  # of a texture or a height field
_LARGEST = 20_000_000  # bytes of a file
_DEEPEST = 40  # includes within includes
# Attributes whose product is a size, and which elements they belong to.
_SIZES = {
    "texture": ("width", "height"),
    "hfield": ("nrow", "ncol"),
    "composite": ("count",),
    "flexcomp": ("count",),
}
_MOST = {"composite": _MOST_COPIES, "flexcomp": _MOST_COPIES}


def check_size(kind: str, path: Path) -> None:
    """Raise ModelError for a file that describes more than any room or robot needs.

    What is no XML at all is left to the engine, whose message names the line.

    Parameters
    ----------
    kind : str
        Room or robot, for the message.
    path : Path
        An MJCF file; the files that it includes are looked at too.
    """
    try:
        count = _count_file(path, ())
    except ModelError as error:
        raise ModelError(f"{kind} file {str(path)!r} {error}") from None
    if count > _MOST_ELEMENTS:
        raise ModelError(
            f"{kind} file {str(path)!r} makes {count:.3g} elements; at most {_MOST_ELEMENTS} "
            "will do: look at the counts of its replicate elements"
        )


def _count_file(path: Path, above: tuple[Path, ...]) -> float:
    if len(above) > _DEEPEST:
        raise ModelError("includes itself, or files more than forty deep")
    try:
        if path.exists() and not path.is_file():  # the engine would wait for a pipe
            raise ModelError(f"includes {str(path)!r}, which is no file")
        if path.stat().st_size > _LARGEST:
            raise ModelError(f"is larger than {_LARGEST // 1_000_000} MB; is it MJCF?")
        text = path.read_bytes()
        if text.lstrip().startswith(b"<"):
            text.decode()  # the engine reads other text, but its names cannot be asked for
        return _count(ElementTree.fromstring(text), path, above)
    except UnicodeDecodeError:
        raise ModelError("holds what is not UTF-8 text") from None
    except (OSError, ElementTree.ParseError, ValueError, RecursionError):
        return 0.0


def _count(element: ElementTree.Element, path: Path, above: tuple[Path, ...]) -> float:
    """Return how many elements one becomes."""
    if element.tag == "include":
        return _count_file(path.parent / element.get("file", ""), (*above, path))
    size = math.prod(
        _number(part)
        for name in _SIZES.get(element.tag, ())
        for part in element.get(name, "1").split()
    )
    most = _MOST.get(element.tag, _MOST_CELLS)
    if size > most:
        raise ModelError(f"has a {element.tag} of {size:.3g} cells; at most {most}")
    inside = sum(_count(child, path, above) for child in element)
    if element.tag != "replicate":
        return 1.0 + inside
    copies = _number(element.get("count", "1")) * inside
    if copies > _MOST_COPIES:
        raise ModelError(f"makes {copies:.3g} elements by replicate; at most {_MOST_COPIES}")
    return copies


def _number(text: str) -> float:
    """Return the number that a text says, 1 if it says none: the engine tells what is wrong."""
    try:
        return max(abs(float(text)), 1.0)
    except ValueError:
        return 1.0
