"""`rubnoise docs`: the documentation as one web page."""

from pathlib import Path

from rubnoise.cli.layout import sentence, size
from rubnoise.cli.options import PageFile, ReplaceFile


def command(
    *,
    output: PageFile = Path("rubnoise.html"),
    force: ReplaceFile = False,
) -> None:
    """Write the documentation of this version as one web page, which needs no network.

    Example: rubnoise docs -o rubnoise.html
    """
    from rubnoise.pages.manual import manual
    from rubnoise.storage.output import check_output, whole_file

    check_output(output, force=force)
    text = manual()
    with whole_file(output, force=force) as part:
        part.write_text(text, encoding="utf-8")
    print(sentence(f"{output}: {size(output.stat().st_size)}; a browser opens it, with or without a network"))
