"""What follow.py needs: daemons, cables between them that can be damaged, and a ledger of what has been acknowledged."""
import os
import shutil
import signal
import socket
import subprocess
import threading
import time


class Failure(Exception):
    pass


def expect(condition, text):
    if not condition:
        raise Failure(text)


def free_port():
    with socket.socket() as s:
        s.bind(('127.0.0.1', 0))
        return s.getsockname()[1]


class Client:
    def __init__(self, port):
        self.file = socket.create_connection(('127.0.0.1', port), timeout=60).makefile('rwb')

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

    def ask_many(self, text, n):
        """The replies, of one line each, to n requests."""
        self.file.write(text.encode() + b'\n')
        self.file.flush()
        return [self.file.readline() for _ in range(n)]


class Cable:
    """Forwards connections to a port. All damage ends with mend()."""

    def __init__(self, target):
        self.target = target
        self.listener = socket.create_server(('127.0.0.1', 0))
        self.port = self.listener.getsockname()[1]
        self.sockets = []
        self.mend()
        threading.Thread(target=self.accept, daemon=True).start()

    def mend(self):
        self.off = False       # no connections
        self.stuck = False     # connections stay, and nothing passes
        self.lengths = None    # called for the number of bytes after which a connection is cut
        self.delay_s = 0       # before every piece
        self.single_bytes = 0  # so many bytes come one by one

    def cut(self):
        for s in self.sockets:
            try:
                s.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass
        self.sockets = []

    def accept(self):
        while True:
            near, _ = self.listener.accept()
            try:
                if self.off:
                    raise OSError
                far = socket.create_connection(('127.0.0.1', self.target), timeout=20)
            except OSError:
                near.close()
                continue
            left = [self.lengths() if self.lengths else 1 << 60]
            for s in (near, far):
                s.settimeout(None)
                s.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                self.sockets.append(s)
            for a, b in ((near, far), (far, near)):
                threading.Thread(target=self.pump, args=(a, b, left), daemon=True).start()

    def pump(self, a, b, left):
        try:
            while data := a.recv(1 << 16):
                while self.stuck:
                    time.sleep(0.005)
                time.sleep(self.delay_s)
                data = data[:left[0]]
                left[0] -= len(data)
                single = min(len(data), self.single_bytes)
                self.single_bytes -= single
                for i in range(single):
                    b.send(data[i:i + 1])
                b.sendall(data[single:])
                if left[0] == 0:
                    break
        except OSError:
            pass
        for s in (a, b):
            try:
                s.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass


class Node:
    """A daemon, its directory, which is a file system of its own where that is possible, and the cable to it."""

    def __init__(self, build, path, options, disk):
        self.build, self.path, self.options = build, path, options
        self.port = free_port()
        self.cable = Cable(self.port)
        self.data = path + '/data'
        os.mkdir(path)
        if disk:
            subprocess.run(['mount', '-t', 'tmpfs', '-o', f'size={disk}', 'follow', path], check=True)
        self.process = None

    def start(self, *options):
        command = [self.build + '/delaunayd', '--data', self.data, '--port', str(self.port), '--log-level', 'error']
        with open(self.path + '.log', 'ab') as log:
            self.process = subprocess.Popen([*command, *self.options, *options], stdout=subprocess.PIPE, stderr=log)
        expect(self.process.stdout.readline() != b'', f'{self.path} does not start')

    def stop(self, sig=signal.SIGKILL):
        self.process.send_signal(sig)
        self.process.wait()
        self.process.stdout.close()

    def resident(self):
        """Its memory in MB: now, and the most so far."""
        with open(f'/proc/{self.process.pid}/status', encoding='ascii') as f:
            kb = dict(line.split()[:2] for line in f if line.startswith(('VmRSS', 'VmHWM')))
        return int(kb['VmRSS:']) / 1024, int(kb['VmHWM:']) / 1024

    def transfers(self):
        """How often it has received a snapshot."""
        with open(self.path + '.log', encoding='utf-8') as f:
            return f.read().count('everything is that of')

    def lose_data(self):
        shutil.rmtree(self.data)

    def fill(self, spare):
        """Fills the disk, but for that many bytes."""
        with open(self.path + '/balloon', 'wb', buffering=0) as f:
            try:
                while f.write(bytes(1 << 16)):
                    pass
            except OSError:
                pass
            f.truncate(max(0, f.tell() - spare))

    def free(self):
        os.unlink(self.path + '/balloon')

    def ask(self, text):
        return Client(self.port).ask(text)

    def facts(self):
        return dict(x.split(':', 1) for x in self.ask('INFO')[1] if ':' in x)

    def await_fact(self, key, *values):
        for _ in range(1200):
            facts = self.facts()
            if facts[key] in values:
                return facts[key]
            time.sleep(0.05)
        raise Failure(f'{self.path}: {key} is not {values}: {facts}')

    def command(self, text):
        reply = self.ask(text)[0]
        for _ in range(100):
            if not reply.startswith(('ERR BUSY', 'ERR LOADING')):
                break
            time.sleep(0.05)
            reply = self.ask(text)[0]
        expect(reply.startswith('OK'), f'{self.path}: {text}: {reply}')

    def repair(self):
        """Whether it says that changes are lost; a damaged end of the log looks like one that was never acknowledged."""
        done = subprocess.run([self.build + '/delaunayd', '--repair', self.data], capture_output=True, text=True)
        expect(done.returncode == 0, f'repair of {self.path}: {done}')
        return any(text in done.stdout for text in ('cut off at byte', 'put aside as damaged', 'were intact or are newer'))


class Ledger:
    """Points of the set `keep`, which one client adds and deletes, and what was acknowledged of that. The number x is used
    once, so a change without an answer may have happened or not."""

    def __init__(self):
        self.ids, self.deleted, self.next = {}, set(), 0

    def write(self, port, rnd, n):
        try:
            client = Client(port)
            for _ in range(n):
                self.change(client, rnd)
        except (OSError, ValueError):
            pass  # the daemon has been killed

    def change(self, client, rnd):
        if self.ids and rnd.random() < 0.3:
            x = rnd.choice(list(self.ids))
            i = self.ids.pop(x)
            if client.ask(f'DEL keep {i}')[0].startswith('OK'):
                self.deleted.add(x)
            return
        x = self.next = self.next + 1
        line = client.ask(f'ADD keep {x} {rnd.randrange(9)}')[0]
        if line.startswith('OK'):
            self.ids[x] = line.split('first=')[1].split()[0]

    def check(self, node):
        """Everything acknowledged must be there."""
        rows = [line.split() for line in node.ask('POINTS keep')[1]]
        have = {int(x): i for i, x, _ in rows}
        missing = [x for x, i in self.ids.items() if have.get(x) != i]
        back = [x for x in self.deleted if x in have]
        expect(not missing and not back, f'{node.path}: of {len(self.ids)}: missing {missing}, deleted but there {back}')
