#!/usr/bin/env python3
"""Attacks the height service from several addresses of this machine while a modest client goes on asking, and prints what
that client saw: requests, refusals, the time of answers at the median, at the 99th percentile and at worst, and the memory
of the service.

usage: python3 tests/tools/service_attacks.py SANDTABLE ELEVATION LAT,LNG [SECONDS [ATTACK...]]

ELEVATION is an elevation file that covers the position; SECONDS are those of each attack, 10 unless stated; of all attacks
those are made whose names hold an ATTACK, such as `trickle`. Needs Linux, where all of 127.0.0.0/8 are addresses of this
machine.
"""
import http.client
import socket
import subprocess
import sys
import threading
import time

POINTS = 10_000
HEAD = "Host: localhost\r\n"


def connect(port, client):
    stream = socket.socket()
    stream.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    stream.bind((f"127.0.1.{client}", 0))
    stream.settimeout(5)
    stream.connect(("127.0.0.1", port))
    return stream


def post(length, body=b""):
    return f"POST /v1/d HTTP/1.1\r\n{HEAD}Content-Length: {length}\r\n\r\n".encode() + body


def greedy(place):
    body = ("locations=" + "|".join([place] * POINTS)).encode()
    return post(len(body), body)


def viewshed(place):
    return f"GET /v1/viewshed?observer={place}&observer_height=0 HTTP/1.1\r\n{HEAD}\r\n".encode()


# What each connection sends first, and what it goes on sending, a piece every half second.
ATTACKS = {
    "nobody": lambda place: (0, b"", b""),
    "256 silent bodies": lambda place: (256, post(100, b"l"), b""),
    "600 heads that trickle": lambda place: (600, b"GET /v1/d HTTP/1.1\r\n", b"a: b\r\n"),
    "600 bodies that trickle": lambda place: (600, post(30_000, b"locations="), b"1"),
    "128 long bodies that trickle": lambda place: (128, post(200_000, b"locations="), b"1"),
    "300 answers that nobody reads": lambda place: (300, greedy(place), b""),
    "64 clients of viewsheds": lambda place: (64, viewshed(place), b""),
    "1200 connections that say nothing": lambda place: (1200, b"", b""),
}


def attack(port, count, first, more, until):
    streams = []
    while time.time() < until:
        # Those that were closed come back.
        while len(streams) < count and time.time() < until:
            try:
                stream = connect(port, 1 + len(streams) % 8)
                stream.sendall(first)
                stream.setblocking(False)
                streams.append(stream)
            except OSError:
                time.sleep(0.01)
        time.sleep(0.5)
        alive = []
        for stream in streams:
            try:
                if more:
                    stream.send(more)
                elif stream.recv(1, socket.MSG_PEEK) == b"":
                    raise OSError
                alive.append(stream)
            except BlockingIOError:
                alive.append(stream)
            except OSError:
                stream.close()
        streams = alive
    for stream in streams:
        stream.close()


def resident_mb(process):
    with open(f"/proc/{process.pid}/status") as status:
        return max(int(line.split()[1]) for line in status if line.startswith("VmRSS")) / 1024


def measure(process, port, place, until):
    times, refused, most = [], 0, 0.0
    while time.time() < until:
        begun = time.time()
        try:
            # A connection of its own for each request, as browsers that come and go have.
            connection = http.client.HTTPConnection("127.0.0.1", port, timeout=10, source_address=("127.0.9.9", 0))
            connection.request("GET", f"/v1/d?locations={place}", headers={"Host": "localhost"})
            refused += connection.getresponse().status != 200
            connection.close()
        except OSError:
            refused += 1
        times.append(time.time() - begun)
        most = max(most, resident_mb(process))
        time.sleep(0.01)
    times.sort()
    return times, refused, most


def main():
    program, elevation, place = sys.argv[1:4]
    seconds = float(sys.argv[4]) if len(sys.argv) > 4 else 10.0
    wanted = sys.argv[5:] or [""]
    attacks = {name: plan for name, plan in ATTACKS.items() if any(word in name for word in wanted)}
    command = [program, "serve", f"d={elevation}", "--listen", "127.0.0.1:0"]
    process = subprocess.Popen(command, stderr=subprocess.PIPE, text=True)
    try:
        line = process.stderr.readline()
        port = int(line.split("http://")[1].split(": ")[0].rsplit(":", 1)[1])
        time.sleep(1)
        print(f"{'attack':<36} {'requests':>8} {'refused':>8} {'p50 ms':>8} {'p99 ms':>8} {'worst ms':>9} {'memory MB':>10}")
        for name, plan in attacks.items():
            count, first, more = plan(place)
            until = time.time() + seconds
            attacker = threading.Thread(target=attack, args=(port, count, first, more, until))
            attacker.start()
            times, refused, most = measure(process, port, place, until)
            attacker.join()
            p50, p99 = times[len(times) // 2] * 1e3, times[int(len(times) * 0.99)] * 1e3
            print(f"{name:<36} {len(times):>8} {refused:>8} {p50:>8.1f} {p99:>8.1f} {times[-1] * 1e3:>9.1f} {most:>10.0f}", flush=True)
    finally:
        process.terminate()
        process.wait()


main()
