"""`python -m auricle`: the same as the `auricle` command."""

from auricle.cli.app import main

main()
