#!/usr/bin/env python3
"""docs/options.md holds the two tables of src/core/plan.cpp: options by which a way to solve is chosen, and prefixes of solvers.
No other file reads an option of PETSc, but core/from_options.cpp, and every prefix of the sources is in the table.

options.py SOURCE [--write]     --write renews the page
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
page, plan = root / "docs/options.md", root / "src/core/plan.cpp"
text = plan.read_text()


def rows(name):
    body = re.search(name + r"\[\] = \{(.*?)\n\};", text, re.S).group(1)
    # Text that the formatter has cut is one.
    body = re.sub(r'"\s*\n\s*"', "", body)
    return [re.findall(r'"((?:[^"\\]|\\.)*)"', row) for row in re.findall(r"\{([^{}]*)\}", body)]


def table(head, lines):
    return "\n".join(["| " + " | ".join(head) + " |", "|---" * len(head) + "|", *("| " + " | ".join(line) + " |" for line in lines)])


def code(word):
    return f"`{word}`" if word else ""


prefixes = rows("solvers")
written = f"""# Options of the solvers
What follows `--` on the command line goes to PETSc and SLEPc: `whirl run deck.yaml -- -modes_by transfer`.
`tests/static/options.py` writes this page from `src/core/plan.cpp`.

## Ways to solve
The program counts what each way costs and takes the cheaper one.
It says in the results of a study what it has taken. These options take another one.

{table(("option", "otherwise", "chooses"), [(code(a), b, c) for a, b, c in rows("table")])}

## Prefixes
Each solver reads the options of its kind with a prefix of its own: `-newton_snes_monitor`.
A tolerance may be tighter than the tolerance of the program, not looser.

{table(("prefix", "solver"), [(code(a), b) for a, b in prefixes])}
"""
if "--write" in sys.argv:
    page.write_text(written)
errors = [] if page.exists() and page.read_text() == written else ["docs/options.md is not what src/core/plan.cpp says: tests/static/options.py . --write"]
known = {name for name, _ in prefixes}
reads = re.compile(r"PetscOptions(?:GetString|GetInt|GetReal|GetBool|HasName)\(")
sets = re.compile(r'(?:SetOptionsPrefix\([^;]*?|make_direct_solver\([^;]*?|make_solver\(|PortKrylov>?\([^;]*?|prefix = |make_krylov\([^;]*?\{)"([a-z_]+_)"', re.S)
for path in (p for folder in ("src", "include") for p in sorted((root / folder).rglob("*.?pp"))):
    source = path.read_text()
    if reads.search(source) and path not in (plan, root / "src/core/from_options.cpp"):
        errors.append(f"{path.relative_to(root)} reads an option of PETSc: core/plan is the place")
    errors += [f"{path.relative_to(root)}: the prefix {word} is not in the table of core/plan" for word in sets.findall(source) if word not in known]
print("\n".join(errors))
sys.exit(1 if errors else 0)
