"""Without OpenEXR there are no reference images to look at: what needs them is skipped, and says so."""

import importlib.util
from pathlib import Path

import pytest


def pytest_collection_modifyitems(items):
    if importlib.util.find_spec("OpenEXR") is None:
        for item in items:
            if Path(__file__).parent in item.path.parents:
                item.add_marker(pytest.mark.skip(reason="python -m pip install 'fogproof[images]'"))
