"""Stops processes for a while: pause.py handler|process SECONDS PID...
`handler`: only the thread that handles messages, as if it computed for so long; the one that receives
goes on (ptrace). `process`: all of it, as on a machine that has no time for it (SIGSTOP).
Prints when it began and when it ended, in seconds of the monotonic clock."""

import ctypes
import os
import signal
import sys
import time

SEIZE, INTERRUPT, DETACH = 0x4206, 0x4207, 17  # sys/ptrace.h
WALL = 0x40000000  # sys/wait.h: threads, too

libc = ctypes.CDLL(None, use_errno=True)
libc.ptrace.restype = ctypes.c_long
libc.ptrace.argtypes = [ctypes.c_long, ctypes.c_long, ctypes.c_void_p, ctypes.c_void_p]


def ptrace(request, pid):
    if libc.ptrace(request, pid, None, None) != 0:
        number = ctypes.get_errno()
        sys.exit(f"pause.py: cannot hold thread {pid}: {os.strerror(number)}")


def hold(pid):
    """The thread that handles messages is the process's first: its number is the process's."""
    ptrace(SEIZE, pid)
    ptrace(INTERRUPT, pid)
    os.waitpid(pid, WALL)


def main():
    what, seconds, pids = sys.argv[1], float(sys.argv[2]), [int(pid) for pid in sys.argv[3:]]
    begin = time.monotonic()
    for pid in pids:
        hold(pid) if what == "handler" else os.kill(pid, signal.SIGSTOP)
    time.sleep(seconds)
    end = time.monotonic()
    for pid in pids:
        ptrace(DETACH, pid) if what == "handler" else os.kill(pid, signal.SIGCONT)
    print(f"{begin:.3f},{end:.3f}")


main()
