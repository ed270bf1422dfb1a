"""Settings of Sphinx for the site; tools/build_site.py calls it."""

from docutils.nodes import SkipNode  # type: ignore[import-untyped]
from docutils.utils.math.latex2mathml import tex2mathml  # type: ignore[import-untyped]

from rubnoise import __version__

project = "rubnoise"
author = "The rubnoise developers"
project_copyright = "2026, The rubnoise developers"
version = release = __version__
extensions = ["myst_parser", "sphinx.ext.autodoc"]
html_theme = "furo"
html_title = f"rubnoise {__version__}"
html_copy_source = False
html_static_path = ["site.css", "tables.js"]
html_css_files = ["site.css"]
html_js_files = [("tables.js", {"defer": "defer"})]
html_show_sphinx = False
myst_enable_extensions = ["attrs_block", "attrs_inline", "colon_fence", "dollarmath"]
myst_dmath_allow_labels = False
myst_dmath_allow_digits = True  # without, a cell that begins with a formula and ends in a digit stays raw
html_math_renderer = "mathml"
myst_heading_anchors = 4
suppress_warnings: list[str] = []
default_role = "code"
autodoc_typehints = "description"
autodoc_member_order = "bysource"
highlight_language = "none"
nitpicky = True
nitpick_ignore_regex = [
    ("py:class", r"(collections|matplotlib|numpy|os|pathlib|pd|simpy|xr)\..+"),  # their pages would need a network
    # Types inside, which no page describes.
    ("py:class", r"rubnoise\.\w+(\.\w+)+|Axes|Figure|KeptRun|Kind|Model|PooledEstimate|Style"),
]


def setup(app: object) -> None:
    """Take bars in docstrings for what they are, absolute values; write formulas as MathML, which needs no network."""
    app.connect("autodoc-process-docstring", _without_substitutions)  # type: ignore[attr-defined]
    app.add_html_math_renderer(  # type: ignore[attr-defined]
        "mathml", inline_renderers=(_inline, None), block_renderers=(_block, None)
    )


def _inline(translator: object, node: object) -> None:
    _formula(translator, node, as_block=False)


def _block(translator: object, node: object) -> None:
    _formula(translator, node, as_block=True)


def _formula(translator: object, node: object, *, as_block: bool) -> None:
    tag = "div" if as_block else "span"
    written = tex2mathml(node.astext(), as_block=as_block)  # type: ignore[attr-defined]
    translator.body.append(f'<{tag} class="math">{written}</{tag}>')  # type: ignore[attr-defined]
    raise SkipNode


def _without_substitutions(*event: object) -> None:
    lines = event[-1]
    assert isinstance(lines, list)  # noqa: S101  (Sphinx hands out the lines to change in place)
    lines[:] = [line.replace("|", "\\|") for line in lines]
