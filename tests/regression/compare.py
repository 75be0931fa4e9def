"""Whether two runs found the same, whatever the number of ranks and interruptions."""
import json

import h5py
import numpy

CLOCKS = ("wall_seconds", "seconds", "ranks", "layout", "ways")
DIFFERENCES = ("bracket", "branch_curvature")  # of parameters


def datasets(path):
    found = {}
    with h5py.File(path) as f:
        def visit(name, item):
            for key, text in item.attrs.items():
                found[f"{name}@{key}"] = text
            if isinstance(item, h5py.Dataset):
                found[name] = item[()]
        f.visititems(visit)
    return {k: v for k, v in found.items() if not k.endswith(CLOCKS)}


def leaves(node, path=""):
    if isinstance(node, dict):
        node = node.items()
    elif isinstance(node, list):
        node = enumerate(node)
    else:
        return {path: node}
    all = {}
    for key, below in node:
        all.update(leaves(below, f"{path}/{key}"))
    return {k: v for k, v in all.items() if not k.endswith(CLOCKS)}


def difference(key, a, b, scale):
    """Largest difference over the largest magnitude; infinite if the shapes, the texts or the places
    without a number differ."""
    a, b = numpy.asarray(a), numpy.asarray(b)
    if a.shape != b.shape:
        return float("inf")
    if a.dtype.kind not in "fiu" or b.dtype.kind not in "fiu":
        return 0.0 if numpy.array_equal(a, b) else float("inf")
    a, b = a.astype(float), b.astype(float)
    if not numpy.array_equal(numpy.isnan(a), numpy.isnan(b)):
        return float("inf")
    there = ~numpy.isnan(a)
    if not there.any():
        return 0.0
    return float(numpy.max(numpy.abs(a[there] - b[there])) / (scale or numpy.max(numpy.abs(a[there])) or 1.0))


def same_results(one, other, within=1e-8):
    """The worst differences of results.h5 and summary.json as (what, relative difference, tolerance)."""
    report = []
    for what, a, b in (("results.h5", datasets(one / "results.h5"), datasets(other / "results.h5")),
                       ("summary.json", leaves(json.loads((one / "summary.json").read_text())),
                        leaves(json.loads((other / "summary.json").read_text())))):
        if a.keys() != b.keys():
            report.append((f"{what}: {sorted(a.keys() ^ b.keys())[:3]} only once", float("inf"), 0))
            continue
        worst, where = 0.0, "nothing"
        for key in a:
            scale = None
            # Where a flip's coefficient is read off the branch born there, it is that branch's curvature.
            born = key.replace("criticality_coefficient", "branch_curvature")
            of_parameters = (born if born in a else key).endswith(DIFFERENCES)
            # A difference of two parameters has the accuracy of the parameters.
            found = key.replace(key[key.rindex("/") + 1:], "parameter" if what[0] == "r" else "value") if "/" in key else key
            # So has the bar of a number that of the number.
            for found in (found, key.removesuffix("_uncertainty"), key.replace("_uncertainty/values/", "/values/")):
                if ("uncertainty" in key or of_parameters) and found != key and a.get(found) is not None and numpy.asarray(a[found]).dtype.kind in "fiu":
                    scale = numpy.nanmax(numpy.abs(a[found]), initial=0) or None
            if "shaft_mesh.largest_error" in key:
                scale = 1.0  # of frequencies
            if "normal_uncertainty" in key:
                scale = 1.0  # the widths of both ranges
            if key.endswith("_imag") and key[:-4] + "real" in a:
                # A complex number has one accuracy: where all of them are real, imaginary parts are rounding.
                scale = max(numpy.nanmax(numpy.abs(x), initial=0) for x in (a[key], a[key[:-4] + "real"]))
            of_pair = key.removesuffix("damping_real") + "frequency"
            if key.endswith("damping_real") and of_pair in a:
                scale = max(numpy.nanmax(numpy.abs(x), initial=0) for x in (a[key], a[of_pair]))
            d = difference(key, a[key], b[key], scale)
            if "uncertainty" in key:
                d /= 100  # of a bar as small a part of its number as this says nothing
            if d > worst:
                worst, where = d, key
        report.append((f"{what}, worst at {where}", worst, within))
    return report
