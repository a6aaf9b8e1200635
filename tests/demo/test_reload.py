"""Shaders that are edited while gi_play runs: F5 in its window reads them again. Needs an X server (xvfb-run).

    test_reload.py FOLDER_OF_PROGRAMS SOURCES
"""
import os
import shutil
import subprocess
import sys
import tempfile
import time

from window_events import ESCAPE, F5, find_window, open_display, press, wait_for

PROGRAMS, SOURCES = sys.argv[1:3]
AGAIN = "shaders were read again"


def main():
    display = open_display()
    with tempfile.TemporaryDirectory() as folder:
        shaders, log = os.path.join(folder, "shaders"), os.path.join(folder, "log")
        shutil.copytree(os.path.join(SOURCES, "shaders"), shaders)
        shader = os.path.join(shaders, "close.comp")
        with open(shader) as file:
            right = file.read()
        with open(log, "a") as out:
            play = subprocess.Popen([os.path.join(PROGRAMS, "gi_play"),
                                     os.path.join(SOURCES, "demos/scenes/door.gltf"), "--context", "glfw",
                                     "--size", "128x128", "--row-tolerance", "0.3", "--shaders", shaders],
                                    stdout=out, stderr=out)

        def said(line):
            assert play.poll() is None, "gi_play ended: " + open(log).read()
            return line in open(log).read()

        try:
            window = wait_for("window", lambda: find_window(display))
            # The first one says that all is read that is read without a key.
            for text, line in ((right, AGAIN), (right + "\nnonsense\n", "shader close.comp does not compile"),
                               (right, AGAIN)):
                open(log, "w").close()
                with open(shader, "w") as file:
                    file.write(text)

                def pressed():
                    press(display, window, F5)
                    time.sleep(0.5)
                    return said(line)
                wait_for("line '%s' after F5" % line, pressed)

            def ended():
                press(display, window, ESCAPE)
                return play.poll() is not None
            wait_for("end after Escape", ended)
            assert play.returncode == 0, open(log).read()
        finally:
            play.kill()
    print("F5 reads shaders again, broken ones are told")


main()
