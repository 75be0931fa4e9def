"""The commands `plot` and `report` within the process of a test: a start of Python with its modules costs as much as some pictures."""
import contextlib
import os
import pathlib
import sys
import tempfile
import traceback
import typing

sys.path.insert(0, str(pathlib.Path(__file__).parents[2] / "scripts"))
from whirl_plot import __main__ as plot  # noqa: E402
from whirl_plot import report, style  # noqa: E402
from whirl_plot.manifest import register  # noqa: E402


class Done(typing.NamedTuple):
    returncode: int
    stdout: str
    stderr: str


@contextlib.contextmanager
def into(file, number):
    """Sends what Python and the libraries in C write to descriptor `number` into a file."""
    kept = os.dup(number)
    os.dup2(file.fileno(), number)
    try:
        yield
    finally:
        (sys.stdout if number == 1 else sys.stderr).flush()
        os.dup2(kept, number)
        os.close(kept)


def call(command, directory, *words, draw=None):
    """scripts/COMMAND DIRECTORY WORDS. Every figure is made; of those not in `draw` (names without ending) only empty files are written."""
    real = style.write

    def write(figure, stem):
        if draw is None or stem.name in draw:
            return real(figure, stem)
        files = [register(stem.with_name(f"{stem.name}.{kind}")) for kind in style.formats]
        for file in files:
            file.touch()
        return files

    with tempfile.TemporaryFile("w+") as out, tempfile.TemporaryFile("w+") as wrong:
        sys.stdout.flush()
        style.write = write
        try:
            with into(out, 1), into(wrong, 2):
                try:
                    code = {"plot": plot, "report": report}[command].main([str(directory), *words])
                except SystemExit as end:
                    code = end.code
                except Exception:
                    traceback.print_exc()
                    code = 1
        finally:
            style.write = real
        texts = []
        for file in (out, wrong):
            file.seek(0)
            texts.append(file.read())
    return Done(code, *texts)
