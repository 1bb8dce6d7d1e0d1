# SPDX-License-Identifier: Apache-2.0
"""The site of the documents; tools/make_docs.py copies this beside what it has gathered."""

project = "Iota"
author = "The Iota authors"
copyright = "The Iota authors, Apache-2.0"
extensions = ["myst_parser", "breathe"]
source_suffix = {".md": "markdown"}
exclude_patterns = ["cpp/xml"]
nitpicky = False
# Blocks without a language are commands, tables of files, and output.
highlight_language = "none"
myst_heading_anchors = 4
# The reference has functions of many classes with the same heading; each header opens the namespace again.
suppress_warnings = ["myst.header", "duplicate_declaration.cpp"]
breathe_projects = {"iota": "cpp/xml"}
breathe_default_project = "iota"
breathe_default_members = ("members",)
html_theme = "furo"
html_title = "Iota"
html_static_path = ["_static"]
html_favicon = "_static/favicon.svg"
html_extra_path = ["_extra"]
html_show_sourcelink = False
html_copy_source = False
# The page's server is the only one that pages of this project ask: no fonts or scripts from elsewhere.
html_theme_options = {"navigation_with_keys": True}
