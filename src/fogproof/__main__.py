"""`python -m fogproof` is the command line."""

from fogproof.cli import main

if __name__ == "__main__":
    main()
