"""Hands LCM's datagrams over between the networks of two interfaces, in both directions: late by
random times, and so out of order, and some of them twice. Each sender has an address and port of its
own on the other side, as LCM tells fragments apart by them. Until SIGTERM; then prints how many
datagrams came, how many went twice, how many after one that was sent later, and by how many ms the
relay itself was behind at most.
Usage: relay.py INTERFACE INTERFACE SEED PERMILLE_TWICE MOST_LATE_MS"""

import heapq
import itertools
import random
import select
import signal
import socket
import struct
import sys
import time

GROUP, PORT = "239.255.76.67", 7667
BUFFER_BYTES = 32 << 20
LARGEST = 65536


def udp_on(interface):
    udp = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    udp.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, interface.encode())
    return udp


def of_group(interface):
    return struct.pack("4s4si", socket.inet_aton(GROUP), bytes(4), socket.if_nametoindex(interface))


def listen(interface):
    udp = udp_on(interface)
    udp.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    udp.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, BUFFER_BYTES)
    udp.bind((GROUP, PORT))
    udp.setsockopt(socket.IPPROTO_IP, socket.IP_ADD_MEMBERSHIP, of_group(interface))
    udp.setblocking(False)
    return udp


def speak(interface):
    """What it sends does not come back to listen()."""
    udp = udp_on(interface)
    udp.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, of_group(interface))
    udp.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 0)
    return udp


class Relay:
    def __init__(self, interfaces, seed, twice, most_late_s):
        self.listeners = {listen(name): other for name, other in zip(interfaces, interfaces[::-1])}
        self.random = random.Random(seed)
        self.twice, self.most_late_s = twice, most_late_s
        self.speakers = {}  # by the interface to send on, and whose datagrams
        self.newest = {}  # of those that went, likewise
        self.agenda = []  # when, number, datagram, whose
        self.numbers = itertools.count()
        self.came = self.went_twice = self.overtaken = 0
        self.behind_s = 0

    def plan(self, now, datagram, sender):
        late = self.random.uniform(0, self.most_late_s)
        heapq.heappush(self.agenda, (now + late, next(self.numbers), datagram, sender))

    def take(self, listener):
        for _ in range(200):
            try:
                datagram, address = listener.recvfrom(LARGEST)
            except BlockingIOError:
                return
            self.came += 1
            sender = (self.listeners[listener], address)
            now = time.monotonic()
            self.plan(now, datagram, sender)
            if self.random.random() < self.twice:
                self.went_twice += 1
                self.plan(now, datagram, sender)

    def hand_over(self):
        while self.agenda and self.agenda[0][0] <= time.monotonic():
            due, number, datagram, sender = heapq.heappop(self.agenda)
            self.behind_s = max(self.behind_s, time.monotonic() - due)
            if sender not in self.speakers:
                self.speakers[sender] = speak(sender[0])
            self.speakers[sender].sendto(datagram, (GROUP, PORT))
            self.overtaken += number < self.newest.get(sender, 0)
            self.newest[sender] = max(number, self.newest.get(sender, 0))

    def run(self, is_over):
        while not is_over():
            wait = self.agenda[0][0] - time.monotonic() if self.agenda else 0.1
            for listener in select.select(list(self.listeners), [], [], max(0, min(wait, 0.1)))[0]:
                self.take(listener)
            self.hand_over()


def main():
    stopped = []
    signal.signal(signal.SIGTERM, lambda *_: stopped.append(True))
    seed, permille, most_late_ms = (int(word) for word in sys.argv[3:6])
    relay = Relay(sys.argv[1:3], seed, permille / 1000, most_late_ms / 1000)
    print("ready", flush=True)
    relay.run(lambda: stopped)
    print(f"came {relay.came}\ntwice {relay.went_twice}\novertaken {relay.overtaken}")
    print(f"behind {1000 * relay.behind_s:.0f}")


main()
