"""Shaders that are edited while gi_play runs: F5 in its window reads them again. Needs an X server (xvfb-run).

    test_reload.py FOLDER_OF_PROGRAMS SOURCES
"""
import ctypes
import ctypes.util
import os
import shutil
import subprocess
import sys
import tempfile
import time

PROGRAMS, SOURCES = sys.argv[1:3]
KEY_PRESS, KEY_RELEASE, F5, ESCAPE = 2, 3, 0xffc2, 0xff1b
SECONDS = 60
AGAIN = "shaders were read again"

x11 = ctypes.CDLL(ctypes.util.find_library("X11") or "libX11.so.6")
WINDOW = ctypes.c_ulong
x11.XOpenDisplay.restype = ctypes.c_void_p
x11.XDefaultRootWindow.argtypes = [ctypes.c_void_p]
x11.XDefaultRootWindow.restype = WINDOW
x11.XQueryTree.argtypes = [ctypes.c_void_p, WINDOW, ctypes.POINTER(WINDOW), ctypes.POINTER(WINDOW),
                           ctypes.POINTER(ctypes.POINTER(WINDOW)), ctypes.POINTER(ctypes.c_uint)]
x11.XFetchName.argtypes = [ctypes.c_void_p, WINDOW, ctypes.POINTER(ctypes.c_char_p)]
x11.XKeysymToKeycode.argtypes = [ctypes.c_void_p, ctypes.c_ulong]
x11.XKeysymToKeycode.restype = ctypes.c_ubyte
x11.XSendEvent.argtypes = [ctypes.c_void_p, WINDOW, ctypes.c_int, ctypes.c_long, ctypes.c_void_p]
x11.XFlush.argtypes = [ctypes.c_void_p]


# The window may be gone while a key is on its way to it.
IGNORE = ctypes.CFUNCTYPE(ctypes.c_int, ctypes.c_void_p, ctypes.c_void_p)(lambda display, error: 0)
x11.XSetErrorHandler(IGNORE)


class KeyEvent(ctypes.Structure):
    """XKeyEvent, as large as XEvent."""
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("window", WINDOW), ("root", WINDOW), ("subwindow", WINDOW),
                ("time", ctypes.c_ulong), ("x", ctypes.c_int), ("y", ctypes.c_int), ("x_root", ctypes.c_int),
                ("y_root", ctypes.c_int), ("state", ctypes.c_uint), ("keycode", ctypes.c_uint),
                ("same_screen", ctypes.c_int), ("pad", ctypes.c_long * 24)]


def find_window(display):
    root, parent, children, count = WINDOW(), WINDOW(), ctypes.POINTER(WINDOW)(), ctypes.c_uint()
    x11.XQueryTree(display, x11.XDefaultRootWindow(display), root, parent, children, count)
    for k in range(count.value):
        name = ctypes.c_char_p()
        if x11.XFetchName(display, children[k], ctypes.byref(name)) and name.value:
            return children[k]
    return None


def press(display, window, key):
    for kind in (KEY_PRESS, KEY_RELEASE):
        event = KeyEvent(type=kind, display=display, window=window, root=x11.XDefaultRootWindow(display),
                         time=int(1000 * time.monotonic()) % 2 ** 31, keycode=x11.XKeysymToKeycode(display, key),
                         same_screen=1)
        x11.XSendEvent(display, window, 1, 1, ctypes.byref(event))
    x11.XFlush(display)


def wait_for(what, found):
    until = time.monotonic() + SECONDS
    while time.monotonic() < until:
        result = found()
        if result:
            return result
        time.sleep(0.1)
    sys.exit("no " + what)


def main():
    display = x11.XOpenDisplay(None)
    if not display:
        sys.exit("no X server")
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
