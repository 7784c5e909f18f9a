"""``python -m granular_response_paper`` is the command line of the reproduction."""

from .cli import main

if __name__ == "__main__":
    main()
