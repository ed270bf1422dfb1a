"""Settings of Sphinx for the site; tools/build_site.py calls it."""

from rubnoise import __version__

project = "rubnoise"
author = "The rubnoise developers"
project_copyright = "2026, The rubnoise developers"
version = release = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc", "sphinx.ext.mathjax"]
html_theme = "furo"
html_title = f"rubnoise {__version__}"
html_copy_source = False
html_show_sphinx = False
myst_enable_extensions = ["attrs_block", "colon_fence"]
myst_heading_anchors = 4
suppress_warnings: list[str] = []
default_role = "code"
autodoc_typehints = "description"
autodoc_member_order = "bysource"
highlight_language = "none"
nitpicky = False


def setup(app: object) -> None:
    """Take bars in docstrings for what they are, absolute values."""
    app.connect("autodoc-process-docstring", _without_substitutions)  # type: ignore[attr-defined]


def _without_substitutions(*event: object) -> None:
    lines = event[-1]
    assert isinstance(lines, list)  # noqa: S101  (Sphinx hands out the lines to change in place)
    lines[:] = [line.replace("|", "\\|") for line in lines]
