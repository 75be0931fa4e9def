"""Frequency responses: amplitude and phase of every output over the frequency, one colour for each input."""
import numpy as np

from .canvas import Line2D, plain_numbers, plt
from .style import COLOURS, DASHED, INK, ROTATION, save, speed_axis, ticks_at

LINES = ("-", (0, (4, 2)), (0, (1.2, 1.4)), (0, (7, 1.6, 1.2, 1.6)))


def ways_of(response):
    """(group, words) of the machine, and of machines with stiffness and damping in place of their films."""
    for name in sorted((n for n in response if "frequency" in response[n].attrs), key=lambda n: (n != "machine", n)):
        at = response[name].attrs["frequency"]
        yield name, {"machine": "machine", "coefficients": "K, C at each frequency", "given": "K, C as given"}.get(name, f"K, C at {at:.5g} rad/s")


def words_of(place):
    """`node.7.slope_x` as a person reads it."""
    return place.replace(".", " ").replace("_", " ")


def turned(phase):
    """Degrees, broken where the phase passes 180."""
    degrees = np.rad2deg(phase)
    return np.where(np.abs(np.diff(degrees, prepend=degrees[0])) > 180, np.nan, degrees)


def draw(study):
    if "response" not in study.group or "machine" not in study.group["response"]:
        return []
    response = study.group["response"]
    factor, _, _, _ = speed_axis(study.attribute("frequency_unit", "rad/s"))
    unit = study.attribute("frequency_unit", "rad/s")
    frequency = response["frequency"][()] * factor
    unstable = study.summary.get("stability") == "unstable"
    ways, pairs = list(ways_of(response)), list(response["machine"])
    outputs = list(dict.fromkeys(p.split(".from.")[0] for p in pairs))
    inputs = list(dict.fromkeys(p.split(".from.")[1] for p in pairs))
    log = np.allclose(np.diff(np.log(frequency)), np.log(frequency[1] / frequency[0]), rtol=1e-6)
    files = []
    for output in outputs:
        figure, (top, bottom) = plt.subplots(2, 1, figsize=(8.6, 6.4), sharex=True, height_ratios=[1.6, 1])
        units = []
        for colour, source in zip(COLOURS * len(inputs), inputs):
            for (way, _), line in zip(ways, LINES * len(ways)):
                table = response[way][f"{output}.from.{source}"]
                amplitude = table["amplitude"][()]
                if np.all(amplitude == 0):
                    continue
                width = 1.6 if way == "machine" else 1.2
                look = {"color": colour, "linestyle": line, "linewidth": width}
                if way == "machine" and unstable:
                    look["linestyle"] = DASHED
                if way == "coefficients":  # the same curve: points on it
                    look = {"color": colour, "linestyle": "none", "marker": ".", "markersize": 5, "markevery": max(1, len(frequency) // 40)}
                top.plot(frequency, amplitude, **look)
                bottom.plot(frequency, turned(table["phase"][()]), **look)
                units.append(str(table["amplitude"].attrs.get("unit", "")))
        if not units:
            plt.close(figure)
            continue
        top.set_yscale("log")
        if log:
            top.set_xscale("log")
            plain_numbers(bottom.xaxis)
        kinds = list(dict.fromkeys(units))
        top.set_ylabel(f"amplitude, 0-peak [{', '.join(kinds)}]")
        bottom.set_ylabel("phase [\u00b0]")
        ticks_at(bottom.yaxis, range(-180, 181, 90))
        bottom.set_ylim(-190, 190)
        bottom.set_xlabel(f"frequency [{unit}]")
        top.set_title(f"{words_of(output)} per unit of input" + (", about an unstable equilibrium" if unstable else ""))
        of = {i: str(response["machine"][f"{output}.from.{i}"]["amplitude"].attrs.get("unit", "")) for i in inputs}
        handles = [Line2D([], [], color=c, label=f"from {words_of(i)}" + (f" [{of[i]}]" if len(kinds) > 1 else "")) for c, i in zip(COLOURS * len(inputs), inputs)]
        if len(ways) > 1:
            handles += [Line2D([], [], color=INK, linestyle="none" if way == "coefficients" else line, marker="." if way == "coefficients" else None, label=words)
                        for (way, words), line in zip(ways, LINES * len(ways))]
        files += save(figure, study, f"response-{output}", f"0-peak over 0-peak, phase of the output ahead of the input; {ROTATION}", handles, 4)
    return files
