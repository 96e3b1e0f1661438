"""Hook of the site's build: the folder ``reports`` beside ``docs`` becomes a part of the site."""

import re
from pathlib import Path

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]


def on_files(files: Files, *, config) -> Files:
    """Add what lies in ``reports``, under that name."""
    for path in sorted((ROOT / "reports").rglob("*")):
        if path.is_file():
            name = path.relative_to(ROOT).as_posix()
            files.append(File(name, str(ROOT), config["site_dir"], config["use_directory_urls"]))
    return files


def on_page_markdown(markdown: str, *, page, config, files) -> str:
    """Links between the two folders, which in the site lie in each other."""
    if page.file.src_uri.startswith("reports/"):
        return re.sub(r"\]\(((?:\.\./)+)docs/", r"](\1", markdown)
    return re.sub(r"\]\(\.\./((?:\.\./)*reports/)", r"](\1", markdown)
