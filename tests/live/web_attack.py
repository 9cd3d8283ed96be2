#!/usr/bin/env python3
"""Hostile browsers before a viewer, on and off in turns, and what that does to the bus.

Usage: web_attack.py PORT PULSE_PID PULSE_CSV TURNS

While they are on: 1,000 connections that say nothing or a byte now and then, each opened anew when
the viewer closes it; WebSockets of another site's page, with a wrong token, with a frame that is
too large, with fragments without end; and eight browsers and eight clients of Foxglove's protocol
that ask for everything and read nothing. Each must be answered as it deserves, and the page must be
there for others. The bus' latency comes from `bus_pulse`, PULSE_PID, which is ended for its CSV.
Prints figures as JSON: the ratio of p99 with them to p99 without is the middle one of all turns'.
From 7 turns on it is judged, too: exit code 1 where it is above 1.2 in more turns than chance makes
once in a hundred (sign test): what else the machine does makes single turns differ by far, either
way.
"""
import asyncio
import base64
import bisect
import json
import math
import os
import random
import signal
import statistics
import struct
import sys
import time

PORT = int(sys.argv[1])
PULSE_PID, PULSE_CSV, TURNS = int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
HOST = f"127.0.0.1:{PORT}"
TURN_S, SETTLE_S = 2.0, 0.5
MOST_RATIO = 1.2
LEAST_JUDGED = 7  # turns: of fewer no result would be beyond chance
SILENT, NOT_READING = 1000, 8
MOST_FRAME = 64 * 1024
failures = []
count = {"connections": 0, "foreign_origins": 0, "too_large": 0, "page_loads": 0, "slowest_page_s": 0}


def expect(good, what):
    if not good:
        failures.append(what)


def frame(opcode, payload=b"", final=True):
    """A client's frame, with a mask of zeros."""
    head = bytes([(0x80 if final else 0) | opcode])
    size = len(payload)
    if size < 126:
        head += bytes([0x80 | size])
    elif size < 65536:
        head += bytes([0x80 | 126]) + struct.pack(">H", size)
    else:
        head += bytes([0x80 | 127]) + struct.pack(">Q", size)
    return head + bytes(4) + payload


def text(message):
    return frame(1, json.dumps(message).encode())


async def connect():
    count["connections"] += 1
    return await asyncio.open_connection("127.0.0.1", PORT, limit=1 << 24)


async def upgrade(origin, path="/ws"):
    """The answer's status, and the WebSocket: the page's, or at "/" Foxglove's."""
    reader, writer = await connect()
    key = base64.b64encode(os.urandom(16)).decode()
    writer.write((f"GET {path} HTTP/1.1\r\nHost: {HOST}\r\nOrigin: {origin}\r\nUpgrade: websocket\r\n"
                  f"Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n"
                  "Sec-WebSocket-Protocol: foxglove.websocket.v1\r\n\r\n").encode())
    head = await reader.readuntil(b"\r\n\r\n")
    return int(head.split()[1]), reader, writer


async def next_frame(reader):
    """Opcode and payload."""
    first, size = await reader.readexactly(2)
    if size == 126:
        (size,) = struct.unpack(">H", await reader.readexactly(2))
    elif size == 127:
        (size,) = struct.unpack(">Q", await reader.readexactly(8))
    return first & 0x0F, await reader.readexactly(size)


async def close_code(reader):
    while True:
        opcode, payload = await next_frame(reader)
        if opcode == 8:
            return struct.unpack(">H", payload[:2])[0]


async def silent(number):
    """Says nothing, or a byte now and then; comes back when it is closed."""
    while True:
        reader, writer = await connect()
        try:
            if number % 2 == 0:
                await reader.read()
            for byte in b"GET / HTTP/1.1\r\nX: " + b"x" * 1000:
                writer.write(bytes([byte]))
                await asyncio.sleep(0.5)
        except OSError:
            pass
        finally:
            writer.close()
        await asyncio.sleep(1)


async def foreign():
    while True:
        try:
            status, _, writer = await upgrade("http://evil.example", random.choice(["/ws", "/"]))
            expect(status == 403, f"another site's page got {status}")
            count["foreign_origins"] += 1
            writer.close()
        except (OSError, asyncio.IncompleteReadError):
            pass  # given up for the sake of a newer connection
        await asyncio.sleep(0.05)


async def too_large():
    while True:
        try:
            status, reader, writer = await upgrade(f"http://{HOST}")
            if status == 101:
                writer.write(frame(1, b"x" * (MOST_FRAME + 1)))
                expect(await close_code(reader) == 1009, "a frame too large was not named so")
                count["too_large"] += 1
            writer.close()
        except (OSError, asyncio.IncompleteReadError):
            pass
        await asyncio.sleep(0.05)


async def fragments():
    """A message of single bytes, which goes on until it is too large."""
    while True:
        try:
            _, reader, writer = await upgrade(f"http://{HOST}")
            writer.write(text({"type": "hello", "token": "wrong"}))
            writer.write(frame(1, b"x", final=False))
            for _ in range(MOST_FRAME + 10):
                writer.write(frame(0, b"x", final=False))
                await writer.drain()
        except OSError:
            pass
        await asyncio.sleep(0.05)


async def reads_nothing():
    _, reader, writer = await upgrade(f"http://{HOST}")
    reader._transport.pause_reading()  # nothing leaves the kernel
    writer.write(text({"type": "hello", "token": ""}))
    everything = {"type": "watch", "cloud": True, "cameras": ["rgb", "thermal"],
                  "overlay_cloud": True, "points": 10_000_000}
    while True:
        writer.write(text(everything))
        await asyncio.sleep(0.2)


async def subscribes_and_reads_nothing():
    _, reader, writer = await upgrade(f"http://{HOST}", "/")
    reader._transport.pause_reading()
    ids = range(1, 40)  # of channels that there may be
    every = [{"id": number, "channelId": number} for number in ids]
    while True:
        writer.write(text({"op": "subscribe", "subscriptions": every}))
        writer.write(text({"op": "unsubscribe", "subscriptionIds": [*ids]}))
        writer.write(text({"op": "subscribe", "subscriptions": every}))
        await asyncio.sleep(0.5)


async def page():
    """Somebody who wants to see the page."""
    while True:
        begin = time.monotonic()
        try:
            reader, writer = await connect()
            writer.write(f"GET / HTTP/1.1\r\nHost: {HOST}\r\n\r\n".encode())
            async with asyncio.timeout(10):  # wait_for may swallow the end of the attack
                answer = await reader.read()
            expect(answer.startswith(b"HTTP/1.1 200 "), f"the page was answered by {answer[:60]}")
            count["page_loads"] += 1
            count["slowest_page_s"] = max(count["slowest_page_s"], time.monotonic() - begin)
            writer.close()
        except asyncio.TimeoutError:
            expect(False, "the page did not come in 10 s")
        await asyncio.sleep(0.2)


async def attack(seconds):
    hostile = [silent(number) for number in range(SILENT)] + [foreign(), too_large(), fragments()]
    hostile += [reads_nothing() for _ in range(NOT_READING)]
    hostile += [subscribes_and_reads_nothing() for _ in range(NOT_READING)] + [page()]
    tasks = [asyncio.create_task(one) for one in hostile]
    await asyncio.sleep(seconds)
    for task in tasks:
        if task.done() and not task.cancelled() and task.exception():
            expect(False, f"{task.get_coro().__name__}: {task.exception()!r}")
        task.cancel()
    await asyncio.gather(*tasks, return_exceptions=True)


def p99(latencies):
    return sorted(latencies)[int(0.99 * len(latencies))]


async def main():
    spans = []  # (calm from, to, attacked from, to)
    for _ in range(TURNS):
        await asyncio.sleep(SETTLE_S)
        begin = time.monotonic()
        await asyncio.sleep(TURN_S)
        end = time.monotonic()
        await attack(SETTLE_S + TURN_S)
        spans.append((begin, end, end + SETTLE_S, end + SETTLE_S + TURN_S))
    os.kill(PULSE_PID, signal.SIGTERM)
    while os.path.exists(f"/proc/{PULSE_PID}/fd/0"):  # ended, or a zombie of the script's
        await asyncio.sleep(0.05)
    with open(PULSE_CSV, encoding="ascii") as csv:
        pulses = [tuple(map(float, line.split(","))) for line in csv]
    times = [when for when, _ in pulses]

    def within(begin, end):
        return [ms for _, ms in pulses[bisect.bisect(times, begin):bisect.bisect(times, end)]]

    calm = [within(begin, end) for begin, end, _, _ in spans]
    attacked = [within(begin, end) for _, _, begin, end in spans]
    ratios = [p99(b) / p99(a) for a, b in zip(calm, attacked)]
    ratio = statistics.median(ratios)
    expect(min(map(len, calm + attacked)) > 500, "too few pulses")
    above = sum(r > MOST_RATIO for r in ratios)
    chance = sum(math.comb(TURNS, k) for k in range(above, TURNS + 1)) / 2**TURNS
    expect(TURNS < LEAST_JUDGED or chance > 0.01, f"p99 on the bus is {ratio:.2f} of what it is without")
    for what in ("foreign_origins", "too_large", "page_loads"):
        expect(count[what] > 0, f"none of {what}")
    print(json.dumps({**count, "bus_p99_ratio": round(ratio, 3),
                      "calm_p99_ms": round(statistics.median(map(p99, calm)), 3),
                      "attacked_p99_ms": round(statistics.median(map(p99, attacked)), 3),
                      "ratios": [round(r, 2) for r in sorted(ratios)]}))


asyncio.run(main())
for failure in sorted(set(failures))[:10]:
    print(f"web_attack: {failure}", file=sys.stderr)
sys.exit(1 if failures else 0)
