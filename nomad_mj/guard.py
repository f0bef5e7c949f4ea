"""MJCF that would keep the engine busy for ever is told before the engine reads it."""

import math
from pathlib import Path
from xml.etree import ElementTree

from nomad_mj.errors import ModelError

_MOST_ELEMENTS = 200_000  # once everything is replicated
_MOST_COPIES = 5_000  # the engine takes a time that grows with the square of them
_MOST_FLEX = 1_000  # points of soft things, which take the engine longer still
_MOST_CELLS = 100_000_000  # of a texture or a height field
_LARGEST = 20_000_000  # bytes of a file
_DEEPEST = 40  # includes within includes
_NUSER = tuple(
    f"nuser_{kind}"
    for kind in ("body", "jnt", "geom", "site", "cam", "tendon", "actuator", "sensor")
)
_MOST_VALUES = 1_000_000  # that each body, keyframe or sensor is to keep for its user
# Attributes whose product is a size, which elements they belong to, and the most of it.
_SIZES: dict[str, tuple[tuple[tuple[str, ...], int], ...]] = {
    "texture": ((("width", "height"), _MOST_CELLS),),
    "hfield": ((("nrow", "ncol"), _MOST_CELLS),),
    "composite": ((("count",), _MOST_COPIES),),
    "flexcomp": ((("count",), _MOST_FLEX),),
    "user": ((("dim",), _MOST_VALUES),),
    "size": tuple(((name,), _MOST_VALUES) for name in ("nkey", "nuserdata", *_NUSER)),
}


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
    if element.tag == "include" or (element.tag == "model" and element.get("file")):
        # The engine looks for all of them where the first file is.
        folder = (above[0] if above else path).parent
        return _count_file(folder / element.get("file", ""), (*above, path))
    for names, most in _SIZES.get(element.tag, ()):
        size = math.prod(_number(part) for name in names for part in element.get(name, "1").split())
        if size > most:
            what = " x ".join(names)
            raise ModelError(f"has a {element.tag} of {size:.3g} cells ({what}); at most {most}")
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
