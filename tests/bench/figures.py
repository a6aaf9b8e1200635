"""The figures 4, 5 and 6 of Song et al. (README), rendered and measured here: scripts/figures calls this.

    figures.py PROGRAMS [--quick] [--size WxH] [--context KIND] [--out FOLDER] [--docs FILE] [--only 4,5,6]

Runs the programs of the folder PROGRAMS, each step with a line that says what it is and what it took; what they say
goes to FOLDER/log.txt. Then the page: FOLDER/index.html (figures_page.py). A step that cannot run is told, stands on
the page as missing, and the others go on. Exit code 0 when the page is there.
"""
import argparse
import datetime
import os
import pathlib
import platform
import shlex
import subprocess
import sys
import time

import figures_page

MODES = ("direct", "indirect", "global")

# Parts of the picture, in shares of it: what is looked at closely, and how many times it is enlarged at 512 pixels.
CROPS = {"shadow": ("0.63,0.80,0.91,0.94", 3), "bleeding": ("0.20,0.64,0.56,0.94", 2)}
CAUSTIC_CROP = ("0.54,0.71,0.76,0.94", 4)


# Figure 4 is about how right pictures can be: leaves as fine as folds, shadows of what is drawn.
FINE = ["--levels", "1", "--fine-shadows", "--shadow-map", "2048"]


class Amount:
    """How much of everything: of a whole run, of --quick, and of the test's."""

    def __init__(self, quick, size):
        tiny = size and max(size) < 200
        self.size = size or ((320, 320) if quick else (640, 640))
        self.direct, self.paths, self.balls = (4, 2, 2) if tiny else (32, 16, 16) if quick else (192, 64, 64)
        self.frames = 3 if tiny else 12 if quick else 24
        self.rate_size = self.size if tiny else (512, 512)
        self.tests = not tiny
        self.quick = quick or bool(tiny)
        self.options = ["--row-tolerance", "0.2"] if tiny else []
        self.fine = [] if tiny else FINE


class Run:
    def __init__(self, programs, folder, context):
        self.programs, self.folder, self.context = programs, folder, context
        self.missing = []  # (what, why)
        self.outputs = {}  # what a step printed, by its name
        self.began = time.monotonic()
        self.log = open(folder / "log.txt", "w", encoding="utf-8")

    def step(self, name, program, *arguments, environment=None):
        """Runs a program; True when it did what it should."""
        path = self.programs / program
        command = [str(path), *map(str, arguments)]
        print(f"  {name} ...", end="", flush=True, file=sys.stderr)
        began = time.monotonic()
        if not path.exists():
            return self.give_up(name, f"{program} is not built here")
        done = subprocess.run(command, capture_output=True, text=True, check=False, errors="replace",
                              env=dict(os.environ, **(environment or {})))
        took = time.monotonic() - began
        self.log.write(f"$ {shlex.join(command)}\n{done.stdout}{done.stderr}[{done.returncode}, {took:.1f} s]\n\n")
        self.log.flush()
        self.outputs[name] = done.stdout
        if done.returncode:
            words = (done.stderr.strip() or done.stdout.strip() or f"exit code {done.returncode}").splitlines()[-1]
            return self.give_up(name, words)
        print(f" {took:.1f} s", file=sys.stderr)
        return True

    def give_up(self, name, why):
        print(f" missing: {why}", file=sys.stderr)
        self.missing.append((name, why))
        return False

    def path(self, name):
        return self.folder / name


def size_text(size):
    return "%dx%d" % size


def render_ours(run, amount, scene, mode, name, *more):
    """NAME.png and .pfm of the demo's first frame."""
    done = run.step(f"our picture, {scene}, {mode} light", scene, "--context", run.context, "--frames", 1, "--size",
                    size_text(amount.size), "--mode", mode, "--estimate", 0, "--images", run.path(name + "%d.png"),
                    "--linear", run.path(name + "%d.pfm"), "--report", run.path(name + ".csv"), *amount.options,
                    *more)
    for ending in (".png", ".pfm") if done else ():
        run.path(f"{name}0{ending}").rename(run.path(name + ending))
    return done


def render_truth(run, amount, scene, mode, samples, name):
    return run.step(f"path-traced truth, {scene}, {mode} light, {samples} paths a pixel", "offline_trace", "--context",
                    run.context, "--scene", scene, "--light", mode, "--size", size_text(amount.size), "--samples",
                    samples, "--out", run.path(name + ".png"), "--linear", run.path(name + ".pfm"))


def crop(run, name, part, times, to):
    times = max(1, round(times * 512 / figures_page.png_size(run.path(name))[0])) if run.path(name).exists() else 1
    return run.path(name).exists() and run.step(f"crop {to}", "figure_numbers", "crop", run.path(name), part, times,
                                                run.path(to))


def compare(run, ours, truth, to):
    if run.path(ours).exists() and run.path(truth).exists():
        run.step(f"difference {to}", "figure_numbers", "difference", run.path(ours), run.path(truth), run.path(to))


def figure_four(run, amount):
    for folder in ("ours", "truth"):
        run.path(folder).mkdir(exist_ok=True)
    ours = all([render_ours(run, amount, "moving_buddha", mode, f"ours/{mode}", *amount.fine) for mode in MODES])
    truth = all([render_truth(run, amount, "buddha", mode, amount.direct if mode == "direct" else amount.paths,
                              f"truth/{mode}") for mode in MODES])
    for what, (part, times) in CROPS.items():
        for mode in MODES:
            crop(run, f"ours/{mode}.png", part, times, f"{what}_{mode}.png")
        crop(run, "truth/global.png", part, times, f"{what}_truth.png")
    compare(run, "ours/global.pfm", "truth/global.pfm", "difference4.png")
    if ours:
        run.step("numbers of figure 4", "figure_numbers", "four", run.path("ours"),
                 run.path("truth") if truth else "-", run.path("figure4.csv"))
    if amount.tests:
        run.step("soft shadow against a closed form", "test_draw", environment={"RELUME_TEST": "test_soft_shadow"})


def figure_five(run, amount):
    ours = render_ours(run, amount, "two_balls", "global", "balls")
    truth = render_truth(run, amount, "two_balls", "global", amount.balls, "balls_truth")
    crop(run, "balls.png", *CAUSTIC_CROP, "caustic.png")
    crop(run, "balls_truth.png", *CAUSTIC_CROP, "caustic_truth.png")
    compare(run, "balls.pfm", "balls_truth.pfm", "difference5.png")
    if ours:
        run.step("numbers of figure 5", "figure_numbers", "five", run.path("balls.pfm"),
                 run.path("balls_truth.pfm") if truth else "-", run.path("figure5.csv"))
    if amount.tests:
        run.step("energy of caustics against light tracing", "test_caustics", environment={"RELUME_TEST": "*_flux"})
    frames = ["--context", run.context, "--frames", amount.frames, "--size", size_text(amount.rate_size), "--estimate",
              0, "--images", run.path("moving%03d.png"), *amount.options]
    run.step("both balls move, exact", "two_balls", *frames, "--report", run.path("exact_frames.csv"))
    run.step("both balls move, 10 frames a second asked for", "two_balls", *frames, "--budget-fps", 10, "--report",
             run.path("budget_frames.csv"))
    for number in range(amount.frames):
        picture = run.path(f"moving{number:03d}.png")
        if number + 1 < amount.frames and picture.exists():
            picture.unlink()
    last = run.path(f"moving{amount.frames - 1:03d}.png")
    if last.exists():
        last.replace(run.path("balls_moving.png"))


def figure_six(run, amount):
    more = ["--quick"] if amount.quick else []
    run.step("frames a second by mesh, three methods", "figure_six", "--out", run.folder, "--context", run.context,
             *more)


def describe_machine(run, amount):
    about = pathlib.Path("/proc/cpuinfo")
    lines = about.read_text(encoding="utf-8", errors="replace").splitlines() if about.exists() else []
    processor = next((line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")), "")
    printed = "\n".join(run.outputs.values()).splitlines()
    renderer = next((line.split(",", 1)[1].strip() for line in printed if " frames of " in line and "OpenGL" in line),
                    "not known")
    git = subprocess.run(["git", "-C", str(run.programs.parent), "describe", "--always", "--dirty"], text=True,
                         capture_output=True, check=False)
    return {"processor": f"{os.cpu_count()} x {processor or platform.machine()}", "renderer": renderer,
            "commit": git.stdout.strip() or "not known", "date": datetime.date.today().isoformat(),
            "pictures": size_text(amount.size), "run": "--quick" if amount.quick else "whole",
            "took": f"{(time.monotonic() - run.began) / 60:.1f} minutes"}


def size_of(text):
    try:
        width, height = map(int, text.split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError(f"{text} is not WIDTHxHEIGHT")
    if not (16 <= width <= 4096 and width == height):
        raise argparse.ArgumentTypeError("pictures are square, of 16 to 4096 pixels a side")
    return width, height


def parse():
    parser = argparse.ArgumentParser(prog="scripts/figures", description=__doc__.splitlines()[0])
    parser.add_argument("programs", type=pathlib.Path, help=argparse.SUPPRESS)
    parser.add_argument("--quick", action="store_true", help="smaller pictures, fewer paths: minutes become one or two")
    parser.add_argument("--size", type=size_of, metavar="WxH", help="pixels of the pictures (640x640, --quick 320x320)")
    parser.add_argument("--context", default="auto", help="auto, egl, osmesa or glfw (auto, without a window)")
    parser.add_argument("--out", type=pathlib.Path, default=pathlib.Path("out/figures"), metavar="FOLDER")
    parser.add_argument("--only", default="4,5,6", metavar="N,N", help="these figures alone")
    parser.add_argument("--docs", type=pathlib.Path, metavar="FILE", help="the page as Markdown too, pictures beside "
                                                                          "it")
    return parser.parse_args()


def main():
    options = parse()
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):  # "auto" would open a window
        if options.context == "auto":
            os.environ.pop(name, None)
    options.out.mkdir(parents=True, exist_ok=True)
    amount = Amount(options.quick, options.size)
    run = Run(options.programs.resolve(), options.out.resolve(), options.context)
    for number, make in (("4", figure_four), ("5", figure_five), ("6", figure_six)):
        if number in options.only.split(","):
            print(f"figure {number}", file=sys.stderr)
            make(run, amount)
    sections = figures_page.read_sections(run.folder, run.outputs)
    machine = describe_machine(run, amount)
    page = run.path("index.html")
    page.write_text(figures_page.html(sections, machine, run.missing), encoding="utf-8")
    if options.docs:
        figures_page.write_docs(sections, machine, run.missing, run.folder, options.docs)
    for what, why in run.missing:
        print(f"missing: {what}: {why}", file=sys.stderr)
    print(f"{machine['took']}; open {os.path.relpath(page)}", file=sys.stderr)


if __name__ == "__main__":
    main()
