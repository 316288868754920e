/* top_screen.c - see top_screen.h. */
#include "clients/commands/top_screen.h"

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

/* ---- facts ---- */

static void take_command(struct top_facts *f, const char *name, size_t len, const char *values)
{
    if (f->commands == TOP_COMMANDS)
        return;
    struct top_command *c = &f->command[f->commands++];
    *c = (struct top_command){.rate = 0};
    snprintf(c->name, sizeof c->name, "%.*s", (int)len, name);
    sscanf(values, "calls=%lf,errors=%lf,p50_us=%lf,p99_us=%lf,max_us=%lf", &c->calls, &c->errors,
           &c->p50_us, &c->p99_us, &c->max_us);
}

void top_take(struct top_facts *f, const char *row, size_t len)
{
    char values[200];
    const char *colon = memchr(row, ':', len);
    if (colon == NULL)
        return;
    size_t key = (size_t)(colon - row), rest = len - key - 1;
    if (key > 8 && memcmp(row, "command_", 8) == 0) {
        snprintf(values, sizeof values, "%.*s", (int)rest, colon + 1);
        take_command(f, row + 8, key - 8, values);
    }
    if (f->n == TOP_FACTS)
        return;
    snprintf(f->key[f->n], TOP_ROOM, "%.*s", (int)key, row);
    snprintf(f->value[f->n++], TOP_ROOM, "%.*s", (int)rest, colon + 1);
}

const char *top_value(const struct top_facts *f, const char *key)
{
    for (size_t i = 0; i < f->n; i++)
        if (strcmp(f->key[i], key) == 0)
            return f->value[i];
    return NULL;
}

static double number(const struct top_facts *f, const char *key)
{
    const char *value = top_value(f, key);
    return value != NULL ? strtod(value, NULL) : 0;
}

/* ---- lines ---- */

struct screen {
    FILE *out;
    const struct top_facts *now, *before;
    const struct top_view *view;
    unsigned line;
};

/* The next line, cut to the width; nothing when the screen is full. The last line is for the keys. */
__attribute__((format(printf, 2, 3))) static void put(struct screen *s, const char *format, ...)
{
    char text[400];
    va_list values;
    if (s->line + 1 >= s->view->lines)
        return;
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    fprintf(s->out, "\033[K%.*s\r\n", (int)s->view->columns, text);
    s->line++;
}

/* The rate of a counter, per second. */
static double rate(const struct screen *s, const char *key)
{
    return s->view->seconds > 0 ? (number(s->now, key) - number(s->before, key)) / s->view->seconds
                                : 0;
}

/* Bytes in a width of 8. */
static const char *bytes(const struct top_facts *f, const char *key, char *room)
{
    static const char *const unit[] = {"B", "KiB", "MiB", "GiB", "TiB"};
    double v = number(f, key);
    size_t i = 0;
    for (; v >= 1000 && i < 4; i++)
        v /= 1024;
    snprintf(room, 24, i == 0 || v >= 100 ? "%.0f %s" : "%.1f %s", v, unit[i]);
    return room;
}

static const char *text(const struct top_facts *f, const char *key)
{
    const char *value = top_value(f, key);
    return value != NULL ? value : "-";
}

static void put_server(struct screen *s)
{
    const struct top_facts *f = s->now;
    char a[24], b[24], c[24], d[24], e[24];
    long up = (long)number(f, "uptime_s");
    put(s, "delaunayd %s  up %ld d %02ld:%02ld:%02ld  threads %s  sets %s", text(f, "version"),
        up / 86400, up / 3600 % 24, up / 60 % 60, up % 60, text(f, "threads"), text(f, "sets"));
    put(s, "%s", "");
    put(s, "requests  %-12s %+8.0f/s   errors %-10s %+6.0f/s   slow %s", text(f, "commands"),
        rate(s, "commands"), text(f, "errors"), rate(s, "errors"), text(f, "slow"));
    put(s, "jobs      %-12s %+8.0f/s   running %-6s waiting %-6s shared %s", text(f, "jobs"),
        rate(s, "jobs"), text(f, "jobs_running"), text(f, "jobs_waiting"), text(f, "jobs_shared"));
    put(s, "clients   %-12s of %-9s connections %-8s %+6.0f/s   refused %s", text(f, "clients"),
        text(f, "max_clients"), text(f, "connections"), rate(s, "connections"), text(f, "refused"));
    put(s, "memory    %-12s of %-9s peak %-10s resident %-10s kept %s", bytes(f, "memory_used", a),
        bytes(f, "max_memory", b), bytes(f, "memory_peak", c), bytes(f, "resident", d),
        bytes(f, "memory_kept", e));
    put(s, "disk      %-12s log %-12s syncs %-8s %+6.0f/s   failures %s", text(f, "durability"),
        bytes(f, "log_bytes", a), text(f, "log_syncs"), rate(s, "log_syncs"),
        text(f, "log_failures"));
    put(s, "%s", "");
}

/* ---- commands ---- */

static void find_rates(const struct screen *s, struct top_facts *now)
{
    for (size_t i = 0; i < now->commands; i++) {
        double last = 0;
        for (size_t k = 0; k < s->before->commands; k++)
            if (strcmp(s->before->command[k].name, now->command[i].name) == 0)
                last = s->before->command[k].calls;
        now->command[i].rate =
            s->view->seconds > 0 ? (now->command[i].calls - last) / s->view->seconds : 0;
    }
}

static int falling(double a, double b)
{
    return (a < b) - (a > b);
}

static int by_calls(const void *a, const void *b)
{
    const struct top_command *x = a, *y = b;
    int order = falling(x->rate, y->rate);
    return order != 0 ? order : falling(x->calls, y->calls);
}

static int by_time(const void *a, const void *b)
{
    return falling(((const struct top_command *)a)->p99_us,
                   ((const struct top_command *)b)->p99_us);
}

static void put_commands(struct screen *s, struct top_facts *now)
{
    const char *on = s->view->plain ? "" : "\033[7m", *off = s->view->plain ? "" : "\033[0m";
    find_rates(s, now);
    qsort(now->command, now->commands, sizeof now->command[0],
          s->view->by_time ? by_time : by_calls);
    if (s->line + 1 >= s->view->lines)
        return;
    fprintf(s->out, "%s%-*.*s%s\r\n", on, (int)s->view->columns, (int)s->view->columns,
            "COMMAND             CALLS        /s    ERRORS    p50 us    p99 us      max us", off);
    s->line++;
    for (size_t i = 0; i < now->commands; i++) {
        const struct top_command *c = &now->command[i];
        put(s, "%-14s %10.0f %9.0f %9.0f %9.1f %9.1f %11.1f", c->name, c->calls, c->rate, c->errors,
            c->p50_us, c->p99_us, c->max_us);
    }
}

void top_draw(FILE *out, struct top_facts *now, const struct top_facts *before,
              const struct top_view *view)
{
    struct screen s = {out, now, before, view, 0};
    fputs("\033[H", out);
    put_server(&s);
    put_commands(&s, now);
    while (s.line + 1 < view->lines)
        put(&s, "%s", "");
    fprintf(out, "\033[K%.*s\033[J", (int)view->columns,
            view->paused ? "paused: p continues, q quits"
                         : "q quit   p pause   s sort by calls or time   space now");
}
