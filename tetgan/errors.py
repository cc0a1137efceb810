"""The exception whose message is meant for users."""


class UserError(Exception):
    """A bad config, file or argument.

    The message is one line: it names the key, file or value and the remedy. The command line prints it
    without a traceback and exits with status 2.
    """
