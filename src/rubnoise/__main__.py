"""`python -m rubnoise` is the command line."""

from rubnoise.cli.app import main

if __name__ == "__main__":
    main()
