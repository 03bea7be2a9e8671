"""What goes wrong for a caller's reason, as exceptions: the program's kinds of error, with the same messages."""


class Error(Exception):
    """Any error of armwright's that is not a bug. The message says what was found, what is allowed and what to do."""


class UsageError(Error, ValueError):
    """A wrong argument, name or configuration (the program's exit code 2)."""


class BadDataError(Error, ValueError):
    """A file or a text that cannot be used: a robot, test cases, a design, a journal (exit code 4)."""


class BusyError(Error):
    """Another process writes this folder (exit code 5)."""


class IoError(Error, OSError):
    """The operating system refused to read or write (exit code 74)."""


class ArmwrightWarning(UserWarning):
    """Something that a user should know, but that does not end a run: another version made it, its optimizer has failed."""
