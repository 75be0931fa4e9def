#!/usr/bin/env python3
"""Checks that clang-format would leave every C++ file as it is."""
import pathlib
import subprocess
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
tool = sys.argv[2] if len(sys.argv) > 2 else "clang-format"
files = sorted(str(p.relative_to(root)) for folder in ("include", "src", "tests") for p in (root / folder).rglob("*")
               if p.suffix in (".cpp", ".hpp", ".h"))
done = subprocess.run([tool, "--dry-run", "-Werror", "--ferror-limit=1", *files], cwd=root, capture_output=True, text=True)
lines = [line for line in done.stderr.splitlines() if "error:" in line]
print("\n".join(lines) or done.stderr or f"{len(files)} files are formatted")
sys.exit(done.returncode if files else 1)
