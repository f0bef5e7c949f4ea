"""The templates of pages: a frame that all share, tables, pictures."""

from functools import cache

import jinja2


@cache
def find_template(name: str, package: str) -> jinja2.Template:
    """Return a template, which may extend and include those that are here.

    Parameters
    ----------
    name : str
        Of its file.
    package : str
        Where it lies.
    """
    packages = (package, "nomad_agents.studies.pages")
    environment = jinja2.Environment(
        loader=jinja2.ChoiceLoader([jinja2.PackageLoader(each, ".") for each in packages]),
        autoescape=True,
        undefined=jinja2.StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template(name)
