"""A GigE Vision camera as far as its search goes: says who it is and who controls it.

Usage: gvcp_camera.py INTERFACE CONTROL ADDRESS/PREFIX=SERIAL...

CONTROL is what the register of the control channel's privilege holds: 0, 1 (exclusive) or 2;
"denied" refuses its reading. Several cameras may answer from one place. Prints "ready" once it can
be asked, and ends when its standard input does. Bytes as GigE Vision 1.2 lays them out; shares
nothing with the driver.
"""

import ipaddress
import select
import socket
import struct
import sys

PORT = 3956
DISCOVERY, DISCOVERY_ACK = 0x0002, 0x0003
READ_REGISTER, READ_REGISTER_ACK = 0x0080, 0x0081
ACCESS_DENIED = 0x8006


def registers(interface, serial):
    """The first 248 bytes of the bootstrap registers."""
    memory = bytearray(248)
    struct.pack_into(">HH", memory, 0x00, 1, 2)  # version 1.2
    memory[0x0A:0x10] = bytes.fromhex("00111c001234")
    memory[0x24:0x28] = interface.ip.packed
    memory[0x34:0x38] = interface.netmask.packed
    for at, size, text in (
        (0x48, 32, "Acme"),
        (0x68, 32, "Fieldcam 3"),
        (0x88, 32, "1.0"),
        (0xD8, 16, serial),
        (0xE8, 16, "left"),
    ):
        memory[at : at + size] = text.encode().ljust(size, b"\0")
    return bytes(memory)


def answer(request, cameras, control):
    """The answers to one request: (status, command, data) of each."""
    key, flags, command, length, _ = struct.unpack(">BBHHH", request[:8])
    assert key == 0x42 and flags & 0x01 and length == len(request) - 8, request
    if command == DISCOVERY and length == 0:
        return [(0, DISCOVERY_ACK, registers(*camera)) for camera in cameras]
    assert command == READ_REGISTER and request[8:] == struct.pack(">I", 0x0A00), request
    if control == "denied":
        return [(ACCESS_DENIED, READ_REGISTER_ACK, b"")]
    return [(0, READ_REGISTER_ACK, struct.pack(">I", int(control)))]


def reachable(cameras, sender):
    return any(ipaddress.ip_address(sender) in interface.network for interface, _ in cameras)


def main():
    name, control = sys.argv[1:3]
    cameras = []
    for argument in sys.argv[3:]:
        address, serial = argument.split("=")
        cameras.append((ipaddress.ip_interface(address), serial))
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.setsockopt(socket.SOL_SOCKET, socket.SO_BROADCAST, 1)
    udp.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, name.encode())
    udp.bind(("", PORT))
    print("ready", flush=True)
    while True:
        readable, _, _ = select.select([udp, sys.stdin], [], [])
        if sys.stdin in readable:
            return
        request, (host, port) = udp.recvfrom(2048)
        # To another subnet there is no way but a broadcast, where the request allows it.
        if not reachable(cameras, host):
            assert request[1] & 0x10, request
            host = "255.255.255.255"
        for status, command, data in answer(request, cameras, control):
            udp.sendto(struct.pack(">HHH", status, command, len(data)) + request[6:8] + data, (host, port))


main()
