/* watch.c - `delaunay watch`: prints the events of a set until it is dropped. */
#include <stdio.h>
#include <string.h>

#include "clients/cli/json.h"
#include "clients/cli/options.h"
#include "clients/cli/subcommand.h"

struct printer {
    struct json_reply json;
    bool dropped; /* the set, with the event that is being printed */
};

static bool is_last_word(const struct delaunay_part *part, const char *word)
{
    size_t n = strlen(word);
    return part->len > n && memcmp(part->text + part->len - n, word, n) == 0 &&
           part->text[part->len - n - 1] == ' ';
}

static bool print_part(void *ctx, const struct delaunay_part *part)
{
    struct printer *p = ctx;
    if (part->kind == DELAUNAY_PART_EVENT)
        p->dropped = is_last_word(part, "dropped");
    if (json_chosen())
        json_part(&p->json, part);
    else
        printf("%.*s\n", (int)part->len, part->text);
    if (!part->last)
        return true;
    if (json_chosen())
        json_end(&p->json);
    p->json = (struct json_reply){.rows = 0};
    return fflush(stdout) == 0;
}

int command_watch(struct delaunay_client *c, int argc, char **argv)
{
    struct printer p = {.dropped = false};
    bool last = false;
    if (argc < 2)
        return options_wrong(argv[0], "watch needs a set");
    delaunay_expect_events(c);
    int status = request_send_words(c, argc, argv);
    enum delaunay_result r = fflush(stdout) == 0 ? DELAUNAY_OK : DELAUNAY_STOPPED;
    while (status == EXIT_DONE && r == DELAUNAY_OK && !(p.dropped && last))
        r = delaunay_receive_part(c, -1, print_part, &p, &last);
    return status != EXIT_DONE ? status : request_outcome(c, r);
}
