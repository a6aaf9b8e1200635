"""Keys and mouse buttons for a program's window, as an X server hands them out (xvfb-run)."""
import ctypes
import ctypes.util
import sys
import time

KEY_PRESS, KEY_RELEASE, BUTTON_PRESS, BUTTON_RELEASE, MOTION = 2, 3, 4, 5, 6
F5, ESCAPE, TAB = 0xffc2, 0xff1b, 0xff09
SECONDS = 60

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


class Event(ctypes.Structure):
    """XKeyEvent, XButtonEvent or XMotionEvent, as large as XEvent."""
    _fields_ = [("type", ctypes.c_int), ("serial", ctypes.c_ulong), ("send_event", ctypes.c_int),
                ("display", ctypes.c_void_p), ("window", WINDOW), ("root", WINDOW), ("subwindow", WINDOW),
                ("time", ctypes.c_ulong), ("x", ctypes.c_int), ("y", ctypes.c_int), ("x_root", ctypes.c_int),
                ("y_root", ctypes.c_int), ("state", ctypes.c_uint), ("detail", ctypes.c_uint),
                ("same_screen", ctypes.c_int), ("pad", ctypes.c_long * 24)]


def find_window(display):
    root, parent, children, count = WINDOW(), WINDOW(), ctypes.POINTER(WINDOW)(), ctypes.c_uint()
    x11.XQueryTree(display, x11.XDefaultRootWindow(display), root, parent, children, count)
    for k in range(count.value):
        name = ctypes.c_char_p()
        if x11.XFetchName(display, children[k], ctypes.byref(name)) and name.value:
            return children[k]
    return None


def open_display():
    display = x11.XOpenDisplay(None)
    if not display:
        sys.exit("no X server")
    return display


def send(display, window, kind, mask, detail=0, x=0, y=0):
    event = Event(type=kind, display=display, window=window, root=x11.XDefaultRootWindow(display), x=x, y=y,
                  time=int(1000 * time.monotonic()) % 2 ** 31, detail=detail, same_screen=1)
    x11.XSendEvent(display, window, 1, mask, ctypes.byref(event))
    x11.XFlush(display)


def press(display, window, key):
    for kind, mask in ((KEY_PRESS, 1), (KEY_RELEASE, 2)):
        send(display, window, kind, mask, x11.XKeysymToKeycode(display, key))


def drag(display, window, button, begin, end):
    """The mouse goes down at `begin` and up at `end`, pixels."""
    send(display, window, MOTION, 1 << 6, 0, *begin)
    send(display, window, BUTTON_PRESS, 1 << 2, button, *begin)
    time.sleep(0.5)  # whoever looks once a frame sees it down
    send(display, window, MOTION, 1 << 6, 0, *end)
    time.sleep(0.5)
    send(display, window, BUTTON_RELEASE, 1 << 3, button, *end)


def wait_for(what, found):
    until = time.monotonic() + SECONDS
    while time.monotonic() < until:
        result = found()
        if result:
            return result
        time.sleep(0.1)
    sys.exit("no " + what)
