# SPDX-License-Identifier: BSD-3-Clause
# Settings of the site that tools/make-docs builds.
import os

project = "fracfit"
version = release = os.environ.get("FRACFIT_VERSION", "")
html_title = f"fracfit {version}"
copyright = "the authors of fracfit"
extensions = ["myst_parser", "sphinx_copybutton"]
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["generate", "**/README.md"]
myst_enable_extensions = ["deflist"]
myst_heading_anchors = 3
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
primary_domain = "cpp"
highlight_language = "text"
