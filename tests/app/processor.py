#!/usr/bin/env python3
"""Holds the program of a Debian package against the processors it is made for: any x86-64, SSE2 and no more.

processor.py PACKAGE SOURCE

Every instruction of the program is looked up by its name. A processor of 2006 (Core 2, emulated by qemu) then computes a deck.
Exit code 77, which CTest counts as skipped, where a tool is missing or the processor is another one.
"""
import json
import os
import pathlib
import platform
import re
import shutil
import subprocess
import sys
import tempfile

# Extensions beyond SSE2, as objdump prints them. Left out: `tzcnt`, which older processors execute as `bsf`. GCC writes it where
# both give the same.
NEWER = re.compile(
    r"v(?!err|erw|mcall)\w+"  # AVX to AVX-512
    r"|f[xy]?n?m(add|sub)\d*[ps][ds]|fisttp\w*|addsubp[sd]|h(add|sub)p[sd]|lddqu|mov(d|sh|sl)dup"  # FMA4, SSE3
    r"|pshufb|ph(add|sub)\w+|pmaddubsw|pmulhrsw|psign[bwd]|palignr|pabs[bwd]"  # SSSE3
    r"|p?blend\w+|round[ps][sd]|dpp[sd]|(insert|extract)ps|p(extr|insr)[bdq]|p(min|max)(sb|sd|uw|ud)|pmul(dq|ld)|packusdw"  # SSE4
    r"|pmov[sz]x\w+|ptest|mpsadbw|phminposuw|pcmpeqq|movntdqa|pcmpgtq|pcmp[ei]str[im]|crc32\w*|(popcnt|lzcnt)[wlq]?"
    r"|cmpxchg16b|andn|bextr|bls(i|r|msk)|bzhi|pdep|pext|mulx|rorx|sarx|sh[lr]x|ad[co]x|movbe\w*|aes\w+|pclmul\w+|sha(1|256)\w+"
    r"|rdrand|rdseed|k(and|andn|mov|not|or|ortest|shift[lr]|test|unpck|xnor|xor)[bwdq]+")
KNOWN = {"vfmadd231pd": True, "popcnt": True, "pshufb": True, "roundsd": True, "haddpd": True, "mulx": True, "pinsrd": True, "movddup": True, "kmovq": True,
         "movapd": False, "tzcnt": False, "mulsd": False, "cvttsd2si": False, "pextrw": False, "pminub": False, "andnpd": False, "shld": False}


def skip(why):
    print("skipped:", why)
    sys.exit(77)


package, source = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
if platform.machine() != "x86_64":
    skip(f"this is no x86-64 but {platform.machine()}")
for tool in ("objdump", "dpkg-deb"):
    if not shutil.which(tool):
        skip(f"there is no {tool}")
packages = sorted(package.glob("whirl_*.deb"), key=os.path.getmtime) if package.is_dir() else [package]
wrong = [name for name, newer in KNOWN.items() if bool(NEWER.fullmatch(name)) is not newer]
assert not wrong, f"the list of instructions takes {wrong} for what they are not"

with tempfile.TemporaryDirectory() as folder:
    work = pathlib.Path(folder)
    subprocess.run(["dpkg-deb", "-x", packages[-1], work / "tree"], check=True)
    program = work / "tree/usr/bin/whirl"
    names, where = {}, ""
    listing = subprocess.Popen(["objdump", "-d", "--no-show-raw-insn", program], stdout=subprocess.PIPE, text=True)
    for line in listing.stdout:
        words = line.partition("\t")[2].split()
        if words:
            names.setdefault(words[0], line.strip())
    assert listing.wait() == 0 and "mulsd" in names, "objdump shows no instructions"
    newer = {name: line for name, line in names.items() if NEWER.fullmatch(name)}
    print(f"{len(names)} different instructions in {packages[-1].name}, {len(newer)} beyond SSE2")
    for name, line in sorted(newer.items()):
        print("!", name, "first at", line)
    if newer:
        sys.exit(1)

    if not shutil.which("qemu-x86_64"):
        skip("no qemu-x86_64 (Debian: qemu-user) to run it on an older processor")
    deck = source / "inputs/tutorial/6_own_machine.yaml"
    environment = {**os.environ, "OMPI_MCA_pml": "ob1", "OMPI_MCA_ess_singleton_isolated": "1", "OPENBLAS_NUM_THREADS": "1", "OMP_NUM_THREADS": "1"}
    answers = []
    for launcher in ([], ["qemu-x86_64", "-cpu", "core2duo"]):
        out = work / f"out{len(answers)}"
        done = subprocess.run([*launcher, program, "run", deck, "-o", out, "--set", "studies=[{static: {name: place, speed: 3000 rpm}}]", "bars=none"],
                              env=environment, capture_output=True, text=True)
        assert done.returncode == 0, f"{' '.join(launcher) or 'this processor'}: exit code {done.returncode}\n{done.stdout}{done.stderr}"
        values = json.loads((out / "summary.json").read_text(encoding="utf-8"))["studies"][0]["values"]
        answers.append({name: (value["value"], value["unit"]) for name, value in values.items()})
    here, old = answers
    assert here and here.keys() == old.keys(), "the answers have other names"
    scale = {}  # of the numbers of one unit: a force that vanishes has the rounding errors of the others
    for value, unit in here.values():
        scale[unit] = max(scale.get(unit, 0), abs(value))
    largest = max(abs(old[name][0] - value) / scale[unit] for name, (value, unit) in here.items() if scale[unit])
    print(f"{len(here)} answers of a Core 2 differ by {largest:.1e} at most of the largest number in the same unit")
    assert largest < 1e-8
