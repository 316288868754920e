/* progress.c - one line, redrawn in place. */
#include "clients/files/progress.h"

#include <stdio.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define CELLS 30

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

void progress_start(struct progress *p, const char *what)
{
    p->what = what;
    p->shown = isatty(STDERR_FILENO);
    p->started = now_s();
    p->drawn = 0;
}

static void draw_bar(double part)
{
    char bar[CELLS + 1];
    size_t full = (size_t)(part * CELLS);
    memset(bar, '-', CELLS);
    memset(bar, '#', full <= CELLS ? full : CELLS);
    bar[CELLS] = 0;
    fprintf(stderr, "[%s] %3.0f %%  ", bar, 100 * part);
}

/* The time left, from the time that the part done took. */
static void draw_rest(double part, double elapsed)
{
    double rest = elapsed * (1 - part) / part;
    if (elapsed > 1 && rest >= 1)
        fprintf(stderr, ", %.0f s left", rest);
}

void progress_update(struct progress *p, uint64_t done, uint64_t total, uint64_t points)
{
    double now = now_s(), elapsed = now - p->started;
    if (!p->shown || now - p->drawn < 0.1)
        return;
    p->drawn = now;
    double part = total > 0 ? (double)done / (double)total : 0;
    fprintf(stderr, "\r%s ", p->what);
    if (total > 0)
        draw_bar(part);
    fprintf(stderr, "%.2f M points", 1e-6 * (double)points);
    if (elapsed > 0.05)
        fprintf(stderr, ", %.2f M/s", 1e-6 * (double)points / elapsed);
    if (part > 0)
        draw_rest(part, elapsed);
    fputs("\033[K", stderr);
}

void progress_end(struct progress *p)
{
    if (p->shown && p->drawn > 0)
        fputs("\r\033[K", stderr);
}
