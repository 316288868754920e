/* request.c - see request.h. */
#include "clients/cli/request.h"

#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <unistd.h>

#include "clients/cli/json.h"
#include "clients/cli/message.h"
#include "proto/buf.h"

bool request_show_comment(void *ctx, const struct delaunay_part *part)
{
    if (part->kind == DELAUNAY_PART_COMMENT && isatty(STDERR_FILENO))
        fprintf(stderr, "\r%.*s\033[K%s", (int)part->len, part->text, "\r");
    return true;
}

struct delaunay_client *request_connect(const struct url *where, char *why, size_t room)
{
    struct delaunay_client *c = delaunay_connect(where->host, where->port, why, room);
    if (c == NULL || where->token[0] == '\0')
        return c;
    enum delaunay_result r = delaunay_authenticate(c, where->token);
    if (r == DELAUNAY_OK)
        return c;
    snprintf(why, room, "%s",
             r == DELAUNAY_REFUSED ? delaunay_status(c)->text : delaunay_result_text(r));
    delaunay_close(c);
    return NULL;
}

static bool print_part(void *ctx, const struct delaunay_part *part)
{
    if (part->kind == DELAUNAY_PART_COMMENT)
        return request_show_comment(ctx, part);
    if (json_chosen())
        return json_part(ctx, part);
    fwrite(part->text, 1, part->len, stdout);
    if (part->kind != DELAUNAY_PART_BYTES)
        putchar('\n');
    return !ferror(stdout);
}

int request_outcome(const struct delaunay_client *c, enum delaunay_result r)
{
    if (r == DELAUNAY_OK)
        return EXIT_DONE;
    if (r == DELAUNAY_REFUSED && json_chosen()) {
        struct json_reply j = {.rows = 0};
        json_part(&j, delaunay_status(c));
        json_end(&j);
        return EXIT_REFUSED;
    }
    if (r == DELAUNAY_REFUSED) {
        message_print("%s", delaunay_status(c)->text);
        return EXIT_REFUSED;
    }
    if (r == DELAUNAY_STOPPED && ferror(stdout)) /* main() says so */
        return EXIT_REFUSED;
    message_print("%s", delaunay_result_text(r));
    return r == DELAUNAY_LOST || r == DELAUNAY_BROKEN ? EXIT_NO_CONNECTION : EXIT_REFUSED;
}

static bool asks_for_bytes(int words, char **word)
{
    size_t n = strlen(word[words - 1]);
    return n >= 6 && strcasecmp(word[words - 1] + n - 6, "binary") == 0;
}

int request_send_words(struct delaunay_client *c, int words, char **word)
{
    struct buf line = {0};
    struct json_reply j = {.text = strncasecmp(word[0], "help", 4) == 0};
    if (json_chosen() && asks_for_bytes(words, word)) {
        message_print("a binary reply cannot be JSON");
        return EXIT_USAGE;
    }
    for (int i = 0; i < words; i++) {
        if (i > 0)
            buf_append_char(&line, ' ');
        buf_append_text(&line, word[i]);
    }
    buf_append_char(&line, '\0');
    enum delaunay_result r =
        line.failed ? DELAUNAY_NOMEM : delaunay_request(c, buf_head(&line), print_part, &j);
    buf_free(&line);
    if (r == DELAUNAY_BADREQUEST) {
        message_print("%s", delaunay_result_text(r));
        return EXIT_USAGE;
    }
    if (json_chosen())
        json_end(&j);
    if (r == DELAUNAY_REFUSED) /* the ERR line is printed: it is the reply */
        return EXIT_REFUSED;
    return request_outcome(c, r);
}
