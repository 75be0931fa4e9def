"""Running decks."""
import os
import pathlib
import shutil
import signal
import subprocess
import threading

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


def follow(command, progress, timeout):
    """Exit code and text of a command. Its lines go to `progress` as they come; after `timeout` seconds it is ended, and all that it started."""
    process = subprocess.Popen(command, env=environment(), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                               errors="replace", start_new_session=True)
    late = threading.Event()

    def end():
        late.set()
        os.killpg(process.pid, signal.SIGTERM)

    clock = threading.Timer(timeout, end) if timeout else None
    if clock:
        clock.start()
    try:
        lines = []
        for line in process.stdout:
            lines.append(line)
            if progress:
                progress(line.rstrip("\n"))
        process.wait()
    except BaseException:  # a notebook that is interrupted leaves no run behind
        os.killpg(process.pid, signal.SIGTERM)
        raise
    finally:
        if clock:
            clock.cancel()
    return process.returncode, "".join(lines), late.is_set()


def run(deck, set=None, ranks=1, output=None, resume=False, options=(), check=True, progress=None, timeout=None):
    """Runs a deck and returns its Results.

    deck      path of the deck
    set       {path in the deck: value}, as `--set PATH=VALUE`; a number with a dimension is a text with its unit
    ranks     of MPI
    output    folder of the results, results/<name of the deck> if not given; an earlier run's are replaced
    resume    go on with a run that was killed, or return what is there already
    options   further words of the command line, after `--` those of PETSc
    check     raise RunError also if a study could deliver nothing (exit code 3); its results can be read all the same
    progress  called with each line that the program writes; True prints them
    timeout   seconds after which the run is ended with RunError; `resume` goes on with it
    """
    deck = pathlib.Path(deck)
    output = pathlib.Path(output) if output is not None else pathlib.Path("results") / deck.stem
    command = [str(program()), "run", str(deck), "-o", str(output), "--resume" if resume else "--force"]
    for path, value in (set or {}).items():
        command += ["--set", f"{path}={word(value)}"]
    if ranks > 1:
        command = ["mpirun", "-n", str(ranks), "--quiet", "--bind-to", "none", *command]
    code, log, late = follow([*command, *map(str, options)], print if progress is True else progress, timeout)
    if late:
        raise RunError(f"{deck}: ended after {timeout:g} s; run it again with resume=True", code, log)
    if code != 0 and (check or code != 3):
        said = [line for line in log.splitlines() if line.strip()]
        reason = next((line for line in said if line.startswith("whirl: ")), None) or \
            next((line for line in said if ": " in line and ": completed" not in line), said[-1] if said else "")
        raise RunError(f"{deck}: exit code {code}: {reason}", code, log)
    return read(output)


def sweep(deck, over, of, output=None, **words):
    """The studies named in `of` for every combination of values: {path: [values]} in `over`. Returns the Study of the sweep.

        study = whirl.sweep("fan.yaml", {"bearings.*.geometry.clearance": ["60 um", "80 um"]}, of=["modes"])
        study.answer
    """
    grid = ", ".join(f"{path}: {word(list(values))}" for path, values in over.items())
    study = f"{{sweep: {{name: sweep, of: {word(list(of))}, grid: {{{grid}}}}}}}"
    return run(deck, set={**(words.pop("set", None) or {}), "studies+": study}, output=output, **words)["sweep"]
