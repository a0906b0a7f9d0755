"""Settings of Sphinx for the site; docs/site/build.py calls it."""
import importlib.util
import os

from pygments.lexers.javascript import JavascriptLexer

project = "Apothem"
author = "the Apothem authors"
copyright = "the Apothem authors, GPL-3.0-or-later"
version = release = os.environ["APOTHEM_VERSION"]
extensions = ["myst_parser", "sphinx.ext.mathjax", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
root_doc = "index"
html_theme = "furo"
html_title = "Apothem"
html_static_path = ["_static"]
html_css_files = ["site.css"]
html_show_sphinx = False

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
# A copy of MathJax lies in the site, so that formulas are set without a network.
mathjax_path = "mathjax/MathJax.js?config=TeX-AMS_SVG-full"
mathjax2_config = {"tex2jax": {"ignoreClass": "mathjax_none", "processClass": "math"},
                   "messageStyle": "none", "showMathMenu": False}
myst_update_mathjax = False

highlight_language = "none"
pygments_style = "friendly"

if importlib.util.find_spec("numpy") is None:
    autodoc_mock_imports = ["numpy"]  # which the annotations of the stubs name
autodoc_member_order = "bysource"
autodoc_typehints = "description"


def setup(app):
    app.add_lexer("jsonc", JavascriptLexer)  # JSON with comments
