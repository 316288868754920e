#!/usr/bin/env python3
"""Prints a dashboard for Grafana.

    dashboard.py >dashboard.json      the file to import
"""

import json

SOURCE = {"type": "prometheus", "uid": "${source}"}
COLUMNS = 24  # of Grafana's grid
STAT_ROWS, GRAPH_ROWS = 4, 8  # heights of panels

OF = '{instance=~"$instance"}'
PER_S = OF + "[$__rate_interval]"
OF_FOLLOWER = f" * on(instance, follower) group_left(address) delaunayd_follower_info{OF}"
YES_OR_NO = [{"type": "value", "options": {"0": {"text": "no", "color": "red"}, "1": {"text": "yes", "color": "green"}}}]
STACKED = {"stacking": {"mode": "normal"}, "fillOpacity": 30}
MEMORY = {
    "sets": "memory",
    "builds": "memory_builds",
    "edits": "memory_edits",
    "loads": "loading",
    "log": "memory_log",
    "replies": "memory_replies",
    "clients": "memory_clients",
    "kept for reuse": "memory_kept",
}


def now(metric, legend=""):
    """A query: the legend beside the daemon's address, and the expression."""
    return ("{{instance}} " + legend).strip(), f"delaunayd_{metric}{OF}"


def rate(metric, legend=""):
    return ("{{instance}} " + legend).strip(), f"rate(delaunayd_{metric}{PER_S})"


def calls(metric):
    return "{{command}}", f"sum by (command) (rate(delaunayd_command_{metric}_total{PER_S}))"


def slowest(metric):
    return "{{command}}", f"max by (command) (delaunayd_command_{metric}_seconds{OF})"


def panel(kind, title, width, unit, *queries, **defaults):
    rows = STAT_ROWS if kind == "stat" else GRAPH_ROWS
    targets = [
        {"datasource": SOURCE, "expr": expression, "legendFormat": legend, "refId": chr(ord("A") + k)}
        for k, (legend, expression) in enumerate(queries)
    ]
    made = {
        "type": kind,
        "title": title,
        "datasource": SOURCE,
        "gridPos": {"w": width, "h": rows},
        "fieldConfig": {"defaults": {"unit": unit, "min": 0, **defaults}, "overrides": []},
        "targets": targets,
    }
    if kind == "timeseries":
        made["options"] = {"legend": {"displayMode": "list", "placement": "bottom"}, "tooltip": {"mode": "multi", "sort": "desc"}}
    return made


def stat(title, width, unit, *queries, **defaults):
    return panel("stat", title, width, unit, *queries, **defaults)


def graph(title, width, unit, *queries, **defaults):
    return panel("timeseries", title, width, unit, *queries, **defaults)


PANELS = [
    stat("Answers", 4, "none", now("up"), mappings=YES_OR_NO),
    stat("Changes can be saved", 8, "none", now("durability_info", "{{durability}}")),
    stat("Sets", 4, "none", now("sets")),
    stat("Since the last backup", 4, "s", ("{{instance}}", f"time() - (delaunayd_backup_timestamp_seconds{OF} > 0)")),
    stat("Up since", 4, "s", now("uptime_seconds")),
    graph("Requests per second, by command", 12, "reqps", calls("calls")),
    graph("Errors per second, by command", 12, "reqps", calls("errors")),
    graph("99th percentile since the start, by command", 12, "s", slowest("p99")),
    graph("99th percentile of waiting since the start", 12, "s", slowest("wait_p99")),
    graph("Memory by kind", 12, "bytes", *((kind, f"sum(delaunayd_{name}_bytes{OF})") for kind, name in MEMORY.items()), custom=STACKED),
    graph("Memory and its limit", 12, "bytes",
          now("memory_used_bytes", "used"), now("max_memory_bytes", "limit"), now("resident_bytes", "resident")),
    graph("Changes per second", 8, "ops", rate("log_lsn")),
    graph("Syncs of the log per second, and failures", 8, "ops", rate("log_syncs_total", "syncs"), rate("log_failures_total", "failures")),
    graph("Log since the last snapshot, and that snapshot", 8, "bytes", now("log_bytes", "log"), now("snapshot_bytes", "snapshot")),
    graph("Clients and watchers", 8, "none", now("clients", "clients"), now("watchers", "watchers")),
    graph("Events to watchers per second", 8, "ops", rate("events_total")),
    graph("Jobs of the workers", 8, "none", now("jobs_running", "under way or waiting"), now("jobs_waiting", "waiting")),
    graph("Followers, and how many are needed", 8, "none", now("followers", "connected"), now("min_followers", "needed")),
    graph("Lag of followers, time", 8, "s", ("{{instance}}: {{address}}", f"delaunayd_follower_lag_seconds{OF}{OF_FOLLOWER}")),
    graph("Lag of followers, changes", 8, "none",
          ("{{instance}}: {{address}}", f"delaunayd_follower_lag_records{OF}{OF_FOLLOWER}"),
          ("{{instance}}: not received", f'delaunayd_link_lag_records{OF} and on(instance) delaunayd_role_info{{role="follower"}}')),
    graph("Roles, and connections to leaders", 24, "none",
          now("role_info", "{{role}}"), ("{{instance}} {{link}}", 'delaunayd_link_info{instance=~"$instance", link!=""}')),
]


def place(panels):
    """Numbers the panels, and places them from left to right in rows of COLUMNS."""
    x = y = 0
    for number, one in enumerate(panels, 1):
        at = one["gridPos"]
        at.update(x=x, y=y)
        x += at["w"]
        if x == COLUMNS:
            x, y = 0, y + at["h"]
        one["id"] = number
    return panels


def dashboard():
    daemons = {
        "name": "instance",
        "label": "Daemon",
        "type": "query",
        "datasource": SOURCE,
        "query": "label_values(delaunayd_up, instance)",
        "refresh": 2,
        "multi": True,
        "includeAll": True,
        "allValue": ".*",
    }
    return {
        "title": "delaunayd",
        "uid": "delaunayd",
        "schemaVersion": 37,
        "version": 1,
        "refresh": "10s",
        "time": {"from": "now-1h", "to": "now"},
        "tags": ["delaunayd"],
        "templating": {"list": [{"name": "source", "label": "Data source", "type": "datasource", "query": "prometheus"}, daemons]},
        "panels": place(PANELS),
    }


if __name__ == "__main__":
    print(json.dumps(dashboard(), indent=1))
