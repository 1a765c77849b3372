# SPDX-License-Identifier: BSD-3-Clause
# Settings of the site that tools/make-docs builds.
import functools
import os
import re
import subprocess
import sys

from docutils import nodes
from pygments.lexer import RegexLexer, bygroups
from pygments.token import Generic, Text

project = "fracfit"
version = release = os.environ.get("FRACFIT_VERSION", "")
html_title = f"fracfit {version}"
copyright = "the authors of fracfit"
extensions = ["myst_parser", "sphinx_copybutton", "sphinx.ext.autodoc", "sphinx.ext.napoleon"]
# The Python module is described by its own texts; its compiled parts need not be built for that.
sys.path.insert(0, os.path.abspath("../python"))
autodoc_mock_imports = ["numpy", "matplotlib", "fracfit._core", "fracfit._files", "fracfit._fitting"]
autodoc_typehints = "none"
napoleon_google_docstring = False
strip_signature_backslash = True  # "lambda_" keeps its underscore
default_role = "py:obj"
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["generate"]
myst_enable_extensions = ["deflist", "dollarmath"]
html_math_renderer = "mathml"
myst_heading_anchors = 3
smartquotes = False  # "--model" is no dash
html_theme = "furo"
html_static_path = ["style"]
html_css_files = ["site.css"]
html_show_sphinx = False
html_show_sourcelink = False
html_copy_source = False
html_last_updated_fmt = None
pygments_style = "tango"
# A button copies the commands of a block, not what they print.
copybutton_prompt_text = r"\$ |> "
copybutton_prompt_is_regexp = True
highlight_language = "text"


class TerminalLexer(RegexLexer):
    """What is typed after "$ ", its continued lines after "> ", and below it what is printed, as it is."""

    tokens = {
        "root": [
            (r"(\$ )(.*\n)", bygroups(Generic.Prompt, Text), "typed"),
            (r".*\n", Generic.Output),
        ],
        "typed": [
            (r"(> )(.*\n)", bygroups(Generic.Prompt, Text)),
            (r"", Text, "#pop"),
        ],
    }


def keep_numbers_whole(app, doctree, page):
    """Browsers would break 2e-16 behind its hyphen."""
    for text in list(doctree.findall(nodes.Text)):
        parts = re.split(r"(\d[\d.]*e-\d+)", text)
        if len(parts) > 1 and not isinstance(text.parent, (nodes.literal, nodes.literal_block)):
            pieces = (nodes.inline("", each, classes=["number"]) if i % 2 else nodes.Text(each) for i, each in enumerate(parts))
            text.parent.replace(text, list(pieces))


@functools.lru_cache(maxsize=None)
def mathml(tex, display):
    """A formula as MathML, which browsers draw without a script and without network; pandoc refuses what it cannot convert."""
    text = f"$${tex}$$" if display else f"${tex}$"
    command = ["pandoc", "--from", "markdown", "--to", "html", "--mathml", "--fail-if-warnings"]
    done = subprocess.run(command, input=text, capture_output=True, text=True)
    found = re.search(r"<math.*</math>", done.stdout, re.DOTALL)
    if done.returncode or not found:
        raise RuntimeError(f"pandoc cannot convert {tex}: {done.stderr}")
    # Parentheses grow where TeX asks for it with \\left alone.
    return found[0] if "\\left" in tex else found[0].replace('stretchy="true"', 'stretchy="false"')


def visit_formula(writer, node):
    display = isinstance(node, nodes.math_block)
    formula = mathml(" ".join(node.astext().split()), display)
    writer.body.append(f'<div class="formula">{formula}</div>' if display else formula)
    raise nodes.SkipNode


def setup(app):
    app.add_html_math_renderer("mathml", inline_renderers=(visit_formula, None), block_renderers=(visit_formula, None))
    app.add_lexer("console", TerminalLexer)
    app.connect("doctree-resolved", keep_numbers_whole)
