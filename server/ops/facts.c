/* facts.c - see facts.h. */
#include "server/ops/facts.h"

#include "proto/reply.h"

#include <inttypes.h>
#include <stdio.h>

void facts_add_text(struct facts *f, const char *key, const char *value)
{
    buf_append_text(&f->text, key);
    buf_append_char(&f->text, ':');
    reply_row_text(&f->text, value);
    f->n++;
}

void facts_add(struct facts *f, const char *key, uint64_t value)
{
    char text[24];
    snprintf(text, sizeof text, "%" PRIu64, value);
    facts_add_text(f, key, text);
}
