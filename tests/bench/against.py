"""Another commit and this tree in turn: what frames of the moving Buddha take, and what the first picture takes.

    scripts/bench against COMMIT [options]

The other commit is unpacked and built in build/against/<hash>, which is kept: a second run builds nothing. The same
program (frame_times.c) is linked with either library. Prints Markdown on stdout, progress on stderr.
"""
import argparse
import collections
import datetime
import os
import pathlib
import platform
import shlex
import shutil
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
HERE = ROOT / "tests" / "bench"

Side = collections.namedtuple("Side", "name commit folder frame_times")


def say(text):
    print(text, file=sys.stderr, flush=True)


def fail(text):
    say("scripts/bench against: " + text)
    sys.exit(1)


def git(*arguments, failure=None):
    done = subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, check=False)
    if done.returncode:
        fail(failure or "git %s: %s" % (" ".join(arguments), done.stderr.strip()))
    return done.stdout.strip()


def describe(commit):
    return git("log", "-1", "--format=%h of %cs", commit)


# ---- the other commit -----------------------------------------------------------------------------------------------


def unpack(commit, source):
    """Whole or not at all: what an interrupted run left behind is not taken for the commit."""
    if source.exists():
        return
    partial = source.with_name("partial")
    shutil.rmtree(partial, ignore_errors=True)
    partial.mkdir(parents=True)
    archive = subprocess.Popen(["git", "-C", str(ROOT), "archive", commit], stdout=subprocess.PIPE)
    unpacked = subprocess.run(["tar", "-x", "-C", partial], stdin=archive.stdout, check=False)
    archive.stdout.close()  # git ends where tar did not read to the end
    if archive.wait() or unpacked.returncode:
        fail("could not unpack %s" % commit)
    partial.rename(source)


def run_quietly(command, what):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
    if done.returncode:
        say(done.stdout[-6000:])
        fail(what)


def build_other(revision):
    commit = git("rev-parse", "--verify", "--end-of-options", revision + "^{commit}",
                 failure="%s is no commit of this repository" % revision)
    folder = ROOT / "build" / "against" / commit
    source, build = folder / "source", folder / "build"
    say("building %s in %s" % (commit[:7], folder.relative_to(ROOT)))
    unpack(commit, source)
    run_quietly(["cmake", "-S", source, "-B", build, "-G", "Ninja", "-DCMAKE_BUILD_TYPE=RelWithDebInfo",
                 "-DRELUME_TESTS=OFF", "-DCMAKE_PROJECT_relume_INCLUDE=%s" % (HERE / "against.cmake")],
                "%s cannot be configured here" % commit[:7])
    run_quietly(["cmake", "--build", build, "--target", "frame_times_against", "moving_buddha"],
                "%s cannot be built here; frame_times.c needs the gi.h and the scenes of 4a87701 or later" % commit[:7])
    return Side("old", describe(commit), build / "bin", build / "bin" / "frame_times_against")


def this_tree():
    build = ROOT / "build" / "bin"
    changed = ", with uncommitted changes" if git("status", "--porcelain", "--untracked-files=no") else ""
    return Side("new", describe("HEAD") + changed, build, build / "frame_times")


# ---- measuring ------------------------------------------------------------------------------------------------------


class Measurements:
    """values[series, measure][side name]: what was measured, in the order in which it first came."""

    def __init__(self):
        self.values = {}
        self.renderers = {}

    def add(self, series, measure, side, value):
        self.values.setdefault((series, measure), {}).setdefault(side.name, []).append(value)

    def add_lines(self, side, text):
        """What frame_times prints."""
        lines = text.splitlines()
        self.renderers[side.name] = lines[0].removeprefix("# ")
        for line in lines[2:]:
            series, measure, value = line.split(",")
            self.add(series, measure, side, float(value))

    def of(self, series, measure, side_name):
        return self.values.get((series, measure), {}).get(side_name, [])

    def measures(self, series):
        return [measure for of, measure in self.values if of == series]


def environment(cache, with_cache):
    """No window; a shader cache of its own, so that nothing of earlier runs is in it, or none at all."""
    result = {name: value for name, value in os.environ.items() if name not in ("DISPLAY", "WAYLAND_DISPLAY")}
    result["XDG_CACHE_HOME"] = result["MESA_SHADER_CACHE_DIR"] = str(cache)
    if not with_cache:
        result["MESA_SHADER_CACHE_DISABLE"] = "true"
    return result


def run(command, **more):
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=False, **more)
    if done.returncode:
        words = shlex.join(str(word) for word in command)
        fail("%s ended with %d: %s" % (words, done.returncode, done.stderr.strip()))
    return done.stdout


def measure_frames(side, options, cache, into):
    command = [side.frame_times, "--context", options.context, "--frames", options.frames, "--rebuilds",
               options.rebuilds, "--size", options.size]
    if options.row_tolerance:
        command += ["--row-tolerance", options.row_tolerance]
    into.add_lines(side, run(command, env=environment(cache, True)))


def first_picture_ms(side, options, cache, with_cache):
    """From the start of the process until it has ended, its first picture written and nothing else."""
    with tempfile.TemporaryDirectory() as folder:
        command = [side.folder / "moving_buddha", "--context", options.context, "--frames", "1", "--row-tolerance",
                   options.start_row_tolerance, "--size", "%dx%d" % (options.size, options.size), "--out", folder,
                   "--report", os.path.join(folder, "report.csv"), "--images", os.path.join(folder, "%d.png")]
        began = time.monotonic()
        run(command, env=environment(cache, with_cache))
        return 1e3 * (time.monotonic() - began)


def measure_start(side, options, cache, into):
    with tempfile.TemporaryDirectory() as empty:
        into.add("start", "no shader cache ms", side, first_picture_ms(side, options, empty, False))
    into.add("start", "shaders cached ms", side, first_picture_ms(side, options, cache, True))


def measure(sides, options):
    into = Measurements()
    with tempfile.TemporaryDirectory() as caches:
        for side in sides:
            say("filling the shader cache of %s" % side.name)
            os.mkdir(os.path.join(caches, side.name))
            first_picture_ms(side, options, os.path.join(caches, side.name), True)
        for k in range(options.rounds):
            for side in sides:
                say("round %d of %d, %s" % (k + 1, options.rounds, side.name))
                cache = os.path.join(caches, side.name)
                measure_start(side, options, cache, into)
                measure_frames(side, options, cache, into)
    return into


# ---- the page -------------------------------------------------------------------------------------------------------


def cpu_model():
    try:
        for line in open("/proc/cpuinfo"):
            if line.startswith("model name"):
                return line.split(":", 1)[1].strip()
    except OSError:
        pass
    return platform.processor() or platform.machine()


def number(value):
    return "%.0f" % value if value >= 1000 else "%.1f" % value if value >= 10 else "%.2f" % value


def ratio(old, new):
    return "%.2f" % (old / new) if new > 0 else ""


def cells(old, new):
    """Median and least of both, and the ratios; a pass that one side does not have is left open."""
    sides = [(statistics.median(v), min(v)) if v else None for v in (old, new)]
    texts = [number(side[k]) if side else "" for side in sides for k in (0, 1)]
    ratios = [ratio(sides[0][k], sides[1][k]) if all(sides) else "" for k in (0, 1)]
    return texts + ratios


def table(measurements, series):
    lines = ["| ms | old, median | old, least | new, median | new, least | old/new, medians | old/new, least |",
             "|---|---|---|---|---|---|---|"]
    for measure_name in measurements.measures(series):
        if not measure_name.endswith(" ms"):
            continue
        row = cells(*(measurements.of(series, measure_name, name) for name in ("old", "new")))
        lines.append("| %s | %s |" % (measure_name.removesuffix(" ms"), " | ".join(row)))
    return lines


def scene_line(measurements, series):
    """What was computed, so that nobody compares two different things."""
    texts = []
    for measure_name in measurements.measures(series):
        if measure_name.endswith(" ms") or measure_name == "row tolerance":
            continue
        old, new = (statistics.median(measurements.of(series, measure_name, name) or [0]) for name in ("old", "new"))
        texts.append("%s %s" % (measure_name, "%.0f" % old if old == new else "%.0f (old), %.0f (new)" % (old, new)))
    return "; ".join(texts) + "."


def page(sides, options, m):
    size = "%d x %d" % (options.size, options.size)
    fine = statistics.median(m.of("fine", "row tolerance", "new"))
    renderers = list(dict.fromkeys(m.renderers[side.name] for side in sides))
    lines = ["# %s against %s" % tuple(side.commit.split(" ")[0] for side in reversed(sides)), "",
             *("- %s: %s" % (side.name, side.commit) for side in sides),
             *("- renderer: %s" % renderer for renderer in renderers),
             "- processor: %s, %d threads" % (cpu_model(), len(os.sched_getaffinity(0))),
             "- date: %s; load of the machine before: %.2f" % (datetime.date.today().isoformat(), options.load),
             "- command: `scripts/bench against %s`" % shlex.join(sys.argv[1:]),
             "- %d rounds in turn, each with moving frames: %d, rebuilds: %d" %
             (options.rounds, options.frames, options.rebuilds)]
    for series, title in (("fine", "defaults, row tolerance %g" % fine),
                          ("coarse", "row tolerance 0.1, emitters four times finer, one ray an indirect entry")):
        lines += ["", "## Moving Buddha, " + title, "", scene_line(m, series), "", *table(m, series)]
    lines += ["", "frame: update and picture of %s, both waited for. from nothing: objects, refinement, hierarchies, "
              "trees, rows and a cold solve; shaders are compiled before." % size]
    lines += ["", "## From the start of the process to its first picture, %s, row tolerance %g" %
              (size, options.start_row_tolerance), "", "Until the process has ended, its picture written as a PNG.", "",
              *table(m, "start")]
    return "\n".join(lines)


def parse():
    parser = argparse.ArgumentParser(prog="scripts/bench against", description=__doc__.split("\n")[0])
    parser.add_argument("commit", help="the other commit: a hash, a branch, a tag")
    parser.add_argument("--rounds", type=int, default=5, help="of both in turn (%(default)s)")
    parser.add_argument("--frames", type=int, default=6, help="moving frames a round (%(default)s)")
    parser.add_argument("--rebuilds", type=int, default=2,
                        help="rebuilds and starts from nothing a round (%(default)s)")
    parser.add_argument("--quick", action="store_true", help="2 rounds of 2 frames and 1 rebuild")
    parser.add_argument("--size", type=int, default=512, help="width and height of the picture (%(default)s)")
    parser.add_argument("--row-tolerance", type=float, help="of the first table (the library's default)")
    parser.add_argument("--start-row-tolerance", type=float, default=0.05, help="of the first picture (%(default)s)")
    parser.add_argument("--context", default="auto", choices=("auto", "egl", "osmesa"),
                        help="where it runs; auto: headless (%(default)s)")
    options = parser.parse_args()
    if options.quick:
        options.rounds, options.frames, options.rebuilds = 2, 2, 1
    if min(options.rounds, options.frames, options.rebuilds) < 1:
        parser.error("--rounds, --frames and --rebuilds are at least 1")
    options.load = os.getloadavg()[0]
    return options


def main():
    options = parse()
    sides = [build_other(options.commit), this_tree()]
    print(page(sides, options, measure(sides, options)))


if __name__ == "__main__":
    main()
