#!/usr/bin/env python3
"""Scenes for ParaView: what XDMF names is there, shafts are solids of their radius about a centre that turns, bores lie about them."""
import contextlib
import io
import pathlib
import sys
import tempfile
import xml.etree.ElementTree as xml

import h5py
import numpy as np

sys.path.insert(0, str(pathlib.Path(__file__).parent))
import command  # noqa: E402, F401  finds the modules
import synthetic  # noqa: E402
from whirl_plot import scene  # noqa: E402
from whirl_plot.subject import Drawn  # noqa: E402


def check(what, holds, found=""):
    assert holds, f"{what}: {found}"


def loaded(item, folder):
    """The numbers behind a DataItem, of the shape and precision that it states."""
    file, name = item.text.split(":", 1)
    with h5py.File(folder / file) as data:
        assert data[name].shape == tuple(map(int, item.get("Dimensions").split())), item.text
        assert data[name].dtype.itemsize == int(item.get("Precision")), item.text
        return data[name][...]


def blocks_of(path):
    """Name of each block: [(time, corners)]."""
    found = {}
    for block in xml.parse(path).getroot().find("Domain/Grid"):
        steps = []
        for grid in block:
            corners = loaded(grid.find("Geometry/DataItem"), path.parent)
            assert corners.shape[:-1] == tuple(map(int, grid.find("Topology").get("Dimensions").split()))
            for field in grid.iter("Attribute"):
                assert loaded(field.find("DataItem"), path.parent).shape == corners.shape[:-1], field.get("Name")
            steps.append((float(grid.find("Time").get("Value")), corners))
        found[block.get("Name")] = steps
    return found


def results_in(folder):
    with h5py.File(folder / "results.h5", "w") as root:
        g = synthetic.study(root, "at service speed", "static")
        z = np.linspace(0, 2, 5)
        synthetic.put(g.create_group("nodes"), z=z, y=-1e-4 * np.sin(np.pi * z / 2), x=np.zeros(5))
        theta, axial = np.radians(np.linspace(-160, -20, 7)), np.linspace(-0.1, 0.1, 3)
        around = np.stack([0.05 * np.cos(theta)[:, None] + 0 * axial, 0.05 * np.sin(theta)[:, None] + 0 * axial, 0.5 + 0 * theta[:, None] + axial], axis=-1)
        synthetic.put(g.create_group("films/A & B/pad1"), theta=theta, z=axial, pressure=np.ones((7, 3)), node_xyz=around)
        m = synthetic.study(root, "mode shapes", "modes")
        bend = np.sin(np.pi * z / 2)
        synthetic.put(m.create_group("shapes"), z=z, speed=[100.0], mode=[1], frequency=[50.0], whirl=["forward"], log_decrement=[0.1],
                      x_real=[bend], x_imag=[0 * z], y_real=[0 * z], y_imag=[-bend])
        # About a mean far away: a forward circle once a period and a smaller backward one three times; then a line in x.
        c = synthetic.study(root, "whirl", "cycle_branch", parameter="speed", parameter_unit="rpm")
        angle = 2 * np.pi * np.arange(64)[:, None] / 64
        circles = 1e-5 * bend * (np.exp(1j * angle) + 0.25 * np.exp(-3j * angle)) + 2e-3 - 5e-3j
        synthetic.put(c.create_group("shaft"), z=z, what=["at", "flip"], parameter=[3600.0, 4093.66], period=[1 / 60, 2 / 65],
                      x=[circles.real, bend * np.cos(angle)], y=[circles.imag, 0 * bend * angle])
    # A hollow shaft with a disc of 0.2 m at its middle and an added mass along its second half.
    (folder / "resolved.yaml").write_text("rotor: {segments: [{length: 1 m, outer_mass_diameter: 0.2 m, inner_mass_diameter: 0.05 m}, {length: 1 m, outer_mass_diameter: 0.1 m, "
                                          "added_mass: 3 kg, added_mass_outer_diameter: 0.14 m}], discs: [{node: 2, mass: 9 kg, outer_diameter: 0.5 m, thickness: 0.2 m}]}\n")


with tempfile.TemporaryDirectory() as name:
    folder = pathlib.Path(name)
    results_in(folder)
    with contextlib.redirect_stdout(io.StringIO()) as out:
        check("the command", scene.main([name, "--phases", "8", "--reach", "0.1"]) == 0)
    files = [pathlib.Path(line) for line in out.getvalue().split("\n") if line]
    check("files", [f.name for f in files] == ["at service speed.scene.xdmf", "at service speed.scene.h5", "mode shapes.scene.xdmf", "mode shapes.scene.h5",
                                                  "whirl.scene.xdmf", "whirl.scene.h5"], files)

    (title, steps), = blocks_of(files[2]).items()
    check("name of a mode", title.startswith("mode 1 at speed 100 rad/s: 7.958 Hz"), title)
    check("a whole turn", np.allclose([time for time, _ in steps], np.arange(9) / 8))
    centres = np.array([corners[:, :-1].mean(axis=(0, 1)) for _, corners in steps])
    middle = np.argmin(np.abs(centres[0, :, 2] - 1.0))
    check("a forward mode turns from x to y by a circle of the reach", np.allclose(np.hypot(centres[:, middle, 0], centres[:, middle, 1]), 0.2, rtol=1e-5)
                  and np.allclose(np.diff(np.unwrap(np.arctan2(centres[:, middle, 1], centres[:, middle, 0]))), np.pi / 4, rtol=1e-5), centres[:, middle])
    radii = np.array([np.hypot(*(corners - centre)[..., :2].transpose(3, 0, 1, 2)) for centre, (_, corners) in zip(centres, steps)])
    check("edges", np.allclose(centres[0, :, 2], np.repeat([0, 0.9, 1, 1.1, 2], 2)[1:-1]), centres[0, :, 2])
    check("a solid of revolution of the deck's radii with its disc and added mass", np.allclose(radii[:, 1], [0.1, 0.1, 0.25, 0.25, 0.25, 0.25, 0.07, 0.07], rtol=1e-4), radii[0, 1])
    check("a bore as far as the shaft is hollow", np.allclose(radii[:, 0], [0.025] * 4 + [0] * 4, atol=1e-6), radii[0, 0])

    cycles = blocks_of(files[4])
    check("cycles asked for and at bifurcations", list(cycles) == ["motion at 3600 rpm, 60 Hz, drawn 1.6e+04 times", "period doubling (flip) at 4093.7 rpm, 32.5 Hz, drawn 0.2 times"],
          list(cycles))
    (whirl, line) = ([corners[:, :-1].mean(axis=(0, 1)) for _, corners in steps] for steps in cycles.values())
    angle = 2 * np.pi * np.arange(9) / 8
    wanted = 0.2 / 1.25 * (np.exp(1j * angle) + 0.25 * np.exp(-3j * angle))
    found = np.array([c[middle, 0] + 1j * c[middle, 1] for c in whirl])
    check("the shaft runs through its period about its mean position", np.allclose(found, wanted, atol=1e-6), found - wanted)
    check("a motion in one plane stays there", np.allclose([c[middle, :2] for c in line], np.stack([0.2 * np.cos(angle), 0 * angle], 1), atol=1e-6))

    static = blocks_of(files[0])
    check("sag and bores in one file", list(static) == ["sag, drawn 2e+03 times", "A & B pad1"], list(static))
    sag = static["sag, drawn 2e+03 times"][0][1][:, :-1].mean(axis=(0, 1))
    check("the sag reaches down a tenth of the length", np.isclose(sag[:, 1].min(), -0.2, rtol=1e-5))
    bore = static["A & B pad1"][0][1]
    check("a bore lies about the shaft as it is drawn", np.allclose(np.hypot(bore[..., 0], bore[..., 1] - (1999 * -1e-4 * np.sin(np.pi / 4))), 0.05, rtol=1e-5), bore[0, 0])

    with h5py.File(folder / "results.h5", "w") as root:
        synthetic.study(root, "empty", "motion")
    with contextlib.redirect_stderr(io.StringIO()) as err:
        check("nothing to show is said", scene.main([name]) == 1 and "sag, mode shapes" in err.getvalue(), err.getvalue())

print("the scenes hold the shafts")
