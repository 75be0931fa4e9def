"""Running decks."""
import os
import pathlib
import shutil
import subprocess

from .results import Error, read

ROOT = pathlib.Path(__file__).resolve().parents[2]


class RunError(Error):
    """A run that failed: `code` is the exit code of the program, `log` all that it wrote."""

    def __init__(self, message, code, log):
        super().__init__(message)
        self.code, self.log = code, log


def program():
    """Path of the program: the variable WHIRL_PROGRAM, build/whirl of this source tree, or the installed one."""
    here = ROOT / "build" / "whirl"
    path = pathlib.Path(os.environ.get("WHIRL_PROGRAM") or (here if here.is_file() else shutil.which("whirl") or here))
    if not path.is_file():
        raise Error(f"there is no program {path}: build it with scripts/run, install it, or name it in WHIRL_PROGRAM")
    return path


def environment():
    """As of the scripts: no BLAS threads beside the ranks, and root may start MPI."""
    more = {"OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1", "OMPI_MCA_rmaps_base_oversubscribe": "1"}
    if os.geteuid() == 0:
        more |= {"OMPI_ALLOW_RUN_AS_ROOT": "1", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM": "1"}
    return {**os.environ, **more}


def word(value):
    """A value as `--set` takes it: true and false, numbers exact, lists in brackets."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(word, value)) + "]"
    return repr(float(value)) if isinstance(value, float) else str(value)


def run(deck, set=None, ranks=1, output=None, resume=False, options=(), check=True):
    """Runs a deck and returns its Results.

    deck      path of the deck
    set       {path in the deck: value}, as `--set PATH=VALUE`; a number with a dimension is a text with its unit
    ranks     of MPI
    output    folder of the results, results/<name of the deck> if not given; an earlier run's are replaced
    resume    go on with a run that was killed, or return what is there already
    options   further words of the command line, after `--` those of PETSc
    check     raise RunError also if a study could deliver nothing (exit code 3); its results can be read all the same
    """
    deck = pathlib.Path(deck)
    output = pathlib.Path(output) if output is not None else pathlib.Path("results") / deck.stem
    command = [str(program()), "run", str(deck), "-o", str(output), "--resume" if resume else "--force"]
    for path, value in (set or {}).items():
        command += ["--set", f"{path}={word(value)}"]
    if ranks > 1:
        command = ["mpirun", "-n", str(ranks), "--quiet", "--bind-to", "none", *command]
    done = subprocess.run([*command, *map(str, options)], env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                          stderr=subprocess.STDOUT, text=True, errors="replace", check=False)
    if done.returncode != 0 and (check or done.returncode != 3):
        said = [line for line in done.stdout.splitlines() if line.strip()]
        reason = next((line for line in said if line.startswith("whirl: ")), None) or \
            next((line for line in said if ": " in line and ": completed" not in line), said[-1] if said else "")
        raise RunError(f"{deck}: exit code {done.returncode}: {reason}", done.returncode, done.stdout)
    return read(output)
