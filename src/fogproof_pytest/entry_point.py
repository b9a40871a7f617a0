"""What pytest finds under the name `fogproof` in an environment, and leaves out if it is told `-p no:fogproof`.

The plugin itself keeps the name of its package: `-p fogproof_pytest`, or `pytest_plugins` of a conftest, may name it as well.
"""

pytest_plugins = ["fogproof_pytest"]
