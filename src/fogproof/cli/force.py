"""The option of every command that writes into a folder; `reports.prepare_folder` is the rule behind it."""

import click

FORCE = click.option("--force", is_flag=True, help="Replace files in the folder that fogproof did not write.")
