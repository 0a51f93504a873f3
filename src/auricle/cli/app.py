"""The `auricle` command: one line for a fault, an exit code by its kind, help at once."""

import os
import sys
from pathlib import Path
from typing import Annotated

import typer

from auricle import __version__
from auricle.cli.commands import COMMANDS
from auricle.cli.settings import read_settings
from auricle.errors import AuricleError

EXIT_INTERRUPTED = 130
EXIT_FAILURE = 1

app = typer.Typer(
    name="auricle",
    no_args_is_help=True,
    rich_markup_mode="markdown",
    pretty_exceptions_enable=False,
    context_settings={"auto_envvar_prefix": "AURICLE", "help_option_names": ["-h", "--help"]},
)
for _name, _command in COMMANDS.items():
    app.command(_name)(_command)


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"auricle {__version__}")
        raise typer.Exit


@app.callback()
def _main_options(
    context: typer.Context,
    config: Annotated[
        Path | None,
        typer.Option(
            envvar="AURICLE_CONFIG",
            help="TOML file with a table for each command; options and environment go before it.",
        ),
    ] = None,
    version: Annotated[
        bool, typer.Option("--version", callback=_print_version, is_eager=True, help="Show it.")
    ] = False,
) -> None:
    """How many points a cardiac map needs, where, and how sure.

    Research software, not a medical device.

    Example: `auricle atrium -o atrium.vtp && auricle analyze atrium.vtp -o result`
    """
    del version  # its callback has answered
    if config is not None:
        context.default_map = read_settings(config)


def main() -> None:
    """Run the command line; every known fault ends in one line and its exit code."""
    try:
        app()
    except AuricleError as fault:
        _end(str(fault), fault.exit_code)
    except KeyboardInterrupt:
        _end("interrupted", EXIT_INTERRUPTED)
    except MemoryError:
        _end("out of memory: give a smaller surface or ask for fewer harmonics", EXIT_FAILURE)
    except Exception as fault:
        if os.environ.get("AURICLE_DEBUG"):
            raise
        _end(
            f"internal fault ({type(fault).__name__}: {fault}): run again with AURICLE_DEBUG=1 "
            "and report what it shows",
            EXIT_FAILURE,
        )


def _end(message: str, code: int) -> None:
    line = " ".join(message.split())
    typer.echo(f"auricle: {line}", err=True)
    sys.exit(code)
