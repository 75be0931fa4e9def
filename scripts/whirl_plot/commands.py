"""The commands whirl-plot, whirl-report and whirl-scene of an installed Whirl."""
import sys


def plot():
    from .__main__ import main
    sys.exit(main(sys.argv[1:]))


def report():
    from .report import main
    sys.exit(main(sys.argv[1:]))


def scene():
    from .scene import main
    sys.exit(main(sys.argv[1:]))
