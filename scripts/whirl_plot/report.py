"""One self-contained HTML page of a results folder: values, bifurcations, modes, pictures."""
import base64
import html
import json
import re
import sys

from .data import open_results, results_directory
from .manifest import register

STYLE = """
body{font:15px/1.5 system-ui,sans-serif;color:#222;max-width:1120px;margin:2em auto;padding:0 1em}
h1{font-size:1.7em;margin-bottom:.1em} h2{font-size:1.3em;margin-top:2em;border-bottom:1px solid #ddd;padding-bottom:.2em}
.note{color:#777} table{border-collapse:collapse;margin:.8em 0;font-size:.92em} caption{text-align:left;font-weight:600;padding:.3em 0}
th,td{padding:.2em 1em .2em 0;text-align:left;border-bottom:1px solid #eee} td.n{text-align:right;font-variant-numeric:tabular-nums}
img{max-width:100%;margin:1em 0;border:1px solid #eee} nav a{margin-right:1.2em} details{margin:.6em 0} .bad{color:#c8102e}
"""


def number(value):
    """Seven digits are more than any of these numbers is worth."""
    return "\u2013" if value is None else f"{value:.7g}" if isinstance(value, (int, float)) else html.escape(str(value))


def table(caption, head, rows, folded=False):
    if not rows:
        return ""
    cells = "".join(f"<tr>{''.join(f'<td class=n>{number(c)}</td>' if isinstance(c, (int, float)) or c is None else f'<td>{html.escape(str(c))}</td>' for c in row)}</tr>" for row in rows)
    title = "".join(f"<th>{html.escape(h)}</th>" for h in head)
    body = f"<table><caption>{html.escape(caption)}</caption><tr>{title}</tr>{cells}</table>"
    return f"<details><summary>{html.escape(caption)} ({len(rows)})</summary>{body}</details>" if folded else body


def bifurcations(study):
    rows, usual = [], ("type", "parameter", "value", "unit", "period_s", "uncertainty", "criticality")
    for b in study.get("bifurcations", []):
        more = ", ".join(f"{k} {number(v)}" for k, v in b.items() if k not in usual)
        rows.append([b.get("type"), b.get("parameter"), b.get("value"), b.get("uncertainty"), b.get("unit"), b.get("period_s"),
                     b.get("criticality") or "", more])
    return table("Bifurcations", ["type", "parameter", "value", "\u00b1", "unit", "period [s]", "criticality", "more"], rows)


def section(study, pictures):
    name, status = study["name"], study.get("status", "")
    out = [f"<h2 id='{anchor(name)}'>{html.escape(name)}</h2>"]
    bad = "" if status == "completed" else " class=bad"
    out.append(f"<p class=note>{html.escape(study.get('kind', ''))}, <span{bad}>{html.escape(status)}</span>, "
               f"{number(study.get('points'))} points, {study.get('wall_seconds') or 0:.1f} s</p>")
    values = [[k, v.get("value"), v.get("unit", "")] for k, v in study.get("values", {}).items()]
    modes = [[m.get(k) for k in ("speed", "real", "imag", "log_decrement")] + [m.get("whirl") or ""] for m in study.get("modes", [])]
    out.append(bifurcations(study))
    out.extend(picture(p) for p in pictures)
    out.append(table("Values", ["name", "value", "unit"], values, folded=len(values) > 12))
    out.append(table("Modes", ["speed", "real [1/s]", "imag [rad/s]", "log. decrement", "whirl"], modes, folded=len(modes) > 12))
    return "\n".join(out)


def anchor(name):
    return "s-" + re.sub(r"[^A-Za-z0-9]+", "-", name)


def picture(path):
    data = base64.b64encode(path.read_bytes()).decode("ascii")
    return f"<img alt='{html.escape(path.stem)}' src='data:image/png;base64,{data}'>"


def studies_of(directory):
    """(summary, [(study, its pictures)], pictures of the whole run)."""
    try:
        summary = json.loads((directory / "summary.json").read_text())
    except (OSError, ValueError):
        summary = {}
    known = {s["name"]: s for s in summary.get("studies", [])}
    every = sorted(directory.glob("*.png"), key=lambda p: (p.stat().st_mtime_ns, p.name))
    used, found = set(), []
    with open_results(directory) as results:
        summary.setdefault("title", results.title)
        for study in results.studies:
            stem = study.file("x").name.removesuffix("x.png")
            mine = [p for p in every if p.name.startswith(stem) and p.name.removeprefix(stem).count(".") == 1]
            used.update(mine)
            found.append((known.pop(study.name, {"name": study.name, "kind": study.kind, "status": study.status}), mine))
    found += [(s, []) for s in known.values()]
    return summary, found, [p for p in every if p not in used]


def main(argv):
    directory = results_directory("report", argv)
    if isinstance(directory, int):
        return directory
    summary, studies, general = studies_of(directory)
    title = html.escape(summary["title"])
    links = "".join(f"<a href='#{anchor(s['name'])}'>{html.escape(s['name'])}</a>" for s, _ in studies)
    made = f"whirl {html.escape(str(summary.get('version', '')))}, {number(summary.get('ranks'))} ranks, {summary.get('wall_seconds') or 0:.1f} s"
    page = [f"<!doctype html><html lang=en><meta charset=utf-8><meta name=viewport content='width=device-width'><title>{title}</title>",
            f"<style>{STYLE}</style><h1>{title}</h1><p class=note>{made}</p><nav>{links}</nav>",
            *(picture(p) for p in general), *(section(s, p) for s, p in studies), "</html>"]
    target = directory / "report.html"
    register(target).write_text("\n".join(page), encoding="utf-8")
    print(target)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
