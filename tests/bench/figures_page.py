"""The page of scripts/figures: what the paper claims, our pictures and numbers beside the truth, and a verdict.

Everything is read from the folder of a run; verdicts are computed from its numbers. The same sections become HTML and,
for docs/paper-figures.md, Markdown.
"""
import csv
import dataclasses
import html as escape
import re
import shutil
import statistics
import struct

PAPER = ("W. Song, J. Fu, Y. Zhang, GPU-based rendering of global illumination using discretization of radiosity "
         "equation (2016)")
HOLDS, FAILS, UNKNOWN = "holds", "does not hold", "not measured"
LIMIT = 0.05  # of what is measured in pictures, relative


@dataclasses.dataclass
class Section:
    title: str
    claim: str
    pictures: list = dataclasses.field(default_factory=list)  # rows of (file, caption)
    tables: list = dataclasses.field(default_factory=list)  # (caption, head, rows)
    verdicts: list = dataclasses.field(default_factory=list)  # (HOLDS ..., claim in short, why)
    notes: list = dataclasses.field(default_factory=list)


# ---- what is read ---------------------------------------------------------------------------------------------------


def png_size(path):
    with open(path, "rb") as file:
        head = file.read(24)
    return struct.unpack(">II", head[16:24])


def read_csv(path):
    if not path.exists():
        return []
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(line for line in file if not line.startswith("#")))


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def read_measures(path):
    """{(measure, place): (ours, truth)}, None where there is none."""
    return {(row["measure"], row["place"]): (number(row["ours"]), number(row["truth"])) for row in read_csv(path)}


def deviation(pair):
    """Relative, of ours from truth; None where one is missing or no number."""
    ours, truth = pair
    if ours is None or not truth or ours != ours or truth != truth:
        return None
    return ours / truth - 1


def digits(value):
    if value is None or value != value:
        return "–"
    return f"{value:.0f}" if abs(value) >= 100 else f"{value:.3g}"


def percent(value):
    return "–" if value is None or value != value else f"{100 * value:+.1f} %"


def listed(measures, names):
    """A table's rows of measures whose name begins with one of `names`."""
    return [[measure, place, digits(pair[0]), digits(pair[1]), percent(deviation(pair))]
            for (measure, place), pair in measures.items() if measure.startswith(tuple(names))]


def worst(measures, name):
    """The largest deviation of a measure, with its place; (None, "") where one place has none."""
    found = [(deviation(pair), place) for (measure, place), pair in measures.items() if measure == name]
    if not found or any(d is None for d, _ in found):
        return None, ""
    return max(found, key=lambda one: abs(one[0]))


HEAD = ["measure", "place", "ours", "truth", "off by"]


# ---- figure 4 -------------------------------------------------------------------------------------------------------


def judge_bleeding(measures):
    off, place = worst(measures, "red over green global")
    share, share_place = worst(measures, "bleeding global")
    at_red = measures.get(("bleeding global", "floor by the red wall"))
    if off is None or share is None or not at_red:
        return (UNKNOWN, "global light shows colour bleeding", "the truth, or our picture, is missing")
    state = HOLDS if max(abs(off), abs(share)) <= LIMIT and at_red[0] > 1.05 else FAILS
    return (state, "global light shows colour bleeding",
            f"before the red wall the floor is {100 * (at_red[0] - 1):.0f} % redder than in direct light, "
            f"{100 * (at_red[1] - 1):.0f} % in the truth; red over green is off by {percent(off)} where it is worst "
            f"({place}), over that of direct light by {percent(share)} ({share_place}); the limit is "
            f"{100 * LIMIT:.0f} %")


def judge_shadows(measures):
    off, place = worst(measures, "penumbra")
    if off is None:
        return (UNKNOWN, "soft shadows are right", "the truth, or our picture, is missing")
    return (HOLDS if abs(off) <= LIMIT else FAILS, "soft shadows are right",
            f"the width of penumbrae is off by {percent(off)} where it is worst ({place}); the limit is "
            f"{100 * LIMIT:.0f} %")


def judge_direct(measures):
    """The paper's sentence that direct light alone has no soft shadows."""
    widths = [pair[0] for (measure, _), pair in measures.items() if measure == "penumbra" and pair[0] is not None]
    claim = "direct light alone cannot show soft shadows"
    if not widths or any(w != w for w in widths):
        return (UNKNOWN, claim, "no penumbra was measured")
    return (FAILS if min(widths) > 0.01 else HOLDS, claim,
            f"the penumbrae measured here, {100 * min(widths):.0f} to {100 * max(widths):.0f} cm wide, are those of "
            f"the picture of direct light: they come from the lamp's size. What global light adds is light inside the "
            f"shadow, and the colours of the walls")


def closed_form(outputs):
    text = "\n".join(outputs.values())
    found = re.search(r"soft shadow, maps of 512 texels: off by ([\d.]+) of the brightest pixel \(RMS\), "
                      r"([\d.]+) at most", text)
    return [f"Against a closed form, the soft shadow of a plate under a lamp is off by {100 * float(found[1]):.2f} % "
            f"of the brightest pixel (RMS), {100 * float(found[2]):.1f} % at most (test_draw)."] if found else []


def figure_four(folder, outputs):
    measures = read_measures(folder / "figure4.csv")
    s = Section("Figure 4: direct, indirect and global illumination",
                f"In the Cornell box the picture of global illumination shows soft shadows and colour bleeding, which "
                f"direct or indirect illumination alone cannot give ({PAPER}, section 4, figure 4).")

    def by_mode(file, caption):
        return [(file % mode, f"{caption}, {mode}") for mode in ("direct", "indirect", "global")]
    s.pictures = [by_mode("ours/%s.png", "ours"), by_mode("truth/%s.png", "path-traced"),
                  by_mode("shadow_%s.png", "soft shadow: ours") + [("shadow_truth.png", "path-traced, global")],
                  by_mode("bleeding_%s.png", "colours: ours") + [("bleeding_truth.png", "path-traced, global")],
                  [("difference4.png", "ours less truth, global: red is brighter, blue darker, full colour at 0.05 "
                                       "W/(m² sr), about half of what the floor has")]]
    s.verdicts = [judge_shadows(measures), judge_bleeding(measures), judge_direct(measures)]
    s.tables = [("Soft shadows: metres of floor on which the lamp's visible share rises from a tenth to nine tenths, "
                 "along one line each; share: radiance of direct light over the closed form of the lamp without "
                 "anything in the way",
                 HEAD, listed(measures, ["penumbra"])),
                ("Colour: red over green of radiance, and over that of direct light (bleeding: 1 where no wall lends "
                 "its colour)",
                 HEAD, listed(measures, ["red over green global", "bleeding"])),
                ("Radiance, W/(m² sr), luminance", HEAD, listed(measures, ["radiance"])),
                ("Whole pictures without the lamp", ["measure", "light", "value"],
                 [[m, p, digits(v[0])] for (m, p), v in measures.items() if m in ("relative MSE", "RMS over mean")])]
    s.notes = closed_form(outputs)
    return s


# ---- figure 5 -------------------------------------------------------------------------------------------------------


def read_caustic_energy(outputs):
    """What test_caustics prints: [(ball, total, rms)]."""
    text = "\n".join(outputs.values())
    pattern = r"(glass|mirror) ball of \d+ faces: [\d.]+ W of [\d.]+ \(([-+\d.]+) %\), RMS by leaf ([\d.]+) %"
    return [(ball, float(total) / 100, float(rms) / 100) for ball, total, rms in re.findall(pattern, text)]


def judge_energy(energy):
    claim = "caustics of mirror and glass carry the right light"
    if not energy:
        return (UNKNOWN, claim, "test_caustics is missing")
    good = all(abs(total) <= 0.02 and rms <= 0.10 for _, total, rms in energy)
    return (HOLDS if good else FAILS, claim,
            "alone in a black box, against light traced forward: " +
            ", ".join(f"{ball} ball {percent(total)} of the energy, {100 * rms:.1f} % RMS by leaf"
                      for ball, total, rms in energy)
            + "; limits 2 % and 10 %")


def judge_caustic_picture(measures):
    claim = "the picture shows them as they are"
    place = "caustic of the glass ball"
    light, cells = measures.get(("radiance", place)), measures.get(("relative RMS of cells", place))
    if not light or deviation(light) is None or not cells:
        return (UNKNOWN, claim, "the truth, or our picture, is missing")
    good = abs(deviation(light)) <= LIMIT and cells[0] <= 0.10
    return (HOLDS if good else FAILS, claim,
            f"under the glass ball the floor has {digits(light[0])} W/(m² sr), {digits(light[1])} in the truth "
            f"({percent(deviation(light))}), {100 * cells[0]:.1f} % RMS over cells of 10 cm; limits {100 * LIMIT:.0f} "
            f"% and 10 %")


def median_ms(path):
    rows = read_csv(path)[1:]  # the first builds everything
    return statistics.median(float(row["frame_wall_ms"]) for row in rows) if rows else None


def judge_rate(folder):
    claim = "two moving balls keep 10 frames a second under a budget, without a GPU"
    budget, exact = median_ms(folder / "budget_frames.csv"), median_ms(folder / "exact_frames.csv")
    if budget is None:
        return (UNKNOWN, claim, "two_balls could not run")
    return (HOLDS if budget <= 100 else FAILS, claim,
            f"the median frame took {budget:.0f} ms ({1000 / budget:.1f} a second)"
            + (f", an exact one {exact:.0f} ms" if exact else "") + ", update and picture of 512 x 512")


def figure_five(folder, outputs):
    measures, energy = read_measures(folder / "figure5.csv"), read_caustic_energy(outputs)
    s = Section("Figure 5: a mirror ball and a glass ball",
                f"Caustics, colour bleeding and soft shadows are more obvious in global illumination by radiosity "
                f"than in real-time ray tracing, which is not physically correct ({PAPER}, section 4, figure 5).")
    s.pictures = [[("balls.png", "ours"), ("balls_truth.png", "path-traced, caustics by light paths"),
                   ("difference5.png", "ours less truth: red is brighter, blue darker")],
                  [("figure5_realtime.png", "real-time ray tracing"), ("caustic.png", "ours, under the glass ball"),
                   ("caustic_truth.png", "path-traced"), ("balls_moving.png", "ours while both move, 10 frames a "
                                                                              "second asked for")]]
    s.verdicts = [judge_energy(energy), judge_caustic_picture(measures), judge_rate(folder)]
    s.tables = [("Radiance in the picture, W/(m² sr)", HEAD, listed(measures, ["radiance"])),
                ("Distances to the truth", ["measure", "place", "value"],
                 [[m, p, digits(v[0])] for (m, p), v in measures.items() if not m.startswith("radiance")])]
    s.notes = ["Plain radiosity has no caustics: here photons go from the lamp through mirrors and glass, by "
               "Fresnel's and Snell's laws, and the floor shows them pixel by pixel (docs/architecture.md). The paper "
               "does not say how its own method makes them."]
    return s


# ---- figure 6 -------------------------------------------------------------------------------------------------------


def method_kind(name):
    lowered = name.lower()
    return "off-line" if "off" in lowered else "real-time" if "real" in lowered else "ours"


def read_rates(folder):
    """{(motion, triangles): {kind: row}}"""
    rates = {}
    for row in read_csv(folder / "figure6.csv"):
        rates.setdefault((row["motion"], int(float(row["triangles"]))), {})[method_kind(row["method"])] = row
    return rates


def ratios(rates, other, column, inverse=False):
    """{(motion, triangles): how many times better ours is}, by a column of which more is better unless inverse."""
    found = {}
    for key, rows in sorted(rates.items()):
        pair = [number(rows[kind].get(column)) if kind in rows else None for kind in ("ours", other)]
        if all(v is not None and v > 0 for v in pair):
            found[key] = pair[1] / pair[0] if inverse else pair[0] / pair[1]
    return found


def times(value):
    return f"{digits(value)} times"


def judge_faster(rates, other, column="fps", inverse=False, what="frames a second"):
    claim = f"faster than {other} ray tracing" + ("" if column == "fps" else ", at equal error")
    found = ratios(rates, other, column, inverse)
    if not found:
        return (UNKNOWN, claim, "figure_six, or this column of it, is missing")
    low, high = min(found.values()), max(found.values())
    state = HOLDS if low > 1 else FAILS
    lost = [f"{triangles} triangles {motion}" for (motion, triangles), r in found.items() if r <= 1]
    why = f"{what}: ours is {times(low)} to {times(high)} that of {other}"
    return (state, claim, why + (f"; it is behind at {', '.join(lost)}" if lost else ""))


def judge_growth(rates, other):
    claim = f"the lead over {other} ray tracing grows with the mesh"
    found = ratios(rates, other, "fps")
    words, grows = [], []
    for motion in dict.fromkeys(m for m, _ in found):
        sizes = sorted(t for m, t in found if m == motion)
        if len(sizes) > 1:
            first, last = found[motion, sizes[0]], found[motion, sizes[-1]]
            grows.append(last > 1.05 * first)
            words.append(f"{motion}: {times(first)} at {sizes[0]} triangles, {times(last)} at {sizes[-1]}")
    if not words:
        return (UNKNOWN, claim, "figure_six, or sizes of meshes, are missing")
    return (HOLDS if all(grows) else FAILS, claim, "; ".join(words))


def figure_six(folder):
    rates = read_rates(folder)
    s = Section("Figure 6: frames a second against mesh size",
                f"With meshes of 30 to 80 KB the method renders at a higher frame rate than off-line ray tracing and "
                f"real-time ray tracing, the more so the larger the mesh ({PAPER}, section 4, figure 6).")
    s.pictures = [[("figure6.png", "frames a second by triangles drawn")]]
    shown = sorted(folder.glob("figure6_*_*.png"), key=lambda p: (int("0" + re.sub(r"\D", "", p.stem)[1:]), p.name))
    sizes = list(dict.fromkeys(p.stem.split("_")[-1] for p in shown))
    s.pictures += [[(p.name, p.stem.replace("figure6_", "").rsplit("_", 1)[0] + f", {size} triangles") for p in shown
                    if p.stem.split("_")[-1] == size] for size in sizes]
    s.verdicts = [judge_faster(rates, other) for other in ("off-line", "real-time")]
    s.verdicts += [judge_growth(rates, other) for other in ("off-line", "real-time")]
    s.verdicts += [judge_faster(rates, other, "equal_error_ms", True, "time to the same error")
                   for other in ("off-line", "real-time")]
    rows = read_csv(folder / "figure6.csv")
    if rows:
        s.tables = [("All of figure6.csv", list(rows[0]), [[shortened(row[c]) for c in rows[0]] for row in rows])]
    return s


def shortened(text):
    value = number(text)
    return text if value is None else digits(value) if "." in text or "e" in text else text


# ---- pages ----------------------------------------------------------------------------------------------------------


def read_sections(folder, outputs):
    sections = [figure_four(folder, outputs), figure_five(folder, outputs), figure_six(folder)]
    for s in sections:
        s.pictures = [[one for one in row if (folder / one[0]).exists()] for row in s.pictures]
        s.pictures = [row for row in s.pictures if row]
        s.tables = [table for table in s.tables if table[2]]
    return sections


STYLE = """
:root { color-scheme: light; --ink: #1d2126; --soft: #5b646e; --line: #d9dde2; --paper: #fff; --good: #1b6b3a;
	--bad: #9b2c1c; --open: #6b5a1b; }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 76rem; padding: 2rem 1.5rem 4rem; font: 16px/1.5 system-ui, "DejaVu Sans", sans-serif;
	color: var(--ink); background: var(--paper); }
h1 { font-size: 1.7rem; line-height: 1.25; margin: 0 0 .5rem; }
h2 { font-size: 1.3rem; margin: 3rem 0 .5rem; padding-top: 1rem; border-top: 2px solid var(--line); }
p { max-width: 52rem; margin: .5rem 0; }
.about { color: var(--soft); font-size: .9rem; }
.claim { border-left: 4px solid var(--line); padding-left: 1rem; color: var(--soft); }
.row { display: flex; gap: 1rem; margin: 1rem 0; align-items: flex-start; flex-wrap: wrap; }
figure { margin: 0; flex: 1 1 14rem; max-width: 36rem; }
figure img { width: 100%; height: auto; display: block; background: #000; image-rendering: auto; }
.close img { image-rendering: pixelated; }
figcaption { font-size: .85rem; color: var(--soft); margin-top: .25rem; }
ul.verdicts { list-style: none; margin: 1rem 0; padding: 0; }
ul.verdicts li { margin: .4rem 0; padding: .5rem .75rem; border: 1px solid var(--line); border-left-width: 6px;
	max-width: 60rem; }
ul.verdicts li.holds { border-left-color: var(--good); } ul.verdicts li.fails { border-left-color: var(--bad); }
ul.verdicts li.unknown { border-left-color: var(--open); }
li b { display: block; }
li.holds em { color: var(--good); } li.fails em { color: var(--bad); } li.unknown em { color: var(--open); }
li em { font-style: normal; font-weight: 600; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; font-size: .9rem; margin: 1rem 0; font-variant-numeric: tabular-nums; }
caption { text-align: left; color: var(--soft); padding-bottom: .3rem; max-width: 60rem; }
th, td { padding: .2rem .75rem .2rem 0; text-align: left; border-bottom: 1px solid var(--line); white-space: nowrap; }
td.n, th.n { text-align: right; }
"""

CLASSES = {HOLDS: "holds", FAILS: "fails", UNKNOWN: "unknown"}


def is_number(text):
    return text == "–" or number(text.replace("%", "").strip()) is not None


def html_table(caption, head, rows):
    numeric = [all(is_number(row[k]) for row in rows) for k in range(len(head))]

    def line(tag, row):
        cells = (f"<{tag}{' class=n' if n else ''}>{escape.escape(text)}</{tag}>" for text, n in zip(row, numeric))
        return "<tr>" + "".join(cells) + "</tr>\n"
    return (f"<div class=wide><table><caption>{escape.escape(caption)}</caption>\n<thead>{line('th', head)}</thead>\n"
            f"<tbody>{''.join(line('td', row) for row in rows)}</tbody></table></div>\n")


def html_pictures(row):
    close = " close" if any(re.match("shadow_|bleeding_|caustic", file) for file, _ in row) else ""
    figures = "".join(f'<figure><a href="{file}"><img src="{file}" alt="{escape.escape(caption)}"></a>'
                      f"<figcaption>{escape.escape(caption)}</figcaption></figure>" for file, caption in row)
    return f'<div class="row{close}">{figures}</div>\n'


def html_verdicts(verdicts):
    return "<ul class=verdicts>" + "".join(
        f'<li class={CLASSES[state]}><b>{escape.escape(claim[0].upper() + claim[1:])}: <em>{state}</em></b>'
        f"{escape.escape(why)}.</li>\n" for state, claim, why in verdicts) + "</ul>\n"


def html_section(s):
    parts = [f"<h2>{escape.escape(s.title)}</h2>\n<p class=claim>The paper: {escape.escape(s.claim)}</p>\n",
             html_verdicts(s.verdicts)]
    parts += [html_pictures(row) for row in s.pictures]
    parts += [html_table(*table) for table in s.tables]
    parts += [f"<p>{escape.escape(note)}</p>\n" for note in s.notes]
    return "".join(parts)


def about(machine):
    return (f"{machine['processor']}; {machine['renderer']}; commit {machine['commit']}, {machine['date']}; pictures "
            f"of {machine['pictures']}, {machine['run']} run, {machine['took']}. Wall times are this machine's, with "
            f"whatever else ran on it.")


def html(sections, machine, missing):
    told = "".join(f"<li class=unknown><b>Missing: {escape.escape(what)}</b>{escape.escape(why)}</li>\n"
                   for what, why in missing)
    return ("<!DOCTYPE html>\n<html lang=en>\n<meta charset=utf-8>\n<meta name=viewport content='width=device-width'>\n"
            f"<title>Figures 4, 5 and 6, reproduced</title>\n<style>{STYLE}</style>\n"
            "<h1>Figures 4, 5 and 6 of Song et al., reproduced or refuted</h1>\n"
            f"<p class=about>{escape.escape(about(machine))}</p>\n"
            + (f"<ul class=verdicts>{told}</ul>\n" if told else "") + "".join(html_section(s) for s in sections)
            + "</html>\n")


def markdown(sections, machine, missing, folder):
    lines = ["# Figures 4, 5 and 6 of Song et al.", "",
             "Made by `scripts/figures --docs`, which renders and measures all of it and writes "
             "`out/figures/index.html`.",
             wrapped(about(machine))]
    lines += [f"- Missing: {what}: {why}" for what, why in missing]
    for s in sections:
        lines += ["", f"## {s.title}", "", wrapped(f"The paper: {s.claim}"), ""]
        lines += [wrapped(f"- **{claim[0].upper() + claim[1:]}: {state}.** {why}.") for state, claim, why in s.verdicts]
        for row in s.pictures:
            lines += ["", "| " + " | ".join(f"![{c}](pictures/{docs_name(f)})" for f, c in row) + " |",
                      "|" + "---|" * len(row), "| " + " | ".join(c for _, c in row) + " |"]
        for caption, head, rows in s.tables:
            lines += ["", wrapped(caption + ":"), "", "| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
            lines += ["| " + " | ".join(row) + " |" for row in rows]
        for note in s.notes:
            lines += ["", wrapped(note)]
    return "\n".join(lines) + "\n"


def wrapped(text, width=120):
    """Lines of at most so many columns; those of a list are indented."""
    indent, lines, line = "  " if text.startswith("- ") else "", [], ""
    for word in text.split(" "):
        if line and len(line) + 1 + len(word) > width:
            lines.append(line)
            line = indent + word
        else:
            line = f"{line} {word}" if line else word
    return "\n".join(lines + [line])


def docs_name(file):
    return "figures-" + file.replace("/", "-")


def write_docs(sections, machine, missing, folder, path):
    pictures = path.parent / "pictures"
    pictures.mkdir(parents=True, exist_ok=True)
    for s in sections:
        for row in s.pictures:
            for file, _ in row:
                shutil.copyfile(folder / file, pictures / docs_name(file))
    path.write_text(markdown(sections, machine, missing, folder), encoding="utf-8")
