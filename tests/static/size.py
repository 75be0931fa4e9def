#!/usr/bin/env python3
"""Counts what the redesign of the linear algebra is to make smaller, and prints it beside the budgets. Fails only if a file of its
own lists is gone: a figure that grows is a fact to explain, not an error.

size.py SOURCE

Rules, written before the work began:
- lines: all lines of .cpp and .hpp below src and include; by room, src/ROOM and include/whirl/ROOM together.
- own linear algebra: the files of ALGEBRA below. A file is in it if it factorises, solves, preconditions or multiplies the
  equations of something else, whatever room it stands in; Newton's method, branches, physics and studies are not in it.
- inverses: classes of these files and of CORE that declare one of SOLVES. An interface (a class with a pure one) is not counted,
  neither is a wrapper of one library call (WRAPPERS).
- choosers: files that compare two counts of cost:: or read an option of PETSc by which a way to solve is chosen.
- casts: dynamic_cast to a class of solve or problem, and in the rooms solve, spectral and transient to anything.
- refusals: require(false.
- long files: more than 400 lines.
"""
import pathlib
import re
import sys

root = pathlib.Path(sys.argv[1] if len(sys.argv) > 1 else ".").resolve()
files = sorted(p for folder in ("src", "include") for p in (root / folder).rglob("*.?pp"))
text = {str(p.relative_to(root)): p.read_text() for p in files}

# Stems of files, wherever they stand: a file that moves stays in the list, one that ends leaves it.
ALGEBRA = """
band_lu line_solver ring_preconditioner gas_inverse lent_lu film_matrix stencil pack
direct_inverse film_inverse
part_factors frequency_hub frequency_inverse frequency_linearise frequency_part frequency_resolvent frequency_transfer
anchored_hub hub_lu port_elimination port_krylov port_layout port_maker port_matrix matrix_rows thin local_part stored spread_point rational_fit
scaled_point thin_blocks linear_part thin_interval spread_interval interval own_block own_blocks own_shape small_blocks pencil
time_modes mode_composition mode_system dense_composition sweep_composition sweep_system composition cycle_matrix orbit_problem
film_march dominant_subspace spread_subspace
runge_kutta dense_stage structured_rate structured_stage sparse_stage thin_stage
bordered_monodromy nearest_eigenvalues equations
entry_stream sparse_lu pencil_lu pivoted_lu dense_lu direct_solver least_squares symmetric shell
""".split()
WRAPPERS = {"DenseLu", "SparseLu", "PivotedLu"}
SOLVES = {"solve", "solve_transposed", "solve_adjoint", "solve_at", "apply", "apply_at", "eliminate", "substitute", "precondition", "factorise", "compose"}
BUDGET = {"lines of C++": 92800, "own linear algebra, lines": 9500, "own linear algebra, classes that invert": 16, "choosers": 1, "casts of solvers": 0,
          "require(false": 0, "files of more than 400 lines": 0}


def lines(t):
    return t.count("\n")


def body_of(t, begin):
    """Text between the braces after `begin`, without what stands in braces within."""
    depth, flat = 1, []
    for i in range(begin, len(t)):
        depth += (t[i] == "{") - (t[i] == "}")
        if depth == 0:
            break
        if depth == 1:
            flat.append(t[i])
    return "".join(flat)


def inverses(t):
    t = re.sub(r"//[^\n]*", "", t)
    found = set()
    for m in re.finditer(r"\b(?:class|struct)\s+([A-Z]\w*)(?:<[^>{;]*>)?(?:\s+final)?\s*(?::[^{;()]*)?\{", t):
        flat = body_of(t, m.end())
        declared = [d for d in re.finditer(r"\b(\w+)\s*\([^()]*(?:\([^()]*\)[^()]*)*\)([^;{(]{0,40})", flat) if d.group(1) in SOLVES]
        if declared and not any("= 0" in d.group(2).split("\n")[0] for d in declared):
            found.add(m.group(1))
    return found - WRAPPERS


def stem(path):
    return pathlib.Path(path).stem


algebra = {p: t for p, t in text.items() if stem(p) in ALGEBRA and p.split("/")[-2] not in ("study",) and "/study/" not in p}
rooms = {}
for p, t in text.items():
    parts = p.split("/")
    room = parts[1] if parts[0] == "src" else parts[2]
    rooms[room] = rooms.get(room, 0) + lines(t)
found = set().union(*(inverses(t) for t in algebra.values()))
compare = re.compile(r"cost::\w+\([^;]*[<>]\s*\n?\s*(?:core::|solve::)?cost::\w+\(")
option = re.compile(r"PetscOptions(?:GetString|GetInt|GetReal|GetBool|HasName)\(")
choosers = sorted(p for p, t in text.items() if compare.search(t) or (option.search(t) and "/core/" not in p))
casts = sum(len(re.findall(r"dynamic_cast<(?:const )?(?:solve|problem)::", t)) for t in text.values())
casts += sum(len(re.findall(r"dynamic_cast<(?!(?:const )?(?:solve|problem)::)", t)) for p, t in text.items() if p.split("/")[1] in ("solve", "spectral", "transient"))
figures = {
    "lines of C++": sum(rooms.values()),
    "own linear algebra, lines": sum(lines(t) for t in algebra.values()),
    "own linear algebra, classes that invert": len(found),
    "choosers": len(choosers),
    "casts of solvers": casts,
    "require(false": sum(t.count("require(false") for t in text.values()),
    "files of more than 400 lines": sum(lines(t) > 400 for t in text.values()),
}
print(f"{'':42s}{'today':>8s}{'budget':>8s}")
for name, value in figures.items():
    print(f"{name:42s}{value:8d}{BUDGET[name]:8d}")
print("lines by room: " + ", ".join(f"{room} {n}" for room, n in sorted(rooms.items(), key=lambda r: -r[1])))
print("classes that invert: " + ", ".join(sorted(found)))
print("choosers: " + ", ".join(choosers))
print("long files: " + ", ".join(f"{p} {lines(t)}" for p, t in sorted(text.items()) if lines(t) > 400))
sys.exit(0 if files else 1)
