#!/usr/bin/env python3
"""Truncated, empty and foreign results: `plot`, `report` and the module say one sentence, exit code 2, no traceback."""
import pathlib
import shutil
import subprocess
import sys
import tempfile

import h5py

ROOT = pathlib.Path(__file__).parents[2]
sys.path[:0] = [str(pathlib.Path(__file__).parent), str(ROOT / "scripts")]
import command  # noqa: E402
import synthetic  # noqa: E402

import whirl  # noqa: E402


def cut(path, share):
    data = path.read_bytes()
    path.write_bytes(data[:int(share * len(data))])


def foreign(folder):
    with h5py.File(folder / "results.h5", "w") as root:
        root["temperature"] = [1.0, 2.0]


def foreign_studies(folder):
    with h5py.File(folder / "results.h5", "w") as root:
        root["studies"] = [1.0, 2.0]


def scrambled(folder):
    """The name of the file format stays, what comes after is noise."""
    data = bytearray((folder / "results.h5").read_bytes())
    data[48:4096] = bytes((37 * k) % 251 for k in range(4096 - 48))
    (folder / "results.h5").write_bytes(bytes(data))


CASES = {
    "no results": lambda f: (f / "results.h5").unlink(),
    "an empty file": lambda f: (f / "results.h5").write_bytes(b""),
    "half a file": lambda f: cut(f / "results.h5", 0.5),
    "nearly a whole file": lambda f: cut(f / "results.h5", 0.99),
    "a file of text": lambda f: (f / "results.h5").write_text("speed,amplitude\n1,2\n"),
    "another program's file": foreign,
    "studies that are none": foreign_studies,
    "noise": scrambled,
    "half a summary": lambda f: cut(f / "summary.json", 0.5),
    "an empty summary": lambda f: (f / "summary.json").write_text(""),
    "another summary": lambda f: (f / "summary.json").write_text("[1, 2]"),
    "a summary of something else": lambda f: (f / "summary.json").write_text('{"studies": [{"speed": 1}]}'),
    "a deck that is none": lambda f: (f / "resolved.yaml").write_text("a: [1, 2\n"),
}
with tempfile.TemporaryDirectory() as name:
    whole = pathlib.Path(name) / "whole"
    synthetic.make(whole)
    for words, damage in CASES.items():
        folder = pathlib.Path(name) / "x"
        shutil.copytree(whole, folder)
        damage(folder)
        for script in ("plot", "report"):
            done = command.call(script, folder, draw=())
            said = done.stderr.strip()
            assert done.returncode == 2, f"{script} of {words}: exit {done.returncode}\n{said}"
            assert said and "\n" not in said and "Traceback" not in said and len(said) < 400, f"{script} of {words} says\n{said}"
            assert said.startswith(f"{script}: ") and "x/" in said, f"{script} of {words} says\n{said}"
        try:
            whirl.read(folder).deck
        except whirl.Error:
            shutil.rmtree(folder)
            continue
        sys.exit(f"FAILED: the module reads {words}")

with tempfile.TemporaryDirectory() as name:
    for script in ("plot", "report"):
        done = subprocess.run([str(ROOT / "scripts" / script), f"{name}/none"], capture_output=True, text=True)
        assert done.returncode == 2 and done.stderr.count("\n") == 1 and done.stderr.startswith(f"{script}: "), done.stderr
print("one sentence each")
