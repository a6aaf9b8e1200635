"""CONTEXT: what the tests of programs give to --context. RELUME_CONTEXT, else whatever there is without a window."""
import os

if "RELUME_CONTEXT" not in os.environ:
    os.environ.pop("DISPLAY", None)
    os.environ.pop("WAYLAND_DISPLAY", None)
CONTEXT = os.environ.get("RELUME_CONTEXT", "auto")
