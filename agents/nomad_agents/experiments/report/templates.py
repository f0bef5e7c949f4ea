"""The templates of pages: a frame that all share, tables, pictures."""

from functools import cache

import jinja2


@cache
def find_template(name: str, package: str = "") -> jinja2.Template:
    """Return a template, which may extend and include those of the report.

    Parameters
    ----------
    name : str
        Of its file.
    package : str
        Where it lies, if not beside the report's.
    """
    packages = [package] if package else []
    packages.append("nomad_agents.experiments.report")
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([jinja2.PackageLoader(each, ".") for each in packages]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(name)
