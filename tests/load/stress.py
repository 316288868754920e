#!/usr/bin/env python3
"""How single expensive requests affect other clients, and how stress affects memory.

    tests/load/stress.py DAEMON [--points N] [--large N] [SCENARIO ...]

Each scenario starts a daemon of its own on loopback, runs for a few seconds, and prints one line with
what it measured and the bound it should keep. `make stress` runs all of them. The figures are of
one machine with the daemon and all clients on it; compare two daemons in alternating runs.
"""
import argparse
import math
import multiprocessing as mp
import os
import random
import re
import socket
import struct
import subprocess
import sys
import tempfile
import time


class Daemon:
    def __init__(self, binary, *flags, environment=None):
        self.process = subprocess.Popen([binary, '--port', '0', *flags], stdout=subprocess.PIPE,
                                        stderr=subprocess.DEVNULL, text=True, env=environment)
        self.port = int(re.search(r':(\d+)$', self.process.stdout.readline().strip()).group(1))

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.process.kill()
        self.process.wait()

    def memory(self, key):
        with open(f'/proc/{self.process.pid}/status') as f:
            return int(re.search(rf'^{key}:\s+(\d+) kB', f.read(), re.M).group(1)) * 1024


class Client:
    def __init__(self, port):
        self.sock = socket.create_connection(('127.0.0.1', port))
        self.sock.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.file = self.sock.makefile('rb', buffering=1 << 16)

    def close(self):
        self.file.close()  # it holds the socket open
        self.sock.close()

    def status(self):
        """The next status line."""
        while True:
            line = self.file.readline()
            if not line.startswith(b'#'):
                return line.decode().rstrip()

    def ask(self, line):
        """Sends a request, reads its reply; returns the status line."""
        self.sock.sendall(line.encode() + b'\n')
        status = self.status()
        rows = int(status.split()[1]) if status.startswith('OK') else 0
        for _ in range(rows):
            self.file.readline()
        return status

    def load(self, name, n, seed=1, scale=1.0):
        """LOADB of n uniform points."""
        rnd = random.Random(seed)
        self.sock.sendall(f'LOADB {name} {n}\n'.encode())
        for first in range(0, n, 50000):
            m = min(50000, n - first)
            self.sock.sendall(struct.pack(f'<{2 * m}d', *(scale * rnd.random() for _ in range(2 * m))))
        status = self.status()
        assert status.startswith('OK'), status

    def live(self, name, n):
        """A live set of n uniform points with its grid."""
        self.load(name, n)
        for request in (f'TRIANGULATE {name}', f'NEAREST {name} 0.5 0.5'):
            status = self.ask(request)
            assert status.startswith('OK'), status


def share(sorted_values, q):
    return sorted_values[min(len(sorted_values) - 1, math.ceil(q * len(sorted_values)) - 1)]


def latencies(port, request, seconds, pause=0.0):
    """Sends requests one by one; their times in ms, sorted. request is a function of the number."""
    c, times, i = Client(port), [], 0
    end = time.perf_counter() + seconds
    while (begin := time.perf_counter()) < end:
        status = c.ask(request(i))
        times.append((time.perf_counter() - begin) * 1000)
        assert status.startswith('OK'), status
        i += 1
        if pause:
            time.sleep(pause)
    return sorted(times)


def loop_within(port, radius, stop):
    c, rnd = Client(port), random.Random()
    while not stop.is_set():
        status = c.ask(f'WITHIN t {rnd.random()} {rnd.random()} {radius}')
        assert status.startswith('OK'), status


def random_add(_):
    return f'ADD t {random.random()!r} {random.random()!r}'


def show(name, figures, bound):
    text = ', '.join(f'{k} {v:.3g}' for k, v in figures.items())
    print(f'| {name} | {text} | {bound} |', flush=True)


def readers(args, radius, clients, bound):
    with Daemon(args.daemon) as d:
        Client(d.port).live('t', args.points)
        stop = mp.Event()
        loops = [mp.Process(target=loop_within, args=(d.port, radius, stop)) for _ in range(clients)]
        for p in loops:
            p.start()
        time.sleep(0.3)
        before = d.memory('VmHWM')
        t = latencies(d.port, random_add, 4)
        stop.set()
        for p in loops:
            p.join()
        show(f'ADD while {clients} clients loop over WITHIN, radius {radius}',
             {'p50 ms': share(t, .5), 'p99 ms': share(t, .99), 'max ms': t[-1],
              'memory grew MB': (d.memory('VmHWM') - before) / 1e6}, bound)


def tiny_withins(args):
    readers(args, 0.001, 6, 'p50 0.3, p99 3')


def large_withins(args):
    readers(args, 0.2, 2, 'none; p99 should be a few ms')


def slow_read(port, request, seconds, started):
    """Reads a binary reply evenly over this many seconds."""
    c = Client(port)
    c.sock.sendall(request.encode() + b'\n')
    status = c.status()
    left = int(re.search(r'bytes=(\d+)', status).group(1))
    started.set()
    begin, total = time.monotonic(), left
    while left > 0:
        left -= len(c.file.read(min(left, 1 << 20)))
        ahead = seconds * (total - left) / total - (time.monotonic() - begin)
        if ahead > 0:
            time.sleep(ahead)


def slow_dump(args):
    """A slow reader of BINARY LISTS of a large set, and edits meanwhile."""
    with Daemon(args.daemon) as d:
        main = Client(d.port)
        main.live('t', args.large)
        before = d.memory('VmRSS')
        started = mp.Event()
        reader = mp.Process(target=slow_read, args=(d.port, 'LISTS t BINARY', args.dump_seconds, started))
        reader.start()
        started.wait()
        edits, t = 0, []
        while reader.is_alive() and edits < 100000:
            begin = time.perf_counter()
            kind = edits % 3
            if kind == 0:
                status = main.ask(random_add(0))
            elif kind == 1:
                status = main.ask(f'MOVE t {random.randrange(args.large // 2)} {random.random()!r} {random.random()!r}')
            else:
                status = main.ask(f'DEL t {args.large // 2 + edits}')
            t.append((time.perf_counter() - begin) * 1000)
            assert status.startswith('OK'), status
            edits += 1
        grown = d.memory('VmRSS') / before - 1
        reader.join()
        t.sort()
        show(f'{edits} edits during LISTS BINARY of {args.large} points, read in {args.dump_seconds} s',
             {'p50 ms': share(t, .5), 'p99 ms': share(t, .99), 'max ms': t[-1], 'memory grew %': 100 * grown},
             'p99 5, memory 10 %')


def hub(args):
    """Every command on a wheel's hub, and the PINGs of another client meanwhile."""
    n = args.hub
    with Daemon(args.daemon) as d:
        c = Client(d.port)
        c.sock.sendall(f'LOADB t {n + 1}\n'.encode() + struct.pack('<2d', 0, 0) + b''.join(
            struct.pack('<2d', math.cos(2 * math.pi * i / n), math.sin(2 * math.pi * i / n)) for i in range(n)))
        assert c.status().startswith('OK')
        c.ask('TRIANGULATE t')
        c.ask('NEAREST t 0 0')
        commands = {
            'LISTS': 'LISTS t 0', 'TRIANGLES': 'TRIANGLES t 0', 'EDGES': 'EDGES t 0', 'NEAREST k=2': 'NEAREST t 1e-9 0 2',
            'NEAREST': 'NEAREST t 0.3 0.2', 'LOCATE': 'LOCATE t 0.3 0.2', 'WITHIN': 'WITHIN t 0 0 0.5',
            'edge': 'TRIANGLES t 0 7', 'GET': 'GET t 0', 'ADD': 'ADD t 1e-3 2e-3', 'MOVE': 'MOVE t 0 1e-4 1e-4', 'DEL': 'DEL t 0',
            'HULL': 'HULL t', 'STAT': 'STAT t',
        }
        for name, command in commands.items():
            queue = mp.Queue()
            pings = mp.Process(target=lambda q: q.put(latencies(d.port, lambda i: 'PING', 1.0)), args=(queue,))
            pings.start()
            time.sleep(0.2)
            begin = time.perf_counter()
            status = c.ask(command)
            took = (time.perf_counter() - begin) * 1000
            t = queue.get()
            pings.join()
            show(f'hub of {n}: {name}', {'its own ms': took, 'PING max ms': t[-1], 'PING p99 ms': share(t, .99)},
                 'PING max 5' if status.startswith('OK') else status)


def crowd_seconds(port, n):
    c = Client(port)
    c.ask('DROP t')
    c.live('t', 20000)
    clients = [Client(port) for _ in range(n)]
    rnd = random.Random(n)
    messages = ['ADD t ' + ' '.join(f'{rnd.random()!r} {rnd.random()!r}' for _ in range(120)) + '\n' for _ in range(n)]
    begin = time.perf_counter()
    for k, m in zip(clients, messages):
        k.sock.sendall(m.encode())
    for k in clients:
        assert k.status().startswith('OK')
    return time.perf_counter() - begin


def crowd(args):
    with Daemon(args.daemon) as d:
        few, many = (min(crowd_seconds(d.port, n) for _ in range(3)) for n in (100, 800))
        show('clients with one ADD of 120 points each', {'100 take s': few, '800 take s': many, 'ratio': many / few},
             'ratio 10')


def ask_one(port, line, queue):
    queue.put(Client(port).ask(line))


def builds(args):
    """Eight TRIANGULATEs at once in little memory."""
    n = 400000
    with Daemon(args.daemon, '--max-memory', '200m') as d:
        c, refused = Client(d.port), 0
        for i in range(8):
            try:
                c.load(f's{i}', n, seed=i)
            except (AssertionError, OSError):
                refused += 1
                c = Client(d.port)
        queue = mp.Queue()
        jobs = [mp.Process(target=ask_one, args=(d.port, f'TRIANGULATE s{i}', queue)) for i in range(8)]
        for p in jobs:
            p.start()
        replies = [queue.get(timeout=120) for _ in jobs]
        for p in jobs:
            p.join()
        show('8 TRIANGULATEs of 400,000 points, --max-memory 200m',
             {'peak MB': d.memory('VmHWM') / 1e6, 'OK': sum(r.startswith('OK') for r in replies),
              'BUSY or NOMEM': sum(r.startswith(('ERR BUSY', 'ERR NOMEM')) for r in replies),
              'NOSET': sum(r.startswith('ERR NOSET') for r in replies), 'loads refused': refused}, 'peak 230 MB, all answered')


def info(client, key):
    client.sock.sendall(b'INFO\n')
    rows = int(client.status().split()[1])
    values = dict(client.file.readline().decode().rstrip().split(':', 1) for _ in range(rows))
    return int(values[key])


def load_and_drop(port, name, rounds):
    """Sends all at once; the replies are read by another process."""
    c, n, rnd = Client(port), 100000, random.Random(1)
    points = struct.pack(f'<{2 * n}d', *(rnd.random() for _ in range(2 * n)))
    request = f'LOADB {name} {n}\n'.encode() + points + f'DROP {name}\n'.encode()
    sender = mp.Process(target=lambda: [c.sock.sendall(request) for _ in range(rounds)])
    sender.start()
    replies = [c.status() for _ in range(2 * rounds)]
    sender.join()
    assert all(r.startswith(('OK', 'ERR BUSY', 'ERR NOMEM', 'ERR NOSET')) for r in replies), replies


def stalled_disk(args):
    """LOADB and DROP in a loop while no sync returns; then the disk works again."""
    shim = os.path.join(os.path.dirname(args.daemon), 'tests/faults/disk_shim.so')
    with tempfile.TemporaryDirectory() as top:
        data, gate = os.path.join(top, 'data'), os.path.join(top, 'gate')
        environment = dict(os.environ, LD_PRELOAD=os.path.abspath(shim), DISK_DIR=data, DISK_GATE=gate)
        with Daemon(args.daemon, '--max-memory', '64m', '--data', data, environment=environment) as d:
            c = Client(d.port)
            while not c.ask('CREATE t').startswith('OK'):
                time.sleep(0.01)
            open(gate, 'w').close()
            loops = [mp.Process(target=load_and_drop, args=(d.port, f's{i}', 60)) for i in range(3)]
            for p in loops:
                p.start()
            time.sleep(5)
            stalled, log = d.memory('VmHWM'), info(c, 'memory_log')
            os.unlink(gate)
            for p in loops:
                p.join()
                assert p.exitcode == 0
            time.sleep(1)
            left = sum(info(c, k) for k in ('memory_builds', 'memory_edits', 'loading', 'memory_log', 'memory_replies'))
            show('LOADB and DROP of 3 clients on a stalled disk, --max-memory 64m',
                 {'peak MB': stalled / 1e6, 'queued MB': log / 1e6, 'peak MB afterwards': d.memory('VmHWM') / 1e6,
                  'reserved at the end': left}, 'peak 90, 0 reserved')


def until_idle(client):
    begin = time.perf_counter()
    while info(client, 'jobs_running') > 0:
        time.sleep(0.002)
    return (time.perf_counter() - begin) * 1000


def cancel(args):
    """How long work continues after its TIMEOUT, after its client has disconnected, and after SIGTERM."""
    n = args.points
    ids = ' '.join(str(i) for i in range(0, 100000, 11))
    points = ' '.join(f'{random.random():.6f} {random.random():.6f}' for _ in range(3000))
    requests = {
        'NEAREST': f'NEAREST t 0.5 0.5 {n - 1}', 'WITHIN': 'WITHIN t 0 0 1 1', 'LISTS of many': f'LISTS t {ids}'[:65000].rsplit(' ', 1)[0],
        'shelling': 'TRIANGULATE u METHOD shelling', 'divide': 'TRIANGULATE u METHOD divide', 'CHECK': 'CHECK t',
        'DEL of many': f'DEL t {ids}'[:65000].rsplit(' ', 1)[0], 'ADD of many': f'ADD t {points}',
    }
    limit = 0.02
    with Daemon(args.daemon) as d:
        c, other = Client(d.port), Client(d.port)
        c.live('t', n)
        c.load('u', n)
        for name, request in requests.items():
            c.ask('TRIANGULATE t')
            begin = time.perf_counter()
            status = c.ask(f'TIMEOUT {limit} {request}')
            late = (time.perf_counter() - begin - limit) * 1000
            leaver = Client(d.port)
            leaver.sock.sendall(request.encode() + b'\n')
            time.sleep(limit)
            leaver.close()
            show(f'{name}: {status[:40]}', {'ms after TIMEOUT': late, 'ms after its client has gone': until_idle(other)}, '100')
        for name in ('shelling', 'NEAREST', 'CHECK'):
            with Daemon(args.daemon) as e:
                k = Client(e.port)
                k.live('t', n)
                k.load('u', n)
                k.sock.sendall(requests[name].encode() + b'\n')
                time.sleep(0.05)
                k.close()
                begin = time.perf_counter()
                e.process.terminate()
                e.process.wait()
                show(f'SIGTERM during {name}', {'ms': (time.perf_counter() - begin) * 1000}, '100')


SCENARIOS = {f.__name__: f for f in (tiny_withins, large_withins, slow_dump, hub, crowd, builds, stalled_disk, cancel)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('daemon')
    parser.add_argument('--points', type=int, default=1000000)
    parser.add_argument('--large', type=int, default=10000000)
    parser.add_argument('--dump-seconds', type=float, default=60)
    parser.add_argument('--hub', type=int, default=200000)
    parser.add_argument('scenario', nargs='*', metavar="SCENARIO", default=[])
    args = parser.parse_intermixed_args()
    print('| what | measured | bound |\n|---|---|---|', flush=True)
    for name in args.scenario or SCENARIOS:
        SCENARIOS[name](args)


if __name__ == '__main__':
    main()
