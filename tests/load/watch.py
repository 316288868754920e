#!/usr/bin/env python3
"""What WATCH costs: how soon events come, what one watcher costs inserts, what watchers that do not read cost.

    tests/load/watch.py BUILD [--points N] [--large N] [--watchers N] [--rounds N]

`make load-watch` runs it. All programs are on one machine: figures of a loaded one say little.
"""
import argparse
import os
import re
import socket
import statistics
import subprocess
import sys
import threading
import time

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from stress import Client, Daemon  # noqa: E402


def run(*words):
    return subprocess.run([str(word) for word in words], check=True, capture_output=True, text=True, timeout=300).stdout.strip()


def loaded(o, points):
    """A daemon with a triangulated set."""
    daemon = Daemon(os.path.join(o.build, 'delaunayd'), '--max-points', '20000000')
    load(o, daemon, '--mix', 'ping', '--count', 1, '--points', points, '--set', 'live')
    return daemon


def load(o, daemon, *words):
    """Replies a second, p50 and p99 in ms."""
    cells = run(os.path.join(o.build, 'load'), '--port', daemon.port, *words).split('|')
    return [float(cell) for cell in cells[2:5]]


def watchers(o, daemon, *words):
    return run(os.path.join(o.build, 'watchers'), daemon.port, 'live', o.points, *words)


def events(o):
    """After a single edit, and of many edits for many watchers, with other clients beside."""
    with loaded(o, o.points) as daemon:
        print(f'set of {o.points}, one edit after the other [event p99 1 ms]:', watchers(o, daemon, 1, 0, 5))
        beside = {}
        thread = threading.Thread(target=lambda: beside.update(
            ping=load(o, daemon, '--mix', 'ping', '--connections', 50, '--rate', 500, '--seconds', 4)))
        thread.start()
        print(f'[event p99 20 ms]: {watchers(o, daemon, o.watchers, 1000, 5)}')
        thread.join()
        print(f'    meanwhile PING of others [p99 3 ms]: p50 {beside["ping"][1]:.3f} p99 {beside["ping"][2]:.3f} ms')


def ticks(daemon):
    """Of processor time of the daemon, 10 ms each."""
    with open(f'/proc/{daemon.process.pid}/stat') as f:
        return sum(int(word) for word in f.read().rsplit(')', 1)[1].split()[11:13])


def drain(sock, stop):
    while not stop.is_set():
        try:
            if not sock.recv(1 << 18):
                return
        except socket.timeout:
            pass


def inserts(o):
    """Pipelined inserts without and with a watcher that reads, in turn; a set of its own each time."""
    rates = {False: [], True: []}
    costs = {False: [], True: []}
    with Daemon(os.path.join(o.build, 'delaunayd')) as daemon:
        client = Client(daemon.port)
        for k in range(2 * o.rounds):
            watched, name, stop = k % 2 == 1, f's{k}', threading.Event()
            client.load(name, 100000)
            client.ask(f'TRIANGULATE {name}')
            if watched:
                watcher = socket.create_connection(('127.0.0.1', daemon.port))
                watcher.settimeout(0.1)
                version = re.search(r'version:?[= ](\d+)', client.ask(f'MOVE {name} 0 0.5 0.5')).group(1)
                watcher.sendall(f'WATCH {name} SINCE {version}\n'.encode())
                thread = threading.Thread(target=drain, args=(watcher, stop))
                thread.start()
            before = ticks(daemon)
            rate = load(o, daemon, '--mix', 'add', '--connections', 4, '--pipeline', 16, '--seconds', 2, '--set', name)[0]
            rates[watched].append(rate)
            costs[watched].append((ticks(daemon) - before) * 1e7 / (2 * rate))
            if watched:
                stop.set()
                thread.join()
                watcher.close()
            client.ask(f'DROP {name}')
    for title, found, unit in (('inserts', rates, '/s'), ('processor time of an insert', costs, ' ns')):
        without, with_one = statistics.median(found[False]), statistics.median(found[True])
        print(f'{title}: {without:.0f}{unit} alone, {with_one:.0f}{unit} with a watcher: ratio {with_one / without:.2f}'
              f'{" [0.87]" if unit == "/s" else ""}')


def bytes_held(daemon):
    """Of connections and their replies, and of the whole process."""
    client = Client(daemon.port)
    client.sock.sendall(b'INFO memory\n')
    rows = int(client.status().split()[1])
    facts = dict(client.file.readline().decode().strip().split(':', 1) for _ in range(rows))
    client.close()
    return int(facts['memory_clients']) + int(facts['memory_replies']), daemon.memory('VmRSS')


def stalled(o):
    """A watcher that never reads, and one that reads a byte a second, while the whole set changes."""
    for points in (o.points, o.large):
        bound = round(4 * points / 2**20) + 1  # the stamps of the set, and its output
        for kind in ('that never reads', 'that reads a byte a second'):
            with loaded(o, points) as daemon:
                editor = Client(daemon.port)
                before, resident = bytes_held(daemon)
                watcher = socket.create_connection(('127.0.0.1', daemon.port))
                watcher.setblocking(False)
                watcher.sendall(b'WATCH live\n')
                most, end = 0, time.monotonic() + 8
                while time.monotonic() < end:
                    editor.sock.sendall(b''.join(b'MOVE live %d %d.5 %d.25\n' % (k * points // 300, k, 7 * k) for k in range(300)))
                    for _ in range(300):
                        editor.status()
                    if kind != 'that never reads':
                        try:
                            watcher.recv(1)
                        except BlockingIOError:
                            pass
                    time.sleep(0.9)
                    held, now = bytes_held(daemon)
                    most = max(most, held - before)
                print(f'a watcher of {points} points {kind} holds at most {most / 2**20:.2f} MiB [{bound}]; '
                      f'the process has grown by {(now - resident) / 2**20:.1f} MiB')
                watcher.close()


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument('build')
    parser.add_argument('--points', type=int, default=1000000)
    parser.add_argument('--large', type=int, default=10000000)
    parser.add_argument('--watchers', type=int, default=200)
    parser.add_argument('--rounds', type=int, default=5)
    parser.add_argument('--only', choices=['events', 'inserts', 'stalled'])
    o = parser.parse_args()
    for part in (events, inserts, stalled):
        if o.only in (None, part.__name__):
            part(o)


if __name__ == '__main__':
    main()
