#!/usr/bin/env python3
"""Serves the metrics of a delaunayd to Prometheus.

    exporter.py [--listen ADDRESS:PORT] [--url delaunay://[:TOKEN@]HOST[:PORT]] [--delaunay PROGRAM]

Needs prometheus_client (Debian: python3-prometheus-client) and the program `delaunay`, whose subcommand `metrics` converts INFO;
so what a later daemon reports appears here, too. At each scrape it asks the daemon once. `delaunayd_up` is 0 while that fails. A
token in $DELAUNAY_TOKEN stays out of the list of processes; one for reading is enough.
"""

import argparse
import os
import subprocess
import sys
import threading

from prometheus_client import CollectorRegistry, start_http_server
from prometheus_client.core import GaugeMetricFamily
from prometheus_client.parser import text_string_to_metric_families


class Daemon:
    """A collector: asks the daemon when it is asked."""

    def __init__(self, program, url, timeout_s):
        self._command = [program] + (["-u", url] if url else []) + ["metrics"]
        self._timeout_s = timeout_s

    def describe(self):
        return []  # nothing is asked when it is registered

    def collect(self):
        try:
            done = subprocess.run(self._command, capture_output=True, text=True, timeout=self._timeout_s, check=True)
            families = list(text_string_to_metric_families(done.stdout))
        except (OSError, subprocess.SubprocessError, ValueError) as error:
            families = []
            why = getattr(error, "stderr", None) or str(error)
            print(f"no metrics: {why.strip()}", file=sys.stderr, flush=True)
        up = GaugeMetricFamily("delaunayd_up", "Whether the daemon answers.", value=int(bool(families)))
        return [up] + families


def main():
    parser = argparse.ArgumentParser(description="Serves the metrics of a delaunayd to Prometheus.")
    parser.add_argument("--listen", default="127.0.0.1:9674", metavar="ADDRESS:PORT", help="(%(default)s)")
    parser.add_argument("--url", default=None, help="of the daemon (as delaunay's own default)")
    parser.add_argument("--delaunay", default=os.environ.get("DELAUNAY", "delaunay"), metavar="PROGRAM", help="(%(default)s)")
    parser.add_argument("--timeout", default=5.0, type=float, metavar="SECONDS", help="of one request (%(default)s)")
    options = parser.parse_args()
    address, _, port = options.listen.rpartition(":")
    registry = CollectorRegistry()
    registry.register(Daemon(options.delaunay, options.url, options.timeout))
    start_http_server(int(port), addr=address.strip("[]") or "0.0.0.0", registry=registry)
    print(f"ready on {options.listen}", flush=True)
    threading.Event().wait()


if __name__ == "__main__":
    try:
        main()
    except KeyboardInterrupt:
        pass
