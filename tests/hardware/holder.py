"""Holds something, so that another program finds it in use.

Usage: holder.py udp PORT [reuse] | listen ADDRESS PORT | pty | tty PATH [exclusive]

Prints "ready" (for pty: the terminal's path, whose other end it keeps) once it has it, and ends
when its standard input does.
"""

import fcntl
import os
import pty
import socket
import sys
import termios


def hold_udp(port, *reuse):
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    if reuse:
        udp.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    udp.bind(("", int(port)))
    return udp, "ready"


def hold_listen(address, port):
    return socket.create_server((address, int(port))), "ready"


def hold_pty():
    master, slave = pty.openpty()
    path = os.ttyname(slave)
    os.close(slave)
    return master, path


def hold_tty(path, *exclusive):
    tty = os.open(path, os.O_RDWR | os.O_NOCTTY)
    if exclusive:
        fcntl.ioctl(tty, termios.TIOCEXCL)
    return tty, "ready"


held, line = globals()["hold_" + sys.argv[1]](*sys.argv[2:])
print(line, flush=True)
sys.stdin.read()
