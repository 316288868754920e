/* command.c - any command of the protocol, as it is. */
#include "clients/command.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

#include "proto/buf.h"

bool command_show_comment(void *ctx, const struct reply_part *part)
{
    (void)ctx;
    if (part->kind == REPLY_COMMENT && isatty(STDERR_FILENO))
        fprintf(stderr, "\r%.*s\033[K%s", (int)part->len, part->text, "\r");
    return true;
}

static bool print_part(void *ctx, const struct reply_part *part)
{
    if (part->kind == REPLY_COMMENT)
        return command_show_comment(ctx, part);
    fwrite(part->text, 1, part->len, stdout);
    if (part->kind != REPLY_BYTES)
        putchar('\n');
    return !ferror(stdout);
}

int command_outcome(const struct delaunay_client *c, enum delaunay_result r)
{
    if (r == DELAUNAY_OK)
        return EXIT_DONE;
    if (r == DELAUNAY_REFUSED) {
        fprintf(stderr, "delaunay: %s\n", delaunay_status(c)->text);
        return EXIT_REFUSED;
    }
    fprintf(stderr, "delaunay: %s\n", delaunay_result_text(r));
    return r == DELAUNAY_LOST || r == DELAUNAY_BROKEN ? EXIT_NO_CONNECTION : EXIT_REFUSED;
}

/* A line break within an argument would be a second request, whose reply nobody reads. */
static bool is_one_line(int words, char **word)
{
    for (int i = 0; i < words; i++)
        if (strpbrk(word[i], "\r\n") != NULL)
            return false;
    return true;
}

int command_any(struct delaunay_client *c, int words, char **word)
{
    struct buf line = {0};
    if (!is_one_line(words, word)) {
        fprintf(stderr, "delaunay: a line break in the command\n");
        return EXIT_USAGE;
    }
    for (int i = 0; i < words; i++) {
        if (i > 0)
            buf_append_char(&line, ' ');
        buf_append_text(&line, word[i]);
    }
    enum delaunay_result r =
        line.failed ? DELAUNAY_NOMEM : delaunay_send(c, buf_head(&line), buf_len(&line));
    buf_free(&line);
    if (r == DELAUNAY_OK)
        r = delaunay_receive(c, print_part, NULL);
    if (r == DELAUNAY_REFUSED) /* the ERR line is printed: it is the reply */
        return EXIT_REFUSED;
    return command_outcome(c, r);
}
