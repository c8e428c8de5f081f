"""The command line of kinetostat: parse, call the library, render, exit."""
