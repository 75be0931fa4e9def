#!/usr/bin/env python3
"""Reads src with clang-tidy (the checks of .clang-tidy, and the warnings of Clang) or with cppcheck. Fails if there is a finding.

lint.py tidy|cppcheck TOOL SOURCE BUILD [ROOM...]

Exit code 77, which CTest counts as skipped, where the tool or Clang is missing.
"""
import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

# What cppcheck 2.10 takes for faults: the comma of Eigen's initialisers, `requires` of C++20, references into containers and views
# whose size it does not follow, ranges::unique, tables of names.
CPPCHECK_OFF = ("constStatement", "identicalConditionAfterEarlyExit", "invalidContainerReference", "mismatchingContainerExpression",
                "CastIntegerToAddressAtReturn", "containerOutOfBounds", "missingIncludeSystem",
                # A vector behind a pointer of an array that is gone; arrays that have initialisers; a template lambda; a pointer
                # that is moved on from call to call.
                "danglingTempReference:*/mode_tables.cpp", "legacyUninitvar:*/element.cpp", "internalAstError:*/others.cpp",
                "uselessAssignmentPtrArg:*/thd_solver.cpp")

what, tool, source, build = sys.argv[1], sys.argv[2], pathlib.Path(sys.argv[3]).resolve(), pathlib.Path(sys.argv[4]).resolve()
rooms = sys.argv[5:]
for needed in (tool, "clang++") if what == "tidy" else (tool,):
    if not shutil.which(needed):
        print(f"skipped: there is no {needed}")
        sys.exit(77)


def read(words):
    return subprocess.run([str(word) for word in words], cwd=source, capture_output=True, text=True)


if what == "cppcheck":
    done = read([tool, "--quiet", "-j", os.cpu_count(), "--enable=warning,portability", "--std=c++20", "--language=c++", "-I", "include",
                 "-I", "src", "--inline-suppr", "--error-exitcode=1", *(f"--suppress={name}" for name in CPPCHECK_OFF),
                 *([source / "src" / room for room in rooms] or [source / "src"])])
    print(done.stdout + done.stderr or "cppcheck has no finding")
    sys.exit(done.returncode)

# Files of a room together, as GCC compiles them: their headers are read once.
done = read(["cmake", "--preset", "clang", "-DWHIRL_TESTS=OFF", "-B", build / "clang"])
assert done.returncode == 0, done.stdout + done.stderr
commands = json.loads((build / "clang/compile_commands.json").read_text(encoding="utf-8"))
files = sorted({c["file"] for c in commands}, key=lambda name: -os.path.getsize(name))
files = [name for name in files if not rooms or any(re.search(rf"(/src/|/){room}(/|_\d+\.cpp)", name) for room in rooms)]
assert files, "no file"
faults = 0
with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
    for name, done in zip(files, pool.map(lambda name: read([tool, "-p", build / "clang", "--quiet", name]), files)):
        if done.returncode:
            faults += 1
            print(done.stdout or done.stderr)
print(f"{len(files)} files or batches of files, {faults} with findings")
sys.exit(1 if faults else 0)
