"""A results folder with every kind of study, made up so that each picture has something of all it can show."""
import functools
import json
import pathlib
import tempfile

import h5py
import numpy as np

FILES = ["results.h5", "summary.json"]
NAMES = ["B1", "B2", "B3", "B4", "B5"]
CLEARANCE = np.array([180e-6, 220e-6, 300e-6, 300e-6, 150e-6])
RPM = np.pi / 30


def put(group, **datasets):
    for name, values in datasets.items():
        values = np.asarray(values)
        if values.dtype.kind in "US":
            group.create_dataset(name, data=values.astype(object), dtype=h5py.string_dtype())
        else:
            data = group.create_dataset(name, data=values)
            # As the program stores them: every dataset names its places.
            if values.ndim > 1 and values.shape[-1] == len(NAMES):
                data.attrs["labels" if values.ndim == 2 else f"labels_{values.ndim - 1}"] = NAMES


def study(root, name, kind, status="completed", **attributes):
    group = root.create_group(f"studies/{name}")
    group.attrs.update({"kind": kind, "status": status, "title": name, **attributes})
    return group


def static(root):
    g = study(root, "at service speed", "static")
    z = np.linspace(0, 32, 185)
    put(g.create_group("nodes"), z=z, y=4e-3 * (z / 16 - 1)**2 - 0.2e-3 * np.cos(z), x=2e-5 * np.sin(z / 5))
    put(g.create_group("bearings"), name=NAMES, x=CLEARANCE * [0.2, 0.3, 0.45, 0.4, 0.1], y=-CLEARANCE * [0.5, 0.7, 0.5, 0.6, 0.4],
        clearance=CLEARANCE, preload=[0, 0, 0.5, 0.5, 0],
        offset=[0, 0, 1e-4, 0, 0], arc=np.radians([60, 160, 160, 160, 60]), load=[12418, 47830, 213407, 128292, 11698], node=[6, 52, 80, 115, 180])
    for name, pads in (("B1", [(-120, -60)]), ("B3", [(-165, -15), (15, 165)])):
        for k, (start, stop) in enumerate(pads):
            theta, axial = np.radians(np.linspace(start, stop, 61)), np.linspace(-0.1, 0.1, 17)
            h = 3e-4 * (1 - 0.6 * np.cos(theta + np.radians(65)))[:, None] * np.ones(17)
            s = (theta - theta[0]) / (theta[-1] - theta[0])
            p = (5e6 if k == 0 else 2e5) * np.maximum(np.sin(np.pi * np.minimum(1, 1.3 * s)), 0)[:, None] * (1 - (axial / 0.1)**2)
            put(g.create_group(f"films/{name}/pad{k + 1}"), theta=theta, z=axial, pressure=p, thickness=h)


def thd(root):
    """A bore of 30 mm at eccentricity 0.5 with its bush and a hollow shaft, warm in the middle."""
    g = study(root, "hot", "thd", parameter="speed", parameter_unit="rad/s")
    theta, z, zeta = np.linspace(0, 2 * np.pi, 48, endpoint=False), np.linspace(-0.015, 0.015, 17), (np.arange(8) + 0.5) / 8
    warm = 60 + 8 * np.cos(theta - 2)[None, :] * np.cos(100 * z)[:, None]
    thickness = 2e-5 * (1 - 0.5 * np.cos(theta))[None, :] * np.ones((17, 1))
    pressure = 1e5 + 3e5 * np.exp(np.cos(theta) - 1)[None, :] * (1 - (z / 0.015)**2)[:, None]
    r_bush, r_journal = 0.015 + 0.01 * (np.arange(6) + 0.5) / 6, np.append(0.005 + 0.01 * (np.arange(6) + 0.5) / 6, 0.015)
    z_journal = np.concatenate((np.linspace(-0.035, -0.016, 9), z, np.linspace(0.018, 0.065, 20)))
    film = g.create_group("film")
    put(film, theta=theta, z=z, radius=0.015, speed=1e4, thickness=thickness, pressure=pressure, bush_wall=300 + warm, journal_wall=358 * np.ones((17, 48)),
        temperature=300 + warm[..., None] + 10 * (zeta * (1 - zeta)), flow_around=1e-3 * np.ones((17, 48)), flow_along=1e-2 * z[:, None] * np.ones(48),
        viscosity=1.8e-5 * (1 + warm / 300)**0.7, density=pressure / 286.7 / (300 + warm), conductivity=0.026 * np.ones((17, 48)),
        heat_bush=2e4 * np.ones((17, 48)), heat_journal=1e3 * (warm - 60), dissipation=4e4 / (1 - 0.5 * np.cos(theta))[None, :] * np.ones((17, 1)))
    # Air at half of the surface's speed but for what pressure does around and along.
    put(film, velocity_around=75 - 40 * np.sin(theta)[None, :] * (1 - (z / 0.015)**2)[:, None], velocity_along=2e3 * z[:, None] * np.ones(48))
    put(g.create_group("orifices"), theta=np.pi / 4 * np.arange(8), z=np.zeros(8), diameter=2e-4 * np.ones(8), mass_flow=1e-5 * np.ones(8))
    for name, unit in (("viscosity", "Pa s"), ("density", "kg/m^3"), ("conductivity", "W/(m K)")):
        film[name].attrs["unit"] = unit
    put(g.create_group("bush"), theta=theta, z=z, r=r_bush, r_faces=np.linspace(0.015, 0.025, 7), temperature=300 + warm[..., None] * (1 - 10 * (r_bush - 0.015)))
    put(g.create_group("journal"), z=z_journal, r=r_journal, r_faces=np.append(np.linspace(0.005, 0.015, 7), 0.015), temperature=300 + 58 * np.exp(-np.abs(z_journal / 0.03))[:, None] * (1 + 0 * r_journal))
    put(g.create_group("iterations"), field=["temperature"], residual=10.0 ** -np.arange(7)[:, None])
    put(g.create_group("effective"), same=["load", "power_loss"], temperature=[355.0, 361.0], load_error=[0, 0.012], power_loss_error=[-0.03, 0], mass_flow_error=[0.004, -0.002])
    t = np.linspace(250, 500, 6)
    put(g.create_group("properties"), temperature=t, clearance=1.5e-5 * (1 + 6.5e-3 * (t - 275)), viscosity=1.8e-5 * (t / 300)**0.7, density=353 / t)
    put(g.create_group("meshes"), cells=[1e4, 8e4, 6.4e5], energy_residual=[1e-9, 0, 3e-10],
        **{"temperature.minimum": [294, 293, 291], "temperature.mean": [301.3, 301.25, 301.23], "temperature.maximum": [305.2, 305.4, 306]})
    put(g.create_group("budget"), parameter=[0, 2000, 10000], power_loss=[0, 3, 69.7], dissipation=[10.5, 13.4, 79.8], expansion=[-10.5, -10.4, -10.1],
        heat_bush=[0, 1.5, 33.9], heat_journal=[0, 1.5, 35.7], enthalpy=[0, 0, 0.1], residual=[0, 1e-9, 1e-9])


def modes(root):
    g = study(root, "modes", "modes", speed_unit="rpm")
    speed = np.linspace(500, 7000, 40) * RPM
    rows = []
    for mode, (f, gyro, decay) in enumerate([(72, 1.0, 0.02), (81, -2.0, 0.9), (105, 3.0, 0.12), (147, -6.0, 0.3), (230, 18.0, 0.2), (330, -20, 0.05)], 1):
        for w in speed:
            frequency = f + gyro * w / 400
            decrement = decay * (1 - (w / 526)**3) if mode == 1 else decay
            rows.append((w, mode, frequency, -decrement * frequency / 6.28, decrement, decrement / np.pi,
                         "mixed" if mode == 3 and w < 300 else "forward" if gyro > 0 else "backward"))
    columns = list(zip(*rows))
    put(g.create_group("spectrum"), **dict(zip(("speed", "mode", "frequency", "damping_real", "log_decrement", "stability_factor", "whirl"), columns)))
    put(g.create_group("critical"), speed=[72.2, 80.6, 106, 145, 241], mode=[1, 2, 3, 4, 5])
    z = np.linspace(0, 32, 185)
    shape = np.array([np.sin((k + 1) * np.pi * z / 32) for k in range(6)])
    turn = np.exp(1j * np.linspace(0.2, 2.0, 6))[:, None]
    x, y = shape * turn * 0.7 * (1 + 0.3j), shape * turn * 1j
    put(g.create_group("shapes"), speed=377.0, z=z, x_real=x.real, x_imag=x.imag, y_real=y.real, y_imag=y.imag,
        frequency=[72.9, 79.1, 107.8, 141.3, 247, 311])
    put(g.create_group("bearings"), name=NAMES, z=[1.2, 8, 14, 22, 31])


def response(root):
    g = study(root, "generator pair", "unbalance_response", speed_unit="rpm")
    w = np.linspace(300, 6000, 300) * RPM

    def receptance(stiff, damp, force):
        return sum(f * w**2 / (k**2 - w**2 + 2j * damp * k * w) for k, f in zip(stiff, force))

    def block(scales):
        x = np.stack([s * 1e-6 * receptance([270, 520], 0.06, [1.0, 0.3]) for s in scales], axis=1)
        y = np.stack([-1j * s * 1e-6 * receptance([281, 540], 0.04, [2.0, -0.4]) for s in scales], axis=1)
        major = np.sqrt(0.5 * (abs(x)**2 + abs(y)**2 + abs(x**2 + y**2)))
        minor = np.sqrt(np.maximum(0, abs(x)**2 + abs(y)**2 - major**2))
        x[60] = y[60] = major[60] = minor[60] = np.nan  # a speed without a response
        return {"x_amplitude": abs(x), "x_phase": np.angle(x), "y_amplitude": abs(y), "y_phase": np.angle(y),
                "semi_major": major, "semi_minor": minor}

    put(g.create_group("response"), speed=w, node=[120, 140], **block([3, 2.5]), unstable_count=2 * (w > 5000 * RPM), answer=1 - (((w > 2800 * RPM) & (w < 3000 * RPM)) | (w == w[60])))
    put(g.create_group("bearings"), name=NAMES, **block([0.3, 0.6, 1.2, 1.0, 0.7]))


def equilibria(root):
    g = study(root, "balanced", "equilibrium_branch", parameter="speed", parameter_unit="rpm")
    p = np.linspace(500, 8000, 70)
    e = 0.9 / (1 + p[:, None] / 2500)
    angle = np.radians(-90) + np.arccos(np.clip(e, 0, 1))
    growth = (p - 5025) * 2e-3 - 3e-8 * (p - 5025)**2
    put(g.create_group("branch"), parameter=p, stable=(growth < 0).astype(int), unstable_count=2 * (growth > 0), step=np.full(70, 100.0),
        x=CLEARANCE * e * np.cos(angle), y=CLEARANCE * e * np.sin(angle), leading_real=growth, leading_imag=85 + 0 * p)
    put(g.create_group("bifurcations"), type=["hopf"], parameter=[5025.0], uncertainty=[12.0])
    put(g.create_group("bearings"), name=NAMES, clearance=CLEARANCE, preload=[0, 0, 0.5, 0.5, 0])


def cycles(root, name, grade, fold):
    g = study(root, name, "cycle_branch", "ended at 5900 rpm: the film is broken through at B3" if fold else "completed",
              parameter="speed", parameter_unit="rpm", unbalance="gen_pair")
    s = np.linspace(0, 1, 140)
    p = 1000 + 5000 * s + (fold * 9000 * np.exp(-((s - 0.55) / 0.07)**2) * (s - 0.55) * -10 / 5)
    size = grade * (6e-6 + 35e-6 * np.exp(-(((s - 0.5) / 0.1) if fold else (p - 2700) / 500)**2) + 60e-6 * np.maximum(0, s - 0.75)**1.5)
    size = np.minimum(size[:, None] * [0.5, 1, 0.7, 0.4, 1.1], 0.45 * CLEARANCE)
    e = 0.8 / (1 + p[:, None] / 2500)
    xm, ym = CLEARANCE * e * 0.5, -CLEARANCE * e * 0.8
    flips, ns = (4115, 4471), 5057
    unstable = np.where((p > flips[0]) & (p < flips[1]), 1, np.where(p > ns, 2, 0))
    if fold:
        slope = np.gradient(p, s)
        unstable = np.where(slope < 0, 1, unstable)
    put(g.create_group("branch"), parameter=p, period=60 / p, stable=(unstable == 0).astype(int), unstable_count=unstable,
        x_max=xm + size, x_min=xm - 0.9 * size, y_max=ym + 1.2 * size, y_min=ym - size)
    mu = np.zeros((140, 6), complex)
    mu[:, 0] = 0.4 + 0.66 * (p - 1000) / (ns - 1000)
    mu[:, 0] = np.minimum(abs(mu[:, 0]), 1.15) * np.exp(1j * (0.6 + p / 4000))
    mu[:, 1] = mu[:, 0].conj()
    mu[:, 2] = -0.7 - 0.35 * np.exp(-((p - 4293) / 230)**2)
    mu[:, 3] = 0.5
    put(g["branch"], multipliers_real=mu.real, multipliers_imag=mu.imag)
    kinds, values = ["flip", "flip", "neimark_sacker"], [*flips, ns]
    if fold:
        turns = np.nonzero(np.diff(np.sign(np.diff(p))))[0] + 1
        kinds, values = kinds + ["cyclic_fold"] * len(turns), values + list(p[turns])
    put(g.create_group("bifurcations"), type=kinds, parameter=np.array(values, float), uncertainty=np.full(len(values), 5.0), angle=np.zeros(len(values)))
    pick = np.linspace(0, 139, 20).astype(int)
    t = np.linspace(0, 2 * np.pi, 120, endpoint=False)[None, :, None]
    swing = size[pick][:, None, :]
    put(g.create_group("orbits"), parameter=p[pick], x=xm[pick][:, None, :] + swing * (np.cos(t) + 0.1 * np.cos(2 * t)),
        y=ym[pick][:, None, :] + 1.1 * swing * np.sin(t + 0.3))
    put(g.create_group("bearings"), name=NAMES, clearance=CLEARANCE, preload=[0, 0, 0.5, 0.5, 0])


def bearing_map(root, name, soft):
    """Short bearing in closed form, with made-up dependence on the frequency where it has a soft liner."""
    g = study(root, name, "bearing_map", bearing=name, speed=160.0)
    e = np.linspace(0.01, 0.9, 60)
    q = 1 - e**2
    load = e * np.sqrt(16 * e**2 + np.pi**2 * q) / (2 * q**2) / (1 + soft)
    attitude = np.arctan(np.pi * np.sqrt(q) / (4 * e))
    table = g.create_group("locus")
    table.attrs["frequency_ratio"] = 1.0
    limit = np.where(e < 0.75, 2.7 + e**4, np.nan)
    put(table, eccentricity=e, attitude=attitude, sommerfeld=load, x=e * np.sin(attitude), y=-e * np.cos(attitude),
        speed_limit=limit, whirl_ratio=limit / limit * 0.5)
    entries = {f"{letter}_{entry}": (k + 1) * load - k for letter in "kc" for k, entry in enumerate(("xx", "xy", "yx", "yy"))}
    put(table, **entries)
    theta = np.linspace(0, 2 * np.pi, 91)
    put(g.create_group("profiles"), sommerfeld=[2.5], theta=theta + 0.5 * np.pi, pressure=[np.sin(theta)], thickness=[1 + 0.5 * np.cos(theta)])
    if soft:
        ratio = np.array([1, 0.01, 0.1, 10, 100.0])
        put(g.create_group("frequencies"), ratio=ratio, **{k: v[:, None] * (1 + ratio / (1 + ratio)) for k, v in entries.items()})
        return
    e, phi = 1 - 0.1 ** np.linspace(0, 1, 31), np.linspace(0, 2 * np.pi, 61)
    a, b = np.outer(e, np.cos(phi)), np.outer(e, np.sin(phi))
    w = 1 / (1 - a**2 - b**2) ** 2
    put(g.create_group("impedance"), eccentricity=e, angle=phi, W_along=w * (1 + a), W_across=w * b)


def motion(root):
    g = study(root, "period two", "motion", speed=960.0, motion="period-2", evidence="returns", samples=64)
    t = np.arange(1, 20 * 64 + 1)[:, None] / 64
    x = 5e-6 * np.cos(2 * np.pi * t) + 8e-6 * np.cos(np.pi * t) * np.ones(2)
    y = 5e-6 * np.sin(2 * np.pi * t) - 7e-6 * np.sin(np.pi * t) * np.ones(2)
    put(g.create_group("orbit"), x=x, y=y)
    put(g.create_group("poincare"), x=x[63::64], y=y[63::64])
    order = np.arange(641) / 20
    peaks = 1e-12 + 5e-6 * (abs(order - 1) < 0.03) + 8e-6 * (abs(order - 0.5) < 0.03)
    put(g.create_group("spectrum"), order=order, frequency=order * 153, x=peaks[:, None] * np.ones(2), y=peaks[:, None] * np.ones(2))
    put(g.create_group("exponents"), value=[-3.0, -9.0], uncertainty=[0.1, 0.2], running=np.array([[-3 - 1 / k, -9 + 1 / k] for k in range(1, 21)]))
    put(g.create_group("bearings"), name=["left", "right"], node=[1, 1], clearance=[25e-6, 25e-6], preload=[0, 0], offset=[0, 0], arc=[2 * np.pi] * 2)


def course(root):
    """A run-up whose order 1 passes a resonance at 100 rad/s, with a half order above 150 rad/s."""
    g = study(root, "through", "run_up", speed_unit="rad/s", acceleration=4.0, unbalance="a")
    speed = np.linspace(50, 200, 31)
    z = 1e-6 * speed**2 / (1e4 - speed**2 + 10j * speed)
    half = 6e-6 * (speed > 150)
    order = np.arange(129) / 32
    near = lambda o: np.maximum(0, 1 - 16 * abs(order - o))  # noqa: E731
    rows = np.abs(z)[:, None] * near(1) + half[:, None] * near(0.5)
    put(g.create_group("waterfall"), place=["A", "B"], speed=speed, revolution=np.arange(31.0), time=np.arange(31.0), order=order,
        x=rows[:, :, None] * [1, 0.5], y=rows[:, :, None] * [1, 0.5])
    tracks, turned = np.stack([half, np.abs(z)], axis=1), np.stack([0 * half, np.angle(z)], axis=1)
    put(g.create_group("orders"), place=["A", "B"], speed=speed, revolution=np.arange(31.0), time=np.arange(31.0), order=[0.5, 1.0],
        **{f"{a}_amplitude": tracks[:, :, None] * [1, 0.5] for a in "xy"}, **{f"{a}_phase": turned[:, :, None] * [1, 1] for a in "xy"})


def sweep(root):
    g = study(root, "clearances", "sweep")
    for k, name in enumerate(("narrow", "wide")):
        variant = g.create_group(f"variants/{name}")
        variant.attrs.update({"title": name, "order": k + 1})
        root.copy(root["studies/balanced"], variant, "balanced")
        variant["balanced/branch/y"][...] *= 1 + 0.2 * k
    rows = {"variant": ["as given", "narrow", "wide"], "verdict": ["loses stability", "loses stability", "-"], "clearance": [1.0, 0.8, 1.2]}
    put(g.create_group("table"), **rows, **{"balanced.hopf.1": [5025.0, 4000.0, 6500.0]})


def make(directory):
    directory = pathlib.Path(directory)
    directory.mkdir(parents=True, exist_ok=True)
    for name, data in made().items():
        (directory / name).write_bytes(data)


@functools.cache
def made():
    """The files by name: many checks of a test begin with them."""
    with tempfile.TemporaryDirectory() as name:
        build(pathlib.Path(name))
        return {file.name: file.read_bytes() for file in pathlib.Path(name).iterdir()}


def build(directory):
    with h5py.File(directory / "results.h5", "w") as root:
        root.attrs.update({"title": "Turbine-generator train", "version": "0.1.0"})
        static(root)
        modes(root)
        response(root)
        equilibria(root)
        cycles(root, "pair, G2.5", 1.0, 0)
        cycles(root, "pair, G6.3", 2.5, 1)
        bearing_map(root, "hard", 0)
        bearing_map(root, "soft", 0.5)
        motion(root)
        course(root)
        thd(root)
        sweep(root)
    quantity = lambda value, unit, bar: {"value": value, "unit": unit, "uncertainty": bar}  # noqa: E731
    PEAKS = [{"place": place, "speed": quantity(speed, "rpm", 0.1), "semi_major": quantity(size, "m", 2e-7), "amplification_factor": quantity(factor, "1", 0.2),
              "separation_margin": quantity(margin, "1", None), "required_margin": quantity(0.16, "1", None), "stability": stability, "verdict": verdict,
              "notes": notes}
             for place, speed, size, factor, margin, stability, verdict, notes in
             (("node 120", 2683, 7.5e-5, 12.4, 0.255, "stable", "far enough", []),
              ("node 120", 5120, 9.1e-5, None, 0.42, "unstable", "", ["no amplification factor: the range ends"]),
              ("B3, journal", 2690, 3e-5, 11.9, 0.25, "stable", "far enough", []))]
    studies = [
        {"name": "at service speed", "kind": "static", "status": "completed", "wall_seconds": 0.4,
         "values": {"mass.total": {"value": 42165.66, "unit": "kg"}, "load.B3": {"value": None, "unit": "N"}},
         "bifurcations": [], "modes": [], "points": 1, "brief": {"sentences": ["largest load 213.4 +- 0.1 kN on B3"], "tables": []}},
        {"name": "modes", "kind": "modes", "status": "completed", "wall_seconds": 3.0, "values": {}, "bifurcations": [],
         "modes": [{"speed": 3600, "real": -0.583, "imag": 81.678, "log_decrement": 0.0448, "whirl": "forward"}], "points": 40},
        {"name": "generator pair", "kind": "unbalance_response", "status": "completed", "wall_seconds": 1.0,
         "values": {"peak.1.speed": {"value": 280.6, "unit": "rad/s"}, "operating_speed": {"value": 3600, "unit": "rpm"}}, "bifurcations": [], "modes": [],
         "points": 300, "peaks": PEAKS},
        {"name": "balanced", "kind": "equilibrium_branch", "status": "completed", "wall_seconds": 5.0, "values": {},
         "bifurcations": [{"type": "hopf", "parameter": "speed", "value": 5025.0, "unit": "rpm", "period_s": 0.0733,
                           "uncertainty": 12.0, "criticality": None}], "modes": [], "points": 70,
         "brief": {"sentences": ["The equilibrium loses stability at 5025 +- 12 rpm (Hopf point)."], "tables": []}},
        {"name": "hot", "kind": "thd", "status": "completed", "wall_seconds": 1.0, "values": {"temperature.mean": {"value": 360.0, "unit": "K"}},
         "bifurcations": [], "modes": [], "points": 1},
        {"name": "clearances", "kind": "sweep", "status": "completed", "wall_seconds": 9.0, "values": {}, "bifurcations": [], "modes": [], "points": 2,
         "variants": [{"name": n, "changes": {}, "studies": []} for n in ("narrow", "wide")],
         "columns": [{"name": f"balanced.hopf.{k}", "unit": u, "values": v, "uncertainties": e}
                     for k, u, v, e in (("1", "rpm", [5025.0, 4000.0, 6500.0], [12.0, None, 9.0]), ("count", "1", [1, 1, 1], [0, 0, 0]))],
         "trends": [{"column": "balanced.hopf.1", "quantity": "clearance", "unit": "1", "beside": "", "sign": "+",
                     "variants": ["narrow", "as given", "wide"], "at": [0.8, 1.0, 1.2], "difference": [1025.0, 1475.0],
                     "uncertainty": [24.0, 21.0]}]},
    ]
    summary = {"title": "Turbine-generator train <A & B>", "version": "0.1.0", "ranks": 2, "wall_seconds": 9.4, "studies": studies}
    (directory / "summary.json").write_text(json.dumps(summary))
    (directory / "manifest.txt").write_text("".join(f"{name}\n" for name in FILES))


if __name__ == "__main__":
    import sys
    make(sys.argv[1])
