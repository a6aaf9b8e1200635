"""A window under mouse and keys: balls follow the drag, G makes them mirror or glass, overlays, settings. Needs an X
server.

    test_two_balls.py FOLDER_OF_PROGRAMS
"""
import glob
import os
import subprocess
import sys
import tempfile
import time

from window_events import ESCAPE, TAB, drag, find_window, open_display, press, wait_for

PROGRAMS = sys.argv[1]
SIZE = 128
RIGHT_BUTTON = 3


def pictures(folder):
    """The whole ones so far; the last may be on its way."""
    return sorted(glob.glob(os.path.join(folder, "f*.png")))[:-1]


def at_rest(folder, since):
    """The picture once three in a row are the same, none of the first `since`."""
    found = pictures(folder)[since:][-3:]
    if len(found) < 3:
        return None
    seen = [open(name, "rb").read() for name in found]
    return seen[0] if seen[0] == seen[1] == seen[2] else None


def type_slowly(display, window, text):
    """A key again within 20 ms is no new press to GLFW, but one that repeats."""
    for letter in text:
        press(display, window, ord(letter))
        time.sleep(0.1)


def main():
    display = open_display()
    with tempfile.TemporaryDirectory() as folder:
        log = os.path.join(folder, "log")
        with open(log, "w") as out:
            command = [os.path.join(PROGRAMS, "two_balls"), "--context", "glfw", "--size", f"{SIZE}x{SIZE}",
                       "--row-tolerance", "0.3", "--budget-fps", "0", "--caustic-photons", "256", "--images",
                       os.path.join(folder, "f%06d.png")]
            play = subprocess.Popen(command, stdout=out, stderr=out)

        def running(found):
            assert play.poll() is None, "two_balls ended: " + open(log).read()
            return found

        def rest():
            since = len(pictures(folder)) + 2  # what was drawn before the newest key
            return wait_for("rest", lambda: running(at_rest(folder, since)))

        try:
            window = wait_for("window", lambda: running(find_window(display)))
            wait_for("picture", lambda: running(pictures(folder)))
            press(display, window, ord(" "))  # nothing moves by itself
            seen = rest()
            assert rest() == seen, "nothing was done and the picture changed"
            for what, act in (("the glass ball is a mirror", lambda: press(display, window, ord("g"))),
                              ("the mirror is glass", lambda: [press(display, window, k) for k in (TAB, ord("g"))]),
                              ("a ball is dragged", lambda: drag(display, window, RIGHT_BUTTON, (80, 100), (60, 104))),
                              ("what lights the leaf under the cursor", lambda: press(display, window, ord("l"))),
                              ("what it sees", lambda: press(display, window, ord("v"))),
                              ("the hierarchy", lambda: press(display, window, ord("t"))),
                              ("finer nodes of it", lambda: type_slowly(display, window, "]]]]")),
                              ("no overlay", lambda: press(display, window, ord("o"))),
                              ("brighter lamps", lambda: type_slowly(display, window, "nnn."))):
                act()
                now = rest()
                assert now != seen, what
                seen = now

            def ended():
                press(display, window, ESCAPE)
                return play.poll() is not None
            wait_for("end after Escape", ended)
            assert play.returncode == 0, open(log).read()
        finally:
            play.kill()
    print("balls follow mouse and keys")


main()
