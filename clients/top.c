/* top.c - `delaunay top`: INFO once a second, with what has changed since. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "clients/command.h"
#include "clients/json.h"
#include "clients/options.h"

enum { FACTS = 64, KEY_ROOM = 32 };

struct facts {
    char key[FACTS][KEY_ROOM], value[FACTS][KEY_ROOM];
    size_t n;
};

static bool take_fact(void *ctx, const struct reply_part *part)
{
    struct facts *f = ctx;
    if (part->kind != REPLY_ROW || f->n == FACTS)
        return true;
    const char *colon = memchr(part->text, ':', part->len);
    if (colon != NULL) {
        size_t key = (size_t)(colon - part->text);
        snprintf(f->key[f->n], KEY_ROOM, "%.*s", (int)key, part->text);
        snprintf(f->value[f->n++], KEY_ROOM, "%.*s", (int)(part->len - key - 1), colon + 1);
    }
    return true;
}

static const char *value_of(const struct facts *f, const char *key)
{
    for (size_t i = 0; i < f->n; i++)
        if (strcmp(f->key[i], key) == 0)
            return f->value[i];
    return NULL;
}

/* What counts up is shown with its rate. */
static void print_fact(const struct facts *now, const struct facts *before, size_t i)
{
    static const char *const counters[] = {"commands", "errors", "jobs", "connections", "refused"};
    const char *last = value_of(before, now->key[i]);
    printf("%-16s %14s", now->key[i], now->value[i]);
    for (size_t k = 0; last != NULL && k < sizeof counters / sizeof counters[0]; k++)
        if (strcmp(counters[k], now->key[i]) == 0)
            printf("   %+lld/s", strtoll(now->value[i], NULL, 10) - strtoll(last, NULL, 10));
    putchar('\n');
}

int command_top(struct delaunay_client *c, int argc, char **argv)
{
    static struct facts now, before;
    bool once = argc == 2 && strcmp(argv[1], "--once") == 0;
    if (argc > 1 && !once)
        return options_wrong(argv[0], "top takes no argument %s", argv[1]);
    for (; json_chosen(); sleep(1)) {
        char *words[] = {(char[]){"INFO"}};
        int status = command_any(c, 1, words);
        if (status != EXIT_DONE || fflush(stdout) != 0 || once)
            return status;
    }
    for (;; sleep(1)) {
        now.n = 0;
        enum delaunay_result r = delaunay_request(c, "INFO", take_fact, &now);
        if (r != DELAUNAY_OK)
            return command_outcome(c, r);
        if (!once)
            fputs("\033[H\033[2J", stdout);
        for (size_t i = 0; i < now.n; i++)
            print_fact(&now, &before, i);
        if (fflush(stdout) != 0 || once)
            return EXIT_DONE;
        before = now;
    }
}
