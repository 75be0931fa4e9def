"""The version of the Python modules is that of the program: project(whirl VERSION ...) in CMakeLists.txt."""
import pathlib
import re

from setuptools import setup

text = (pathlib.Path(__file__).resolve().parents[1] / "CMakeLists.txt").read_text(encoding="utf-8")
setup(version=re.search(r"project\(whirl VERSION ([\d.]+)", text)[1])
