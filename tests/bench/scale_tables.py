#!/usr/bin/env python3
"""Tables of how costs grow, from what gi_scale prints.

    scale_tables.py CSV > scale.md

A table for each kind of world: processor ms of each event and what a row holds, by objects; below it the exponents of
least-squares lines through the logarithms of cost and leaves, over the worlds of at least LEAST_LEAVES leaves.
"""
import csv
import math
import sys

LEAST_LEAVES = 1000
EVENTS = ["first", "one moves", "ten move", "a door turns", "material", "one more", "one less", "one more stays",
          "that one is lit", "that one goes"]
PASSES = ["cut", "factor", "flag", "trace", "close", "solve"]


def read(path):
    """{world: {objects: {(event, measure): value}}}, the same of the pair of halls, the comment of the first line."""
    worlds, pair, about = {}, {}, ""
    with open(path, newline="", encoding="utf-8") as file:
        lines = list(file)
    if lines and lines[0].startswith("#"):
        about = lines.pop(0)[1:].strip()
    for row in csv.DictReader(lines):
        world = pair if row["world"] == "pair" else worlds.setdefault(row["world"], {})
        one = world.setdefault(int(row["objects"]), {})
        one[row["event"], row["measure"]] = float(row["value"])
        if row["event"] == "first":
            one["leaves"] = float(row["leaves"])
    return worlds, pair, about


def exponent(points):
    """Slope of the line through the logarithms; None for fewer than two."""
    points = [(math.log(x), math.log(y)) for x, y in points if x > 0 and y > 0]
    if len(points) < 2:
        return None
    mx = sum(x for x, _ in points) / len(points)
    my = sum(y for _, y in points) / len(points)
    spread = sum((x - mx) ** 2 for x, _ in points)
    return sum((x - mx) * (y - my) for x, y in points) / spread if spread > 0 else None


def number(value):
    if value is None:
        return ""
    return f"{value:.0f}" if value >= 100 else f"{value:.3g}"


def row(cells):
    return "| " + " | ".join(cells) + " |"


def table(head, lines):
    return [row(head), row(["---"] * len(head))] + [row(line) for line in lines]


def costs(world):
    """Processor ms of calls and update together."""
    def of(one, event):
        if (event, "cpu ms") not in one:
            return None
        return one[event, "cpu ms"] + one.get((event, "call cpu ms"), 0)
    events = [e for e in EVENTS if any((e, "cpu ms") in one for one in world.values())]
    lines = [[str(n), number(one["leaves"]), number(one["first", "entries per leaf"]),
              number(one["first", "gpu bytes"] / 2**20)] + [number(of(one, e)) for e in events]
             for n, one in sorted(world.items())]
    large = [one for one in world.values() if one["leaves"] >= LEAST_LEAVES]
    fits = [exponent([(one["leaves"], of(one, e) or 0) for one in large]) for e in events]
    entries = exponent([(one["leaves"], one["first", "entries per leaf"]) for one in large])
    memory = exponent([(one["leaves"], one["first", "gpu bytes"]) for one in large])
    slope = ["exponent", "", number(entries), number(memory)] + [number(f) for f in fits]
    return table(["objects", "leaves", "entries a leaf", "MiB"] + events, lines + [slope])


def passes(world):
    lines = [[str(n), number(one["leaves"])] + [number(one.get(("one moves", p + " ms"))) for p in PASSES]
             for n, one in sorted(world.items())]
    large = [one for one in world.values() if one["leaves"] >= LEAST_LEAVES]
    fits = [exponent([(one["leaves"], one.get(("one moves", p + " ms"), 0)) for one in large]) for p in PASSES]
    return table(["objects", "leaves"] + PASSES, lines + [["exponent", ""] + [number(f) for f in fits]])


def pair_table(pair):
    """A line for each hall of the pair; its first one is that of most objects."""
    measures = [f"{p} ms" for p in PASSES] + ["entries per leaf", "dirty entries", "rays", "ratio"]
    lines = [[str(n), event] + [number(one.get((event, m))) for m in ["cpu ms"] + measures]
             for n, one in sorted(pair.items(), reverse=True) for event in dict.fromkeys(e for e, _ in one)]
    return table(["objects", "what moves", "update"] + PASSES + ["entries a leaf", "dirty entries", "rays", "ratio"],
                 lines)


def main():
    worlds, pair, about = read(sys.argv[1])
    print("# How costs grow\n")
    print(f"Made by `scripts/bench scale --docs`: {about}. Worlds are those of tests/bench/scale_world.h. Processor")
    print("ms, all threads, of the calls and the update that takes them in, medians of some rounds; exponents are of")
    print(f"leaves, over worlds of {LEAST_LEAVES} leaves and more.")
    for name, world in worlds.items():
        print(f"\n## {name.capitalize()}\n")
        print("\n".join(costs(world)))
        print("\nOne mover, ms of each pass:\n")
        print("\n".join(passes(world)))
        print(f"\n![{name}: ms by leaves](pictures/scale-{name}.png)")
    if pair:
        print("\n## Many objects, or few of as many leaves\n")
        print("Two halls of the same size and number of leaves, the boxes of one cut finer instead of being many; one")
        print("box moves, in both in turn. The ratio is the median of the rounds' quotients of processor times, many")
        print("to few.\n")
        print("\n".join(pair_table(pair)))


if __name__ == "__main__":
    main()
