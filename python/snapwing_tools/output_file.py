"""Files that a tool writes: checked before the work, written whole or not at all; the same rules as the snapwing program.

A name is followed through links. Pipes, terminals, /dev/null and /dev/stdout are written through and never replaced. A
regular file is replaced in one step."""

import contextlib
import errno
import io
import os
import stat
import sys
import time

from snapwing_tools.errors import InputError


def _status(path):
    try:
        return os.stat(path)
    except OSError:
        return None


def resolved(path):
    """Path without links, of a file that may not exist yet."""
    try:
        return os.path.realpath(path)
    except OSError:
        raise InputError("{}: the working folder no longer exists".format(path))


def _stream_of(status):
    """The standard stream (1 or 2) that leads to the same file, or None: replacing it would lose what is printed."""
    for number in (1, 2):
        try:
            if os.path.samestat(os.fstat(number), status):
                return number
        except OSError:
            pass
    return None


def _written_through(status):
    return status is not None and (not stat.S_ISREG(status.st_mode) or _stream_of(status) is not None)


def require_writable(path):
    """Raises InputError if `path` cannot be written."""
    target, status = resolved(path), _status(path)
    if status is not None:
        for test, what in ((stat.S_ISDIR, "a folder"), (stat.S_ISBLK, "a disk"), (stat.S_ISSOCK, "a socket")):
            if test(status.st_mode):
                raise InputError("cannot write {}: is {}, not a file".format(path, what))
        if _stream_of(status) is not None:
            return
        if not os.access(path, os.W_OK):
            raise InputError("cannot write {}: it is protected".format(path))
        if _written_through(status):
            return
    folder = os.path.dirname(target)
    if not os.path.isdir(folder):
        raise InputError("cannot write {}: its folder does not exist".format(path))
    if not os.access(folder, os.W_OK | os.X_OK):
        raise InputError("cannot write {}: its folder cannot be written to".format(path))


def require_folder(path):
    """Raises InputError if a folder cannot be made or written to."""
    above = resolved(path)
    while not os.path.exists(above) and os.path.dirname(above) != above:
        above = os.path.dirname(above)
    if not os.path.isdir(above):
        raise InputError("{}: '{}' is not a folder".format(path, above))
    if not os.access(above, os.W_OK | os.X_OK):
        raise InputError("{}: cannot be written to".format(path))


class OutputFiles:
    """All files of one run of a tool, so that none destroys another."""

    def __init__(self, reads=()):
        self.inputs = [path for path in reads if path]
        self.outputs = []

    @staticmethod
    def _same(one, other):
        a, b = _status(one), _status(other)
        if any(status is not None and stat.S_ISCHR(status.st_mode) for status in (a, b)):
            return False  # a terminal or /dev/null takes any number
        return os.path.samestat(a, b) if a is not None and b is not None else resolved(one) == resolved(other)

    def writes(self, path, option):
        """States an output; raises InputError if it cannot be written, or is an input or another output."""
        if not path:
            return
        path = os.fspath(path)
        for other in self.inputs:
            if self._same(path, other):
                raise InputError("{}: {} would overwrite an input".format(path, option))
        for other, name in self.outputs:
            if self._same(path, other):
                raise InputError("{}: {} and {} are one file".format(path, option, name))
        require_writable(path)
        self.outputs.append((path, option))


def write_file(path, content):
    """Writes text or bytes. Raises InputError naming `path`: what was there before is as it was."""
    path = os.fspath(path)
    require_writable(path)
    data = content.encode("utf-8", "surrogateescape") if isinstance(content, str) else content
    status = _status(path)
    try:
        if _written_through(status):
            _write_through(path, status, data)
        else:
            _replace(resolved(path), status, data)
    except OSError as error:
        raise InputError("cannot write {}: {}".format(path, error.strerror or error))


def save_picture(figure, path, dpi=100):
    """A matplotlib figure in the format of the name's ending, PNG without one."""
    stream = io.BytesIO()
    form = os.path.splitext(os.fspath(path))[1][1:].lower() or "png"
    if form not in ("png", "pdf", "svg"):
        raise InputError("{}: a picture's name ends in .png, .pdf or .svg".format(path))
    figure.savefig(stream, dpi=dpi, format=form)
    write_file(path, stream.getvalue())


def _open_through(path, pipe):
    """Opens what is there. A pipe without a reader would hold the program for ever: it waits a minute."""
    flags = os.O_WRONLY | os.O_NOCTTY
    end = time.monotonic() + 60
    while pipe:
        try:
            file = os.open(path, flags | os.O_NONBLOCK)
            os.set_blocking(file, True)
            return file
        except OSError as error:
            if error.errno != errno.ENXIO:
                raise
            if time.monotonic() > end:
                raise InputError("cannot write {}: nobody reads from this pipe".format(path))
            time.sleep(0.05)
    return os.open(path, flags)


def _write_through(path, status, data):
    sys.stdout.flush()
    number = _stream_of(status)
    file = os.dup(number) if number is not None else _open_through(path, stat.S_ISFIFO(status.st_mode))
    with os.fdopen(file, "wb") as stream:
        stream.write(data)


def _replace(target, status, data):
    part = "{}.part{}".format(target, os.getpid())
    try:
        with open(part, "wb") as stream:
            stream.write(data)
            stream.flush()
            os.fsync(stream.fileno())
        if status is not None:
            os.chmod(part, stat.S_IMODE(status.st_mode))
        os.replace(part, target)
    finally:
        if os.path.exists(part):
            os.unlink(part)


class _Printed:
    """A stream whose reader may go away: what it cannot take is dropped and remembered, the work goes on."""

    def __init__(self, stream):
        self.stream, self.error = stream, None

    def _try(self, action, *arguments):
        try:
            if self.error is None:
                return action(*arguments)
        except OSError as error:
            self.error = error
        return None

    def write(self, text):
        self._try(self.stream.write, text)
        return len(text)

    def flush(self):
        self._try(self.stream.flush)

    def __getattr__(self, name):
        return getattr(self.stream, name)


def printing(work, name):
    """Exit code of work(); 2 if what it printed did not arrive, except at a reader that has gone, as `| head`."""
    printed = _Printed(sys.stdout)
    with contextlib.redirect_stdout(printed):
        code = work()
        printed.flush()
    if printed.error is None:
        return code
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)  # Python would try to write the rest once more at its end
    if isinstance(printed.error, BrokenPipeError):
        return code
    print("{}: the standard output cannot be written: {}".format(name, printed.error.strerror), file=sys.stderr)
    return code or 2
