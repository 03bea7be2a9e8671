"""The exceptions of the package. They correspond to the kinds of error of the program and have the same messages."""


class Error(Exception):
    """The base class of all errors that are not bugs of armwright. The message says what was found, what is allowed and what to do."""


class UsageError(Error, ValueError):
    """A wrong argument, name or configuration (the program's exit code 2)."""


class BadDataError(Error, ValueError):
    """A file or text cannot be used: a robot, test cases, a design, a journal (the program's exit code 4)."""


class BusyError(Error):
    """Another process writes to this folder (the program's exit code 5)."""


class IoError(Error, OSError):
    """The operating system refused to read or write (the program's exit code 74)."""


class ArmwrightWarning(UserWarning):
    """A warning that does not end a run: for example, another version made the run, or its optimizer failed."""
