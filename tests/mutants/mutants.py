#!/usr/bin/env python3
"""mutants.py - changes the source in one place at a time, in a copy, and reports which changes no test notices.

    mutants.py [--of FILE] [--list NAME] [--sample N] [--seed S] [--jobs J] BUILD_DIR

Without --list the changes are random ones of single lines (generate.py). README.md beside this file describes the lists, *.txt.
Every entry of every list must apply to the source, whatever is run. BUILD_DIR is the one of make, with everything up to date.
The last line counts: N passed (caught), N failed. The exit status is 0 if every entry applies and enough of the changes are
caught: 95 % of the lists' entries, 85 % of random ones, less what chance allows for in a small sample.
"""
import argparse
import concurrent.futures
import glob
import os
import random
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

import generate

HERE = os.path.dirname(os.path.abspath(__file__))
TREE = os.path.dirname(os.path.dirname(HERE))
SUITES = ("core", "proto", "server", "clients")
WANTED, WANTED_RANDOM = 0.95, 0.85  # the shares that must be caught
BUILD_S = 900  # the most a build may take
INSIDE = "MUTANTS_INSIDE"  # set in the environment of a run that is isolated


# ---- the lists ----


class Mutant:
    """One entry of a list."""

    def __init__(self, where, file, sentence):
        self.where, self.file, self.sentence = where, file, sentence
        self.old, self.new, self.suites, self.words = [], [], [], []
        self.equivalent = None

    def __str__(self):
        return f"{self.file}: {self.sentence}"

    def mutate(self, text):
        """The file's text with the change. White space of the old text matches any other."""
        pattern = r"\s+".join(re.escape(word) for word in " ".join(self.old).split())
        found = list(re.finditer(pattern, text))
        if len(found) != 1:
            raise ValueError(f"the old text occurs {len(found)} times in the file")
        return text[: found[0].start()] + "\n".join(self.new) + text[found[0].end() :]

    def problem(self):
        """Why the entry is of no use, None if it is."""
        try:
            if not "".join(self.old).strip():
                return "it has no old text"
            if not self.words and not self.equivalent:
                return "it has no tests"
            if not set(self.suites) <= set(SUITES):
                return f"its tests are of {self.suites}, not of {SUITES}"
            text = read(os.path.join(TREE, self.file))
            if self.mutate(text).split() == text.split():
                return "it changes nothing"
        except (OSError, ValueError) as e:
            return str(e)
        return None


def read(path):
    with open(path, encoding="utf-8") as f:
        return f.read()


def read_list(path):
    """The entries of one list. Ends the program at a line that is not part of one."""
    mutants = []
    for number, line in enumerate(read(path).split("\n"), 1):
        where = f"{os.path.relpath(path, TREE)}:{number}"
        kind, rest = line[:2].strip(), line[2:]
        head = re.fullmatch(r"([a-z_/0-9]+\.[ch]): (.+)", line)
        if not line or kind == "#":
            continue
        if head:
            mutants.append(Mutant(where, *head.groups()))
        elif not mutants or kind not in ("-", "+", "?", "="):
            sys.exit(f"{where}: not a line of an entry: {line}")
        elif kind == "-":
            mutants[-1].old.append(rest)
        elif kind == "+":
            mutants[-1].new.append(rest)
        elif kind == "?":
            suite, *words = rest.split()
            mutants[-1].suites.append(suite)
            mutants[-1].words.extend(words)
        else:
            mutants[-1].equivalent = rest
    return mutants


# ---- running ----


def isolated(arguments):
    """Runs this program again where its processes, /tmp and /dev/shm are its own and end with it, whatever tests leave
    behind and however it is stopped. Returns the exit status; None if that is not possible here."""
    mounts = "mount -t tmpfs mutants /tmp && mount -t tmpfs mutants /dev/shm"
    unshare = ["unshare", "--mount", "--pid", "--fork", "--kill-child", "--mount-proc", "sh", "-c"]
    hidden = any(TREE.startswith(folder) for folder in ("/tmp/", "/dev/shm/"))
    if INSIDE in os.environ or hidden or not shutil.which("unshare"):
        return None
    if subprocess.run([*unshare, mounts], stderr=subprocess.DEVNULL, check=False).returncode != 0:
        return None
    command = [sys.executable, os.path.abspath(__file__), *arguments]
    with subprocess.Popen([*unshare, mounts + ' && "$@"', "sh", *command], env={**os.environ, INSIDE: "1"}) as inner:
        try:
            return inner.wait()
        finally:
            inner.kill()



def end_session(leader):
    """Ends every process of a session, and waits until they have ended: they may still write to files. Tests and their
    daemons are in process groups of their own."""
    for _ in range(500):
        alive = False
        for path in glob.glob("/proc/[0-9]*/stat"):
            try:
                state, _, _, session = read(path).rpartition(")")[2].split()[:4]
                if int(session) == leader and state != "Z":
                    alive = True
                    os.kill(int(path.split("/")[2]), signal.SIGKILL)
            except (OSError, ValueError, IndexError):
                pass  # it has ended
        if not alive:
            return
        time.sleep(0.01)


class Run:
    """One run of make: its status, its output, which tests failed and how many passed. With a time limit it ends at the
    first test that fails. Its temporary files are in the folder beside the tree."""

    leaders = set()  # of the sessions that are running

    def __init__(self, tree, build, suites, arguments, limit_s=None, ignored=()):
        variant = [] if build == "build" else ["V=" + os.path.basename(build)]
        command = ["make", "--no-print-directory", "SUITES=" + " ".join(sorted(set(suites))), *variant, *arguments]
        self.output, self.failed, self.passed, self.too_slow = [], [], 0, False
        self.ignored, self.broken = ignored, False
        started = time.monotonic()
        temporary = os.path.join(os.path.dirname(tree), "tmp")
        os.makedirs(temporary, exist_ok=True)
        process = subprocess.Popen(command, cwd=tree, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                   stderr=subprocess.STDOUT, text=True, errors="replace", start_new_session=True,
                                   env={**os.environ, "TMPDIR": temporary})
        self.leaders.add(process.pid)
        alarm = threading.Timer(limit_s or BUILD_S, self.expire, [process])
        alarm.start()
        for line in process.stdout:
            self.take(line.rstrip("\n"))
            if limit_s and self.failed:
                break
        alarm.cancel()
        end_session(process.pid)
        process.stdout.close()
        self.status = process.wait()
        self.leaders.discard(process.pid)
        self.seconds = time.monotonic() - started

    def expire(self, process):
        self.too_slow = True
        end_session(process.pid)

    def take(self, line):
        self.output.append(line)
        counted = re.fullmatch(r"(\d+) passed, \d+ failed(, \d+ skipped)?", line)
        if counted:
            self.passed += int(counted.group(1))
        elif line.startswith("FAIL ") and line.split()[1] not in self.ignored:
            self.failed.append(line.split()[1])
        elif line.startswith("FAIL "):
            self.broken = True # a test that fails anyhow


def build_then_test(tree, build, suites, words, limit_s):
    """(the run of the build, that of the tests or None if the build fails)"""
    built = Run(tree, build, suites, ["test_binaries", "CFLAGS=-O1"])  # of what is compiled again: a header may be in many files
    return built, None if built.status else Run(tree, build, suites, ["test", "T=" + " ".join(words)], limit_s)


def copy_tree(tree, build, to):
    """Copies the source with its times and the build directory, without the other variants' build directories."""
    shutil.copytree(tree, to, symlinks=True, ignore=shutil.ignore_patterns(".git", "build", "__pycache__"))
    if os.path.isdir(os.path.join(tree, build)):
        unused = () if build != "build" else ("asan", "tsan", "debug", "clang", "fuzz", "ci", "deb", "corpus")
        shutil.copytree(os.path.join(tree, build), os.path.join(to, build), symlinks=True,
                        ignore=lambda folder, names: set(unused) & set(names) if folder.endswith("/build") else ())


def verdict(mutant, pristine, build, limit_s):
    """(whether it is caught, by what or why not)"""
    with tempfile.TemporaryDirectory(prefix="mutant-") as scratch:
        tree = os.path.join(scratch, "tree")
        copy_tree(pristine, build, tree)
        path = os.path.join(tree, mutant.file)
        text = mutant.mutate(read(path))
        with open(path, "w", encoding="utf-8") as f:
            f.write(text)
        built, run = build_then_test(tree, build, mutant.suites, mutant.words, limit_s)
    if run is None:
        said = [line for line in built.output if "error" in line or "undefined" in line] or built.output[-1:]
        return False, "it does not build: " + "".join(said[:1])
    if run.failed:
        return True, f"{run.failed[0]}, {run.seconds:.0f} s"
    if run.too_slow:
        return True, f"the time limit of {limit_s:.0f} s"
    if run.status or not run.passed:
        return False, f"make ends with status {run.status} and {run.passed} tests passed: " + " | ".join(run.output[-3:])
    return False, f"{run.passed} tests pass, {run.seconds:.0f} s"


def pass_without_mutants(mutants, pristine, build):
    """Runs the tests of all these mutants on the unchanged source. Returns how long they took, or ends the program."""
    total = 0.0
    for suite in SUITES:
        words = sorted({w for m in mutants if suite in m.suites for w in m.words})
        if words:
            built, run = build_then_test(pristine, build, [suite], words, BUILD_S)
            if run is None or run.status or run.failed or not run.passed:
                sys.exit("\n".join((run or built).output[-30:]) + f"\nthe tests of {suite} must pass before anything is changed")
            print(f"unchanged: {run.passed} tests of {suite} pass, {run.seconds:.0f} s", flush=True)
            total = max(total, run.seconds)
    return total


# ---- random changes ----


SOURCES = ("core/*/*.c", "proto/*.c", "proto/*/*.c", "server/*.c", "server/*/*.c", "clients/*.c", "clients/[a-df-z]*/*.c")
REACHED_BY = {"core": ("core", "server", "clients"), "proto": ("proto", "server", "clients"), "server": ("server", "clients"),
              "clients": ("clients",)}
SUITE_S = 300  # the most a suite may take; a mutant that makes it slower is caught


class Line:
    """A random change of one line."""

    def __init__(self, file, number, old, new):
        self.file, self.number, self.old, self.new = file, number, old, new

    def __str__(self):
        return f"{self.file}:{self.number}: {self.old.strip()}  ->  {self.new.strip()}"


class Drawn:
    """Random changes, each once, for all threads."""

    def __init__(self, tree, seed, of):
        texts = {}
        for path in sorted(p for pattern in SOURCES for p in glob.glob(os.path.join(tree, pattern))):
            if of in os.path.relpath(path, tree):
                texts[os.path.relpath(path, tree)] = read(path)
        self.changes, self.lock, self.seen = generate.draw(random.Random(seed), texts), threading.Lock(), set()

    def next(self):
        with self.lock:
            for change in self.changes:
                if change not in self.seen:
                    self.seen.add(change)
                    return Line(*change)


class Workshop:
    """A copy of the tree in which one change after the other is made, tried and undone."""

    def __init__(self, pristine, build, folder, broken=()):
        self.broken, self.ignored = broken, set()
        self.tree, self.build = os.path.join(folder, "tree"), build
        os.makedirs(folder)
        copy_tree(pristine, build, self.tree)

    def run(self, suites, *arguments, limit_s=None):
        return Run(self.tree, self.build, suites, arguments, limit_s, self.ignored)

    def compile(self, line, text):
        """The object of the file with this text, without information for debuggers; None: it is not C."""
        path, target = os.path.join(self.tree, line.file), os.path.join(self.build, line.file[:-1] + "o")
        with open(path, "w", encoding="utf-8") as f:
            f.write(text)
        if self.run(SUITES, target, "CFLAGS=-O2", "EXTRA=-Werror=int-conversion -Werror=incompatible-pointer-types").status:
            return None
        with open(os.path.join(self.tree, target), "rb") as f:
            return f.read()

    def stages(self, line):
        """(suite, words): first the tests of the same name and room, then all that reach the file."""
        folder, *room, name = line.file.split("/")
        yield folder, f"/{name[:-2]}_test. tests/{folder}/{'/'.join(room)}{'/' if room else ''}"
        for suite in REACHED_BY[folder]:
            yield suite, ""

    def fails(self, suite, words, limit_s):
        """(what fails of these tests or None, how many passed). A test that passes when it is repeated does not count."""
        run = self.run([suite], f"test_{suite}", "T=" + words, "OF_ANY_SUITE=-a", limit_s=limit_s)
        if run.too_slow:
            return f"the time limit of {limit_s} s", 0
        if run.failed:
            again = self.run([suite], f"test_{suite}", "T=" + run.failed[0], limit_s=limit_s)
            if again.failed or again.too_slow:
                return run.failed[0], run.passed
            self.ignored.add(run.failed[0])
            return self.fails(suite, words, limit_s)
        if run.status and not run.broken:
            return "make: " + " | ".join(run.output[-2:]), 0
        return None, run.passed

    def verdict(self, line):
        """(whether it is caught, by what or why not); None: it makes no difference, or is not C."""
        path = os.path.join(self.tree, line.file)
        old = read(path)
        lines = old.split("\n")
        lines[line.number - 1] = line.new
        self.ignored = set(self.broken)
        try:
            before = self.compile(line, old)
            after = self.compile(line, "\n".join(lines))
            if after is None or after == before:
                return None
            built = self.run(SUITES, "test_binaries")
            if built.status:
                return None
            started, passed = time.monotonic(), 0
            for suite, words in self.stages(line):
                what, n = self.fails(suite, words, SUITE_S)
                if what:
                    return True, f"{what}, {time.monotonic() - started:.0f} s"
                passed += n
            return False, f"{passed} tests pass, {time.monotonic() - started:.0f} s"
        finally:
            self.compile(line, old)


def broken_tests(shop):
    """The tests that fail on the unchanged source in a workshop."""
    broken = set()
    for suite in SUITES:
        broken |= set(shop.run([suite], f"test_{suite}").failed)
    for test in sorted(broken):
        print(f"unchanged: {test} fails, and does not count", flush=True)
    return broken


def try_random(args, pristine, scratch):
    """Whether each of the random changes is caught, in the order in which that is known, and printed."""
    # The names of folders are short, because tests put sockets and longer paths below.
    broken = broken_tests(Workshop(pristine, args.build, os.path.join(scratch, "u"))) if args.sample else set()
    drawn, caught, left, lock = Drawn(pristine, args.seed or default_seed(), args.of), [], [args.sample], threading.Lock()

    def work(number):
        shop = Workshop(pristine, args.build, os.path.join(scratch, str(number)), broken)
        while True:
            with lock:
                if left[0] == 0:
                    return
                left[0] -= 1
            outcome = None
            while outcome is None:
                line = drawn.next()
                outcome = shop.verdict(line)
            with lock:
                caught.append(outcome[0])
                print(f"{'caught' if outcome[0] else 'FAIL not caught'}: {line} ({outcome[1]})", flush=True)

    pool = concurrent.futures.ThreadPoolExecutor(args.jobs)
    try:
        for done in concurrent.futures.as_completed([pool.submit(work, i) for i in range(min(args.jobs, args.sample))]):
            done.result()
    finally:
        for leader in list(Run.leaders):
            end_session(leader)
        pool.shutdown(wait=False, cancel_futures=True)
    return caught


# ---- the program ----


def default_seed():
    """The same for every run of one commit."""
    git = subprocess.run(["git", "rev-parse", "--short", "HEAD"], cwd=TREE, capture_output=True, text=True, check=False)
    return git.stdout.strip() or "1"


def arguments():
    p = argparse.ArgumentParser(description="which small changes of the source does no test notice?")
    p.add_argument("build", metavar="BUILD_DIR")
    p.add_argument("--of", default="", help="only changes of files, or entries of lists as they are printed, that contain this")
    p.add_argument("--list", help="the entries of lists whose name contains this, instead of random changes")
    p.add_argument("--sample", type=int, help="so many (60 random ones, or all entries); 0: none, which checks the lists")
    p.add_argument("--seed", help="what the sample is drawn from (default: the commit)")
    p.add_argument("--jobs", type=int, default=os.cpu_count())
    return p.parse_args()


def usable(mutants):
    """Ends the program unless every entry can be used."""
    problems = [f"FAIL {m.where}: {m}: {m.problem()}" for m in mutants if m.problem()]
    if problems:
        print("\n".join(problems))
        print(f"0 passed, {len(problems)} failed")
        sys.exit(1)


def selection(mutants, args):
    chosen = [m for m in mutants if args.of in str(m) and args.list in m.where and not m.equivalent]
    if args.sample is not None and args.sample < len(chosen):
        seed = args.seed or default_seed()
        print(f"a sample of {args.sample} of {len(chosen)}, seed {seed}")
        chosen = random.Random(seed).sample(chosen, args.sample)
    return sorted(chosen, key=lambda m: not m.file.endswith(".h"))  # first those that take longest to build


def least_caught(wanted, n):
    """Of n changes, so few are caught by chance alone if the share is `wanted`: two standard deviations below it."""
    return wanted * n - 2 * (wanted * (1 - wanted) * n) ** 0.5


def verdicts(chosen, pristine, args, limit_s):
    """Whether each of them is caught, in the order in which that is known, and printed."""
    caught = []
    pool = concurrent.futures.ThreadPoolExecutor(args.jobs)
    try:
        running = {pool.submit(verdict, m, pristine, args.build, limit_s): m for m in chosen}
        for done in concurrent.futures.as_completed(running):
            is_caught, why = done.result()
            caught.append(is_caught)
            print(f"{'caught' if is_caught else 'FAIL not caught'}: {running[done]} ({why})", flush=True)
    finally:
        pool.shutdown(wait=False, cancel_futures=True)
        for leader in list(Run.leaders):
            end_session(leader)
        pool.shutdown()
    return caught


def main():
    signal.signal(signal.SIGTERM, lambda *_: sys.exit("stopped"))
    status = isolated(sys.argv[1:])
    if status is not None:
        return status
    args = arguments()
    mutants = [m for path in sorted(glob.glob(os.path.join(HERE, "*.txt"))) for m in read_list(path)]
    usable(mutants)
    print(f"{len(mutants)} entries apply, {sum(1 for m in mutants if m.equivalent)} of them are equivalent")
    wanted = WANTED if args.list is not None else WANTED_RANDOM
    with tempfile.TemporaryDirectory(prefix="m-") as scratch:
        pristine = os.path.join(scratch, "tree")
        copy_tree(TREE, args.build, pristine)
        if args.list is not None:
            chosen = selection(mutants, args)
            limit_s = 30 + 3 * pass_without_mutants(chosen, pristine, args.build)
            caught = verdicts(chosen, pristine, args, limit_s)
        else:
            args.sample = 60 if args.sample is None else args.sample
            args.seed = args.seed or default_seed()
            print(f"{args.sample} random changes, seed {args.seed}")
            caught = try_random(args, pristine, scratch)
    print(f"{sum(caught)} passed, {len(caught) - sum(caught)} failed")
    return 0 if sum(caught) >= least_caught(wanted, len(caught)) else 1


if __name__ == "__main__":
    sys.exit(main())
