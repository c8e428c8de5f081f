"""`python -m kinetostat_cli`."""

from kinetostat_cli.main import main

main()
