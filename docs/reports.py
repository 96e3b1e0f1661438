"""Hook of the site's build: the README becomes its home page, the folder ``reports`` a part of it."""

import re
from pathlib import Path

from mkdocs.structure.files import File, Files

ROOT = Path(__file__).parents[1]


def on_files(files: Files, *, config) -> Files:
    """Add the README, and what lies in ``reports``, under that name."""
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    files.append(File.generated(config, "index.md", content=readme.replace("](docs/", "](")))
    for path in sorted((ROOT / "reports").rglob("*")):
        if path.is_file():
            name = path.relative_to(ROOT).as_posix()
            files.append(File(name, str(ROOT), config["site_dir"], config["use_directory_urls"]))
    return files


def on_page_markdown(markdown: str, *, page, config, files) -> str:
    """Links to the README, and between the two folders, which in the site lie in each other."""
    if page.file.src_uri.startswith("reports/"):
        return re.sub(r"\]\(((?:\.\./)+)docs/", r"](\1", markdown)
    markdown = re.sub(r"\]\(\.\./((?:\.\./)*)README\.md", r"](\1index.md", markdown)
    return re.sub(r"\]\(\.\./((?:\.\./)*reports/)", r"](\1", markdown)
