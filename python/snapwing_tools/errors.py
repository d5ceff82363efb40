"""Error of the tools: the user gave something that cannot be used."""


class InputError(Exception):
    """A file or an argument is missing or wrong; the message is one line that names it and says why."""
