"""Builds the Python modules for pip with setuptools, the one of Debian where pip's own environment has none: no network is needed."""
import sys

try:
    import setuptools.build_meta as _setuptools
except ImportError:
    sys.path.append("/usr/lib/python3/dist-packages")
    import setuptools.build_meta as _setuptools

build_wheel, build_sdist = _setuptools.build_wheel, _setuptools.build_sdist
prepare_metadata_for_build_wheel = _setuptools.prepare_metadata_for_build_wheel


def get_requires_for_build_wheel(config_settings=None):
    return []


def get_requires_for_build_sdist(config_settings=None):
    return []
