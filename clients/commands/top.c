/* top.c - `delaunay top`: INFO once a second, with the changes; on a terminal a screen that reacts to keys. */
#include <errno.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <time.h>
#include <unistd.h>

#include "clients/cli/json.h"
#include "clients/cli/options.h"
#include "clients/cli/output.h"
#include "clients/cli/subcommand.h"
#include "clients/commands/top_screen.h"

static bool take_fact(void *ctx, const struct delaunay_part *part)
{
    if (part->kind == DELAUNAY_PART_ROW)
        top_take(ctx, part->text, part->len);
    return true;
}

static enum delaunay_result ask(struct delaunay_client *c, struct top_facts *now)
{
    now->n = now->commands = 0;
    return delaunay_request(c, "INFO", take_fact, now);
}

/* ---- lines ---- */

/* Counters are shown with their rates. */
static void print_fact(const struct top_facts *now, const struct top_facts *before, size_t i)
{
    static const char *const counters[] = {"commands", "errors", "jobs", "connections", "refused"};
    const char *last = top_value(before, now->key[i]);
    printf("%-16s %14s", now->key[i], now->value[i]);
    for (size_t k = 0; last != NULL && k < sizeof counters / sizeof counters[0]; k++)
        if (strcmp(counters[k], now->key[i]) == 0)
            printf("   %+lld/s", strtoll(now->value[i], NULL, 10) - strtoll(last, NULL, 10));
    putchar('\n');
}

static int print_lines(struct delaunay_client *c, bool once)
{
    static struct top_facts now, before;
    for (;; sleep(1)) {
        enum delaunay_result r = ask(c, &now);
        if (r != DELAUNAY_OK)
            return request_outcome(c, r);
        for (size_t i = 0; i < now.n; i++)
            print_fact(&now, &before, i);
        if (fflush(stdout) != 0 || once)
            return EXIT_DONE;
        before = now;
    }
}

static int print_json(struct delaunay_client *c, bool once)
{
    char info[] = "INFO", *words[] = {info};
    for (;; sleep(1)) {
        int status = request_send_words(c, 1, words);
        if (status != EXIT_DONE || fflush(stdout) != 0 || once)
            return status;
    }
}

/* ---- the screen ---- */

static volatile sig_atomic_t ended;

static void end(int sig)
{
    ended = 1;
}

static double now_s(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Waits for a key; 0 after a second, or longer while the view is paused. */
static char wait_for_key(const struct top_view *v)
{
    char key = 0;
    struct pollfd p = {.fd = STDIN_FILENO, .events = POLLIN};
    int n = poll(&p, 1, v->paused ? -1 : 1000);
    if (n > 0 && read(STDIN_FILENO, &key, 1) != 1)
        key = 'q';
    return key;
}

static void measure(struct top_view *v)
{
    struct winsize size;
    bool known = ioctl(STDOUT_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0 && size.ws_row > 0;
    v->columns = known ? size.ws_col : 80;
    v->lines = known ? size.ws_row : 24;
}

static enum delaunay_result watch(struct delaunay_client *c, struct top_view *v)
{
    static struct top_facts now, before;
    double at = 0;
    char key = 0;
    for (; !ended && key != 'q' && key != 'Q' && key != 3; key = wait_for_key(v)) {
        if (key == 'p')
            v->paused = !v->paused;
        if (key == 's')
            v->by_time = !v->by_time;
        measure(v);
        if (!v->paused) {
            before = now;
            enum delaunay_result r = ask(c, &now);
            if (r != DELAUNAY_OK)
                return r;
            v->seconds = at > 0 ? now_s() - at : 0;
            at = now_s();
        }
        top_draw(stdout, &now, &before, v);
        fflush(stdout);
    }
    return DELAUNAY_OK;
}

static int show_screen(struct delaunay_client *c)
{
    struct termios before, keys;
    struct top_view v = {.plain = output_is_plain()};
    struct sigaction action = {.sa_handler = end}; /* without SA_RESTART: poll returns */
    tcgetattr(STDIN_FILENO, &before);
    keys = before;
    keys.c_lflag &= ~(tcflag_t)(ICANON | ECHO | ISIG);
    sigaction(SIGTERM, &action, NULL);
    sigaction(SIGHUP, &action, NULL);
    tcsetattr(STDIN_FILENO, TCSANOW, &keys);
    fputs("\033[?1049h\033[?25l", stdout); /* a screen of its own, without a cursor */
    enum delaunay_result r = watch(c, &v);
    fputs("\033[?25h\033[?1049l", stdout);
    fflush(stdout);
    tcsetattr(STDIN_FILENO, TCSANOW, &before);
    return request_outcome(c, r);
}

int command_top(struct delaunay_client *c, int argc, char **argv)
{
    bool once = argc == 2 && strcmp(argv[1], "--once") == 0;
    if (argc > 1 && !once)
        return options_wrong(argv[0], "top takes no argument %s",
                             argv[strcmp(argv[1], "--once") == 0 ? 2 : 1]);
    if (json_chosen())
        return print_json(c, once);
    if (!once && isatty(STDOUT_FILENO) && isatty(STDIN_FILENO))
        return show_screen(c);
    return print_lines(c, once);
}
