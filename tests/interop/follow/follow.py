#!/usr/bin/env python3
"""Attacks a leader and its follower while clients edit sets: kills, a damaged connection, a lost or full or repaired disk, a
careless promotion. After each round both must have the same position and the same digests, and everything acknowledged.

    follow.py BUILD_DIR [SEED [ROUNDS [KIND,...]]]

The last line counts rounds: N passed, N failed; and N skipped. Full disks need the right to mount a tmpfs.
"""
import collections
import os
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

from follow_nodes import Client, Failure, Ledger, Node, expect

SETS = ['a', 'b', 'c']


def request(rnd):
    s, i = rnd.choice(SETS), rnd.randrange(60)
    points = ' '.join(f'{rnd.randrange(50)} {rnd.randrange(50)}' for _ in range(rnd.randrange(1, 6)))
    often = [f'ADD {s} {points}', f'DEL {s} {i}', f'MOVE {s} {i} {rnd.randrange(50)} {rnd.random()}']
    rare = [f'ADD {s} FIELDS z,w 1 2 {rnd.random()} 4', f'FSET {s} z {i} {rnd.random()}', f'TRIANGULATE {s}', f'DROP {s}',
            f'CREATE {s} TOL 0.5', f'EXPIRE {s} 100', f'FDROP {s} w', 'SNAPSHOT', 'LOAD']
    text = rnd.choice(often * 6 + rare)
    if text != 'LOAD':
        return text
    lines = ''.join(f'{rnd.randrange(1000)} {rnd.random()} 3\n' for _ in range(rnd.choice([3, 3, 40000])))
    return f'LOAD {s} FIELDS z\n{lines}.'


def edit(port, rnd, n):
    try:
        client = Client(port)
        for _ in range(n):
            client.ask(request(rnd))
    except (OSError, ValueError):
        pass  # the daemon has been killed


class World:
    def __init__(self, build, seed, scratch, mounts, disk):
        self.rnd = random.Random(seed)
        self.ledger = Ledger()
        self.full_disks = mounts
        keep = self.rnd.choice(['1k', '200k', '10m'])
        options = ['--compact-at', self.rnd.choice(['30k', '200k']), '--keep-log', keep]
        self.leader, self.follower = (Node(build, f'{scratch}/{name}', options, mounts and disk) for name in ('one', 'two'))
        self.leader.start()
        self.follower.start('--follow', f'127.0.0.1:{self.leader.cable.port}')

    def end(self):
        for node in (self.leader, self.follower):
            if node.process.poll() is None:
                node.stop()

    def load(self, node=None, ledger=True):
        """Starts clients that edit sets at the node; returns what waits for their end."""
        port = (node or self.leader).port
        n = self.rnd.randrange(1, 120)
        threads = [threading.Thread(target=edit, args=(port, random.Random(self.rnd.random()), n))]
        if ledger:
            threads.append(threading.Thread(target=self.ledger.write, args=(port, random.Random(self.rnd.random()), n)))
        for t in threads:
            t.start()
        return lambda: [t.join() for t in threads]

    def pause(self, most_s=0.3):
        time.sleep(self.rnd.random() * most_s)

    def await_same(self):
        keys = ['history', 'lsn', 'durable_lsn', 'log_digest']
        for _ in range(1200):
            a, b = self.leader.facts(), self.follower.facts()
            if [a[k] for k in keys] == [b[k] for k in keys] and a['lsn'] == a['durable_lsn']:
                break
            time.sleep(0.05)
        else:
            raise Failure(f'other positions: {a} {b}')
        for s in [*SETS, 'keep', 'big']:
            x, y = (n.ask(f'DIGEST {s}')[0] for n in (self.leader, self.follower))
            expect(x == y, f'set {s}: {x} {y}')
        self.ledger.check(self.leader)

    def need_follower(self):
        """What is acknowledged from now on is on the follower's disk."""
        self.leader.command('CONFIG SET min-followers 1')
        self.leader.await_fact('followers', '1')

    def promote(self):
        """The follower becomes the leader; the former leader is not running, or cannot reach it."""
        self.follower.command('FOLLOW NONE')
        self.leader, self.follower = self.follower, self.leader
        expect(self.leader.facts()['role'] == 'leader', 'it is not promoted')

    def follow(self):
        """The former leader follows the new one, if necessary with CONFIRM."""
        text = f'FOLLOW 127.0.0.1 {self.leader.cable.port}'
        self.follower.command(text)
        if self.is_refused():
            self.follower.command(text + ' CONFIRM')

    def is_refused(self):
        """Whether the follower refuses its leader; otherwise it receives."""
        for _ in range(1200):
            facts = self.follower.facts()
            if facts['link'] == 'refused':
                return True
            if facts['link'] == 'receiving' and self.leader.facts()['followers'] == '1':
                return False
            time.sleep(0.05)
        raise Failure(f'neither receives nor refuses: {facts}')

    # ---- rounds ----

    def kills(self):
        """Either or both are killed, or stopped."""
        nodes = [self.leader, self.follower]
        who = self.rnd.choice([[self.leader], [self.follower], nodes, []])
        join = self.load()
        self.pause()
        for node in who:
            node.stop(self.rnd.choice([signal.SIGKILL, signal.SIGKILL, signal.SIGTERM]))
        join()
        for node in who:
            if node is self.follower and self.rnd.random() < 0.5 and self.leader not in who:
                self.load()()
            node.start()

    def cables(self):
        """The connection is cut after a random number of bytes, again and again, is slow, or passes byte by byte."""
        cable, how = self.leader.cable, self.rnd.randrange(4)
        if how == 0:
            cable.lengths = lambda: int(10 ** random.uniform(0, 6))
        elif how == 1:
            cable.delay_s = self.rnd.random() * 0.05
        elif how == 2:
            cable.single_bytes = 20000
        if how != 1 or self.rnd.random() < 0.5:
            cable.cut()
        join = self.load()
        for _ in range(self.rnd.randrange(4)):
            self.pause()
            cable.cut()
        if how == 3:
            cable.stuck = True
            self.pause(2)
            cable.stuck = False
        join()
        cable.mend()

    def losses(self):
        """The leader is killed and its disk is lost; the follower is promoted. Nothing acknowledged is missing."""
        self.need_follower()
        join = self.load()
        self.pause(1)
        self.leader.stop()
        join()
        self.leader.lose_data()
        if self.rnd.random() < 0.3:
            self.follower.stop()
            self.follower.start()
        empty = self.rnd.random() < 0.5
        if empty:  # it is started again by mistake: the follower keeps what it has
            self.leader.start()
            self.load(ledger=False)()
            expect(self.is_refused(), 'an empty leader is not refused')
        self.ledger.check(self.follower)
        self.promote()
        self.ledger.check(self.leader)
        if empty:
            self.follow()
        else:
            self.follower.start('--follow', f'127.0.0.1:{self.leader.cable.port}')
        self.load()()

    def repairs(self):
        """One is killed, perhaps its files are damaged, and repaired."""
        node = self.rnd.choice([self.leader, self.follower])
        self.need_follower()
        join = self.load()
        self.pause()
        node.stop()
        if node is self.follower:
            self.leader.command('CONFIG SET min-followers 0')
        join()
        if self.rnd.random() < 0.7:
            self.damage(node)
        lost = node.repair()
        node.start()
        if node is self.follower:
            self.follow()
            return
        if lost and self.rnd.random() < 0.7:  # as many other changes as were lost
            self.load(ledger=False)()
            node.command('SNAPSHOT')
        if self.is_refused():
            self.promote()
            self.follow()

    def damage(self, node):
        names = [n for n in os.listdir(node.data) if n.startswith(('log.', 'snapshot.'))]
        with open(f'{node.data}/{self.rnd.choice(names)}', 'r+b') as f:
            size = f.seek(0, 2)
            at = self.rnd.randrange(size)
            if self.rnd.random() < 0.5:
                f.truncate(at)
            else:
                f.seek(at)
                byte = f.read(1)[0]
                f.seek(at)
                f.write(bytes([byte ^ 1 << self.rnd.randrange(8)]))

    def full(self):
        """The disk of one is full for a while."""
        node = self.rnd.choice([self.leader, self.follower])
        if self.rnd.random() < 0.5:
            self.need_follower()
        node.fill(self.rnd.choice([0, 0, 5000, 100000]))
        join = self.load()
        self.pause(2)
        node.free()
        join()

    def splits(self):
        """The follower is promoted while its leader works; both accept changes until they can reach each other."""
        held = self.rnd.random() < 0.5  # changes of the former leader wait for its follower
        if held:
            self.need_follower()
        self.await_same()
        for node in (self.leader, self.follower):
            node.cable.stuck = held
            node.cable.off = not held
            if not held:
                node.cable.cut()
        joins = [self.load(ledger=held)]
        self.pause()
        self.promote()
        joins += [self.load(ledger=not held)] + ([] if held else [self.load(self.follower, ledger=False)])
        if held:
            self.pause()
            for node in (self.leader, self.follower):
                node.cable.mend()
        for join in joins:
            join()
        if self.rnd.random() < 0.3:
            self.follower.stop()
            self.follower.start()
        for node in (self.leader, self.follower):
            node.cable.mend()
        if self.rnd.random() < 0.5:
            self.follower.await_fact('role', 'fenced')
            if self.rnd.random() < 0.5:
                self.follower.stop()
                self.follower.start()
            line = self.follower.ask('ADD a 1 1')[0]
            expect(line.startswith('ERR READONLY there is a newer history'), f'the former leader: {line}')
        self.follow()
        self.load()()

    def hours(self):
        """The follower is stopped for 2,000,000 edits and continues without a transfer; the leader's memory does not grow. When
        the log does not reach back, there is a transfer."""
        self.leader.command('CONFIG SET keep-log 1g')
        self.leader.command('CONFIG SET compact-at 16m')
        self.await_same()
        self.leader.ask('ADD big ' + ' '.join(f'{i % 100} {i // 100}' for i in range(1000)))
        self.leader.command('TRIANGULATE big')
        self.moves(200000)
        for log, edits, transfers in (('1g', 2000000, 0), ('1', 200000, 1)):
            self.await_same()
            self.leader.command(f'CONFIG SET keep-log {log}')
            self.follower.stop(signal.SIGTERM)
            before, began = self.follower.transfers(), time.monotonic()
            at_first = self.leader.resident()[0]
            self.moves(edits)
            edited, at_last = time.monotonic(), self.leader.resident()
            self.leader.command('SNAPSHOT')
            self.leader.await_fact('snapshot_running', '0')
            self.follower.start('--log-level', 'info')
            self.await_same()
            caught_up, at_end = time.monotonic(), self.leader.resident()
            print(f'{edits} edits in {edited - began:.1f} s, caught up {caught_up - edited:.1f} s after that with '
                  f'{self.follower.transfers() - before} transfers; memory of the leader {at_first:.0f}, {at_last[0]:.0f}, '
                  f'{at_end[0]:.0f} MB, most {at_end[1]:.0f}', flush=True)
            expect(self.follower.transfers() - before == transfers, 'transfers')
            expect(at_end[0] < at_first + 32, 'the memory of the leader grows')

    def moves(self, n):
        """So many edits of the set `big`, in pipelines."""
        client, at_once = Client(self.leader.port), 5000
        for _ in range(n // at_once):
            points = (f'MOVE big {self.rnd.randrange(1000)} {self.rnd.random()} {self.rnd.random()}' for _ in range(at_once))
            for line in client.ask_many('\n'.join(points), at_once):
                expect(line.startswith(b'OK'), line)

    def play(self, kind):
        self.leader.command('CONFIG SET min-followers 0')
        getattr(self, kind)()
        self.await_same()


KINDS = ['kills', 'kills', 'cables', 'cables', 'losses', 'repairs', 'full', 'splits']


def play(build, seed, rounds, kinds, scratch, mounts):
    """How many rounds of each kind were good; raises the failure."""
    world, done, left = World(build, seed, scratch, mounts, '500m' if 'hours' in kinds else '100m'), collections.Counter(), []
    try:
        for i in range(rounds):
            if not left:
                left = [k for k in kinds if k != 'full' or mounts]
                world.rnd.shuffle(left)
            kind = left.pop()
            try:
                world.play(kind)
            except Exception as e:
                raise Failure(f'round {i + 1}, {kind}: {e!r}') from e
            done[kind] += 1
    finally:
        world.end()
        print(f'seed {seed}: {dict(done)}', flush=True)
    return done


def can_mount(scratch, kinds):
    """Mounts are those of this process only, and end with it."""
    if 'FOLLOW_MOUNTS' in os.environ:
        return True
    command = ['unshare', '--mount', 'mount', '-t', 'tmpfs', 'follow', scratch]
    if not shutil.which('unshare') or subprocess.run(command, stderr=subprocess.DEVNULL).returncode != 0:
        if 'full' in kinds:
            print('SKIP rounds with full disks: this machine mounts no tmpfs')
        return False
    os.rmdir(scratch)
    os.execvpe('unshare', ['unshare', '--mount', sys.executable, *sys.argv], {**os.environ, 'FOLLOW_MOUNTS': '1'})


def main():
    build = os.path.abspath(sys.argv[1])
    seed = int(sys.argv[2]) if len(sys.argv) > 2 else int(time.time())
    rounds = int(sys.argv[3]) if len(sys.argv) > 3 else 20
    kinds = sys.argv[4].split(',') if len(sys.argv) > 4 else KINDS
    scratch = tempfile.mkdtemp()
    mounts = can_mount(scratch, kinds)
    try:
        good = sum(play(build, seed, rounds, kinds, scratch, mounts).values())
    except Failure as e:
        kept = tempfile.mkdtemp()
        shutil.copytree(scratch, kept, dirs_exist_ok=True)
        print(f'FAIL seed {seed}: {e}\nfiles are in {kept}\n0 passed, 1 failed')
        sys.exit(1)
    finally:
        for name in ('one', 'two') if mounts else ():
            subprocess.run(['umount', f'{scratch}/{name}'], stderr=subprocess.DEVNULL)
        shutil.rmtree(scratch, ignore_errors=True)
    skips = ', 1 skipped' if 'full' in kinds and not mounts else ''
    print(f'{good} passed, 0 failed{skips}')


main()
