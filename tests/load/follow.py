#!/usr/bin/env python3
"""What following costs: how fast a follower catches up, how soon it has an edit, and what it costs its leader's clients.

    tests/load/follow.py BUILD [--points N] [--edits N] [--rounds N]

`make load-follow` runs it. Leader, follower and clients are on one machine: figures of a loaded one say little.
"""
import argparse
import os
import random
import signal
import statistics
import subprocess
import sys
import tempfile
import threading
import time
from contextlib import ExitStack

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
from stress import Client, Daemon, share  # noqa: E402

EDITS_A_SECOND = 20000


class Pair:
    """A leader with the triangulated set `live`, and perhaps a follower that has it."""

    def __init__(self, o, fsync, followed=True, points=1000):
        self.stack = ExitStack()
        directory = self.stack.enter_context(tempfile.TemporaryDirectory())
        program = os.path.join(o.build, 'delaunayd')
        flags = ('--fsync', fsync, '--max-points', '50000000', '--keep-log', '4g', '--data')
        self.leader = self.stack.enter_context(Daemon(program, *flags, os.path.join(directory, 'leader')))
        self.client = Client(self.leader.port)
        self.client.live('live', points)
        if followed:
            self.follower = self.stack.enter_context(Daemon(
                program, *flags, os.path.join(directory, 'follower'), '--follow', f'127.0.0.1:{self.leader.port}'))
            assert self.client.ask('WAIT 1 60') == 'OK 0 followers=1'

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.stack.close()


def inserts(n, rnd):
    return ''.join(f'ADD live {rnd.random()!r} {rnd.random()!r}\n' for _ in range(n)).encode()


def send(client, requests, n):
    """n requests, and their replies, each a line."""
    def receive():
        for _ in range(n):
            assert client.file.readline().startswith(b'OK')
    thread = threading.Thread(target=receive)
    thread.start()
    client.sock.sendall(requests)
    thread.join()


def catching_up(o):
    """The follower's process sleeps while its leader gets changes."""
    rnd = random.Random(1)
    with Pair(o, 'everysec') as pair:
        for k in range(o.rounds):
            for what, n, change in (
                    ('single edits', o.edits, lambda: send(pair.client, inserts(o.edits, rnd), o.edits)),
                    ('loaded points', o.points, lambda: pair.client.load(f's{k}', o.points))):
                pair.follower.process.send_signal(signal.SIGSTOP)
                change()
                time.sleep(1.5)  # the change is on the leader's disk
                begin = time.perf_counter()
                pair.follower.process.send_signal(signal.SIGCONT)
                assert pair.client.ask('WAIT 1 60') == 'OK 0 followers=1'
                rate = n / (time.perf_counter() - begin)
                print(f'caught up: {rate:.0f} {what} a second, until they are on its disk', flush=True)
            pair.client.ask(f'DROP s{k}')


def lag(o):
    rnd, times, sent = random.Random(2), [], 0
    with Pair(o, 'everysec') as pair:
        begin = time.perf_counter()
        while (now := time.perf_counter() - begin) < 5:
            n = min(int(now * EDITS_A_SECOND) - sent, 200)
            if n < 1:
                continue
            requests = inserts(n, rnd) + b'WAIT 1 1\n'
            at = time.perf_counter()
            send(pair.client, requests, n + 1)
            times.append((time.perf_counter() - at) * 1000)
            sent += n
    times.sort()
    print(f'edits a second: {sent / 5:.0f}; from an edit until WAIT 1 says that the follower has it [5 ms]: '
          f'p50 {share(times, 0.5):.2f}, p99 {share(times, 0.99):.2f}, longest {times[-1]:.2f} ms', flush=True)


def cost(o, fsync, *words):
    """Rates of inserts with and without a follower, in turn."""
    rates = {False: [], True: []}
    for k in range(2 * o.rounds):
        followed = k % 2 == 1
        with Pair(o, fsync, followed, 100000) as pair:
            found = subprocess.run([os.path.join(o.build, 'load'), '--port', str(pair.leader.port), '--mix', 'add', '--seconds', '3',
                                    '--set', 'live', *words], check=True, capture_output=True, text=True, timeout=300)
            rates[followed].append(float(found.stdout.split('|')[2]))
    alone, with_one = statistics.median(rates[False]), statistics.median(rates[True])
    print(f'--fsync {fsync}: {alone:.0f} inserts a second alone, {with_one:.0f} with a follower: ratio {with_one / alone:.2f}', flush=True)


def main():
    parser = argparse.ArgumentParser(usage=__doc__)
    parser.add_argument('build')
    parser.add_argument('--points', type=int, default=5000000)
    parser.add_argument('--edits', type=int, default=300000)
    parser.add_argument('--rounds', type=int, default=3)
    o = parser.parse_args()
    print('targets: 300000 single edits and 5000000 loaded points a second, 0.85 with --fsync always')
    catching_up(o)
    lag(o)
    cost(o, 'always', '--connections', '16')
    cost(o, 'everysec', '--connections', '2', '--pipeline', '32')


if __name__ == '__main__':
    main()
