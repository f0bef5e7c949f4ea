"""Where the MJCF files are, and how a name or a path of the user's becomes one of them."""

from pathlib import Path

from nomad_mj.errors import ModelError, UnknownNameError


def models_dir() -> Path:
    """Return the folder of the MJCF files: inside an installed package, beside it in a checkout."""
    package = Path(__file__).resolve().parent
    for folder in (package / "models", package.parent / "models"):
        if (folder / "scene.xml").is_file():
            return folder
    raise ModelError(f"the MJCF models are missing: no scene.xml in {package / 'models'}")


def _named(pattern: str) -> dict[str, Path]:
    return {path.stem: path for path in sorted(models_dir().glob(pattern))}


def list_rooms() -> dict[str, Path]:
    """Return the rooms that come with the package, by name."""
    return _named("arenas/*.xml")


def list_robots() -> dict[str, Path]:
    """Return the robots that come with the package, by name."""
    return _named("robots/*/*.xml")


def _find(kind: str, name_or_path: str | Path, known: dict[str, Path]) -> Path:
    text = str(name_or_path)
    if text in known:
        return known[text]
    if isinstance(name_or_path, str) and Path(text).suffix == "" and "/" not in text:
        raise UnknownNameError(kind, text, known)
    path = Path(text)
    try:
        path = path.expanduser()
        if path.is_file():
            return path
        what = "is a folder, not a file" if path.is_dir() else "does not exist"
    except (OSError, RuntimeError) as error:  # a name too long, a home that there is not
        what = f"cannot be looked up ({getattr(error, 'strerror', None) or error})"
        text = text if len(text) <= 80 else text[:77] + "..."
    raise ModelError(
        f"{kind} file {text!r} {what}; give an MJCF file or one of: {', '.join(sorted(known))}"
    )


def find_room(name_or_path: str | Path) -> Path:
    """Return the file of a room, given its name or a path.

    Raises
    ------
    UnknownNameError
        A name that no room has.
    ModelError
        A path where there is no file.
    """
    return _find("room", name_or_path, list_rooms())


def find_robot(name_or_path: str | Path) -> Path:
    """Return the file of a robot, given its name or a path; errors as of `find_room`."""
    return _find("robot", name_or_path, list_robots())
