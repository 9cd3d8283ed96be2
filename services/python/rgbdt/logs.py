"""Logs of lcm-logger."""
import struct

from . import _core, _lcm_types

_TYPES = {getattr(_lcm_types, name)._get_packed_fingerprint(): getattr(_lcm_types, name)
          for name in _lcm_types.__all__}


class LogEvent:
    """One message of a log."""

    __slots__ = ("number", "channel", "receive_utime", "data")

    def __init__(self, raw):
        self.number = raw.number
        self.channel = raw.channel
        self.receive_utime = raw.receive_utime  # the logger's clock: use the message's own utime
        self.data = raw.data

    @property
    def type(self):
        """The LCM type, such as rgbdt.cloud_t, told by the message's first 8 bytes; None: it is
        none of rgbdt's."""
        return _TYPES.get(self.data[:8])

    @property
    def message(self):
        """The message as its LCM type. Raises InputError where it is none of rgbdt's types, or
        shorter than it says."""
        if self.type is None:
            raise _core.InputError(f"{self.channel}: message {self.number} is of no type of rgbdt")
        try:
            return self.type.decode(self.data)
        except (struct.error, ValueError, IndexError, MemoryError, OverflowError) as error:
            raise _core.InputError(
                f"{self.channel}: message {self.number} is damaged: {error}") from error

    @property
    def utime(self):
        """The message's own time [us, UTC]; None where its type has none, or is none of rgbdt's."""
        if self.type is None:
            return None
        return getattr(self.message, "utime", None)

    def arrays(self):
        """An Image, Cloud or FusedCloud with numpy arrays, checked as rgbdt's processes check what
        they hear; None for any other message. Raises InputError for one that they would drop."""
        if self.type is None:
            return None
        return _core.decode_arrays(self.channel, self.data)


class Log:
    """What read_log() gives: iterate it, once."""

    def __init__(self, path):
        self._reader = _core.LogReader(path)

    def __iter__(self):
        return self

    def __next__(self):
        raw = self._reader.next()
        if raw is None:
            raise StopIteration
        return LogEvent(raw)

    @property
    def unreadable_bytes(self):
        """Bytes so far that belong to no whole message, of a log that was cut short or damaged."""
        return self._reader.unreadable_bytes


def read_log(path):
    """The messages of an lcm-logger's log, in order, one at a time: LogEvent after LogEvent. Raises
    InputError where there is no such file or it is no log."""
    return Log(path)
