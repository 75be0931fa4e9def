#!/usr/bin/env python3
"""Installs into a folder and looks at it from outside the sources: program, man page, decks, Python modules and their commands; pip.

install.py CMAKE BUILD SOURCE
"""
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

cmake, build, source = sys.argv[1], pathlib.Path(sys.argv[2]).resolve(), pathlib.Path(sys.argv[3]).resolve()
version = (source / "docs/CITATION.cff").read_text(encoding="utf-8").split("\nversion: ")[1].split()[0]
failures = []


def check(what, good, detail=""):
    print("  " if good else "! ", what, detail if not good else "")
    if not good:
        failures.append(what)


def run(*words, **more):
    return subprocess.run([str(w) for w in words], capture_output=True, text=True, cwd=work, env=environment, **more)


with tempfile.TemporaryDirectory() as name:
    work, prefix = pathlib.Path(name), pathlib.Path(name) / "prefix"
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": "1"}
    for variable in ("PYTHONPATH", "WHIRL_PROGRAM"):
        environment.pop(variable, None)
    done = run(cmake, "--install", build, "--prefix", prefix, "--strip")
    check("cmake --install", done.returncode == 0, done.stderr)
    environment["PATH"] = f"{prefix / 'bin'}:{environment['PATH']}"

    done = run("whirl", "--version")
    check("whirl --version", done.stdout.strip() == f"whirl {version}", done.stdout + done.stderr)
    page = (prefix / "share/man/man1/whirl.1").read_text(encoding="utf-8")
    check("the man page has the version", f"Whirl {version}" in page and "@" not in page)
    for command in ("run", "check", "list", "describe", "schema"):
        check(f"the man page has {command}", f".B {command}\n" in page and run("whirl", command, "--help").returncode == 0)
    check("the front page is there", (prefix / "share/doc/whirl/README.md").is_file())
    check("the tutorial is there", (prefix / "share/doc/whirl/docs/tutorial/README.md").is_file())

    done = run(sys.executable, source / "tests/static/links.py", prefix / "share/doc/whirl")
    check("the links of the installed pages", done.returncode == 0, done.stdout)

    deck = prefix / "share/whirl/inputs/tutorial/2_unbalance.yaml"
    example = f"""
import importlib.metadata, sys
sys.path.insert(0, {str(prefix / "lib/python3/dist-packages")!r})
import whirl
assert whirl.__file__.startswith({str(prefix)!r}), whirl.__file__
assert importlib.metadata.version("whirl") == {version!r}
run = whirl.run({str(deck)!r}, output="out", set={{"bars": "none"}})
assert run.summary["version"] == {version!r}
print(round(run.values("response")["unbalance.disc.mass"].value, 2))
"""
    done = run("/usr/bin/python3", "-c", example)
    check("a deck of the installation by whirl.run", done.stdout.strip() == "66.05", done.stdout + done.stderr)
    done = run("whirl-plot", "out", "--formats", "png")
    check("whirl-plot", done.returncode == 0 and (work / "out/response.response.png").is_file(), done.stderr)

    for command in ("whirl-plot", "whirl-report", "whirl-scene"):
        done = run(command, "--help")
        check(f"{command} --help", f"usage: {command} " in done.stdout + done.stderr, done.stdout + done.stderr)

    # From the sources by pip, without network.
    shutil.copytree(source / "scripts", work / "scripts")
    shutil.copy(source / "CMakeLists.txt", work)
    done = run("/usr/bin/python3", "-m", "pip", "install", "--no-index", "--no-deps", "--target", work / "pip", work / "scripts")
    check("pip install ./scripts", done.returncode == 0, done.stdout + done.stderr)
    done = run("/usr/bin/python3", "-m", "pip", "install", "--no-index", "--dry-run", "--break-system-packages", work / "scripts")
    check("Debian's packages are all it depends on", done.returncode == 0, done.stdout + done.stderr)
    example = "import importlib.metadata, sys; sys.path.insert(0, 'pip'); import whirl, whirl_plot; print(whirl.__file__, importlib.metadata.version('whirl'))"
    done = run("/usr/bin/python3", "-c", example)
    check("its modules and version", done.stdout.split()[-1:] == [version] and "/pip/" in done.stdout, done.stdout + done.stderr)
    check("its commands", (work / "pip/bin/whirl-report").is_file())
    for folder in (work / "pip", prefix / "lib/python3/dist-packages"):
        check(f"the scripts of charts in {folder.name}", all((folder / "whirl_plot" / f).is_file() for f in ("live_base.js", "live_shapes.js", "live.js")))

sys.exit(1 if failures else 0)
