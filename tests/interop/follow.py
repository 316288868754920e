#!/usr/bin/env python3
"""Kills a leader and its follower, either or both, while a client edits sets at random; after each round both must have the
same position and the same digests.

    follow.py BUILD_DIR [SEED [ROUNDS]]
"""
import random
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

SETS = ['a', 'b', 'c']


class Client:
    def __init__(self, port):
        self.file = socket.create_connection(('127.0.0.1', port), timeout=20).makefile('rwb')

    def ask(self, text):
        """The first line of the reply, and the other lines."""
        self.file.write(text.encode() + b'\n')
        self.file.flush()
        line = '#'
        while line.startswith('#'):
            line = self.file.readline().decode()
        if line == '':
            raise ConnectionError
        n = int(line.split()[1]) if line.startswith('OK') else 0
        return line, [self.file.readline().decode().strip() for _ in range(n)]


class Node:
    def __init__(self, build, path, port, *options):
        self.command = [build + '/delaunayd', '--data', path, '--port', str(port), '--log-level', 'error', *options]
        self.port = port
        self.start()

    def start(self):
        self.process = subprocess.Popen(self.command, stdout=subprocess.PIPE)
        self.process.stdout.readline()

    def stop(self, sig):
        self.process.send_signal(sig)
        self.process.wait()

    def facts(self):
        return dict(x.split(':', 1) for x in Client(self.port).ask('INFO replication')[1])


def free_port():
    with socket.socket() as s:
        s.bind(('127.0.0.1', 0))
        return s.getsockname()[1]


def request(rnd):
    s, i = rnd.choice(SETS), rnd.randrange(60)
    points = ' '.join(f'{rnd.randrange(50)} {rnd.randrange(50)}' for _ in range(rnd.randrange(1, 6)))
    lines = ''.join(f'{rnd.randrange(1000)} {rnd.random()} 3\n' for _ in range(rnd.choice([3, 40000])))
    often = [f'ADD {s} {points}', f'DEL {s} {i}', f'MOVE {s} {i} {rnd.randrange(50)} {rnd.random()}']
    rare = [f'ADD {s} FIELDS z,w {points[:0]}1 2 {rnd.random()} 4', f'FSET {s} z {i} {rnd.random()}', f'TRIANGULATE {s}',
            f'DROP {s}', f'CREATE {s} TOL 0.5', f'EXPIRE {s} 100', f'FDROP {s} w', 'SNAPSHOT',
            f'LOAD {s} FIELDS z\n{lines}.']
    return rnd.choice(often * 6 + rare)


def edit(port, rnd, n):
    try:
        client = Client(port)
        for _ in range(n):
            client.ask(request(rnd))
    except (OSError, ValueError):
        pass  # the leader has been killed


def await_same(leader, follower):
    """What differs after half a minute; None: nothing."""
    keys = ['history', 'lsn', 'durable_lsn', 'log_digest']
    for _ in range(600):
        a, b = leader.facts(), follower.facts()
        if [a[k] for k in keys] == [b[k] for k in keys] and a['lsn'] == a['durable_lsn']:
            break
        time.sleep(0.05)
    else:
        return f'position: {a} {b}'
    for s in SETS:
        x, y = (Client(n.port).ask(f'DIGEST {s}')[0] for n in (leader, follower))
        if x != y:
            return f'set {s}: {x} {y}'
    return None


def main():
    build = sys.argv[1]
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else int(time.time())
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    rnd = random.Random(seed)
    scratch, port = tempfile.mkdtemp(), free_port()
    keep = rnd.choice(['1k', '200k', '10m'])
    leader = Node(build, scratch + '/l', port, '--compact-at', '40k', '--keep-log', keep)
    follower = Node(build, scratch + '/f', free_port(), '--compact-at', '30k', '--follow', f'127.0.0.1:{port}')
    bad = None
    for i in range(rounds):
        who = rnd.choice([[leader], [follower], [leader, follower], []])
        client = threading.Thread(target=edit, args=(port, random.Random(rnd.random()), rnd.randrange(1, 120)))
        client.start()
        time.sleep(rnd.random() * 0.3)
        for node in who:
            node.stop(rnd.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGTERM]))
        client.join()
        for node in who:
            if node is follower and rnd.random() < 0.5 and leader not in who:
                edit(port, rnd, 30)
            node.start()
        bad = await_same(leader, follower)
        if bad is not None:
            break
    leader.stop(signal.SIGKILL)
    follower.stop(signal.SIGKILL)
    print(f'{i + 1} rounds, seed {seed}: {"good" if bad is None else bad + ", files in " + scratch}')
    if bad is None:
        shutil.rmtree(scratch)
    sys.exit(bad is not None)


main()
