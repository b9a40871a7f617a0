"""`python -m fogproof` is the command line."""

from fogproof_command import main

if __name__ == "__main__":
    main()
