"""The metrics that a daemon reports through clients/prometheus are valid, and the dashboard and the alerts use only such metrics.

    metrics.py BUILD_DIR      the last line: N passed, N failed

Needs prometheus_client. promtool (Debian: prometheus) checks formats and expressions, where it is installed.
"""

import json
import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import urllib.request

HERE = os.path.dirname(os.path.abspath(__file__))
CLIENTS = os.path.join(HERE, "..", "..", "clients", "prometheus")
build = os.path.abspath(sys.argv[1])
outcomes = []


def check(name, good):
    outcomes.append(None if good is None else bool(good))
    if good is None:
        print(f"SKIP {name}: the Debian package prometheus is missing")
    elif not good:
        print(f"FAIL {name}")


def start(*command):
    """Starts a program that prints `ready on ADDRESS:PORT`; returns it and the port."""
    program = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
    return program, program.stdout.readline().rsplit(":", 1)[1].strip()


def free_port():
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return s.getsockname()[1]


def delaunay(port, *words):
    subprocess.run([f"{build}/delaunay", "-p", port, *words], check=True, stdout=subprocess.DEVNULL)


def scrape(port):
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/metrics", timeout=20) as reply:
        return reply.read().decode()


def value(text, name):
    found = re.search(rf"^{name} (\S+)$", text, re.M)
    return float(found.group(1)) if found else None


def promtool(*words, text=None):
    """Whether promtool is content; None where it is not installed."""
    if shutil.which("promtool") is None:
        return None
    done = subprocess.run(["promtool", *words], input=text, text=True, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
    if done.returncode != 0 or "error" in done.stdout:
        print(done.stdout)
    return done.returncode == 0


def names_in(expression):
    return set(re.findall(r"\bdelaunayd_\w+", expression))


def main():
    with tempfile.TemporaryDirectory() as scratch:
        daemon, port = start(f"{build}/delaunayd", "--port", "0", "--data", f"{scratch}/data", "--backup-dir", f"{scratch}/backups")
        listen = f"127.0.0.1:{free_port()}"
        follower, _ = start(f"{build}/delaunayd", "--port", "0", "--data", f"{scratch}/follower", "--follow", f"127.0.0.1:{port}")
        exporter, at = start(sys.executable, f"{CLIENTS}/exporter.py", "--listen", listen, "--url", f"delaunay://127.0.0.1:{port}",
                             "--delaunay", f"{build}/delaunay")
        try:
            with socket.create_connection(("127.0.0.1", int(port))) as s:
                s.sendall(b"ADD t 0 0 1 0\nWAIT 1 60\nQUIT\n")
                replies = s.makefile().read()
            check("the follower has the change", "followers=1" in replies)
            delaunay(port, "backup", "now")
            text = scrape(at)
            check("the daemon is up", value(text, "delaunayd_up") == 1)
            check("values", value(text, "delaunayd_sets") == 1 and value(text, "delaunayd_backups_total") == 1)
            check("followers", value(text, "delaunayd_followers") == 1 and value(text, 'delaunayd_follower_lag_records{follower="1"}') == 0)
            check("promtool: metrics", promtool("check", "metrics", text=text))
            known = set(re.findall(r"^# TYPE (\w+) ", text, re.M))
            check("the digest of the log is no label", "log_digest" not in text)
            check("all metrics have a type", names_in(re.sub(r"^#.*$", "", text, flags=re.M)) <= known)
            check("no metric is unknown to the program", " untyped\n" not in text)

            printed = subprocess.run([sys.executable, f"{CLIENTS}/dashboard.py"], check=True, stdout=subprocess.PIPE).stdout
            panels = json.loads(printed)["panels"]
            places = [(p["gridPos"]["x"], p["gridPos"]["y"]) for p in panels]
            check("panels of the dashboard have places and numbers of their own", len(set(places)) == len({p["id"] for p in panels}) == len(panels))
            used = set().union(*(names_in(t["expr"]) for p in panels for t in p["targets"]))
            check(f"the dashboard uses metrics that exist: {sorted(used - known)}", used and used <= known)
            with open(f"{CLIENTS}/alerts.yml", encoding="utf-8") as f:
                rules = f.read()
            used = set().union(*(names_in(e) for e in re.findall(r"^ *expr: (.*)$", rules, re.M)))
            check(f"the alerts use metrics that exist: {sorted(used - known)}", used and used <= known)
            check("promtool: alerts", promtool("check", "rules", f"{CLIENTS}/alerts.yml"))

            daemon.send_signal(signal.SIGKILL)
            daemon.wait()
            text = scrape(at)
            check("a daemon that was killed is not up", value(text, "delaunayd_up") == 0 and "delaunayd_sets" not in text)
        finally:
            for program in (daemon, follower, exporter):
                program.kill()
                program.wait()
    passed, failed, skipped = (sum(o is kind for o in outcomes) for kind in (True, False, None))
    print(f"{passed} passed, {failed} failed" + (f", {skipped} skipped" if skipped else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
