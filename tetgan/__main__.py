"""`python -m tetgan`, the same as the command."""

from tetgan.cli import main

main()
