/* top_screen.h - what `delaunay top` shows on a terminal, as lines that fit. */
#pragma once

#include <stdbool.h>
#include <stddef.h>
#include <stdio.h>

enum { TOP_FACTS = 64, TOP_ROOM = 32, TOP_COMMANDS = 40 };

/* The facts of INFO, as far as there is room, and its rows about commands. */
struct top_facts {
    char key[TOP_FACTS][TOP_ROOM], value[TOP_FACTS][TOP_ROOM];
    size_t n;
    struct top_command {
        char name[16];
        double calls, errors, p50_us, p99_us, max_us, rate;
    } command[TOP_COMMANDS];
    size_t commands;
};

/* Takes a row of INFO, `key:value`. */
void top_take(struct top_facts *f, const char *row, size_t len);

/* The value of a fact, NULL if there is none. */
const char *top_value(const struct top_facts *f, const char *key);

/* Draws at most `lines` lines of at most `columns` columns, without a line end after the last; `seconds` have
 * passed since `before`, 0 if there is none. */
struct top_view {
    unsigned lines, columns;
    double seconds;
    bool paused, by_time, plain;
};

void top_draw(FILE *out, struct top_facts *now, const struct top_facts *before,
              const struct top_view *view);
