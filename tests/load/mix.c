/* mix.c - see mix.h. Commands of other servers are included to measure these with the same tool; their
 * replies have a fixed number of lines, ours what the status line announces. */
#include "tests/load/mix.h"

#include "tests/load/resp.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum shape { PLAIN, AT_PLACE, OF_POINT, OF_SET, OF_KEY };

static const struct kind {
    const char *name;
    enum shape shape;
    const char *head, *tail; /* before and after the random part */
    unsigned lines;
} kinds[MIX_KINDS] = {
    {"ping", PLAIN, "PING", "\n", 0},
    {"add", AT_PLACE, "ADD", "\n", 0},
    {"nearest", AT_PLACE, "NEAREST", "\n", 0},
    {"nearest-32", AT_PLACE, "NEAREST", " 32\n", 0},
    {"within-100", AT_PLACE, "WITHIN", " 5642\n", 0}, /* of a million points */
    {"locate", AT_PLACE, "LOCATE", "\n", 0},
    {"lists", OF_POINT, "LISTS", "\n", 0},
    {"triangulate", OF_SET, "TRIANGULATE", " METHOD auto\n", 0},
    {"redis-ping", PLAIN, "PING", "\r\n", 1},
    {"redis-get", OF_KEY, "GET", "\r\n", 2},
    {"beanstalkd-use", PLAIN, "use load", "\r\n", 1},
};

const char *mix_names(void)
{
    return "ping add nearest nearest-32 within-100 locate lists triangulate redis-ping redis-get "
           "beanstalkd-use";
}

static const struct kind *find(const char *name, size_t len)
{
    for (size_t i = 0; i < MIX_KINDS; i++)
        if (strlen(kinds[i].name) == len && memcmp(kinds[i].name, name, len) == 0)
            return &kinds[i];
    return NULL;
}

bool mix_read(struct mix *m, const char *text)
{
    m->weights = 0;
    memset(m->weight, 0, sizeof m->weight);
    for (bool more = true; more;) {
        size_t len = strcspn(text, "=,");
        const struct kind *k = find(text, len);
        char *end = NULL;
        unsigned long weight = text[len] == '=' ? strtoul(text + len + 1, &end, 10) : 1;
        text = end != NULL ? end : text + len;
        if (k == NULL || weight == 0 || weight > 1000000 || (*text != ',' && *text != '\0') ||
            (m->weights > 0 && m->lines != k->lines))
            return false;
        m->lines = k->lines;
        m->weight[k - kinds] += (uint32_t)weight;
        m->weights += (uint32_t)weight;
        more = *text++ == ',';
    }
    return true;
}

uint32_t mix_random(struct mix *m, uint32_t n) /* SplitMix64 [Steele, Lea & Flood 2014] */
{
    uint64_t z = m->state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return (uint32_t)(((z ^ z >> 31) >> 32) * n >> 32);
}

static const struct kind *draw(struct mix *m)
{
    uint32_t at = mix_random(m, m->weights), i = 0;
    while (at >= m->weight[i])
        at -= m->weight[i++];
    return &kinds[i];
}

/* A request line. */
static size_t next_line(struct mix *m, char *to)
{
    const struct kind *k = draw(m);
    int n = 0;
    switch (k->shape) {
    case PLAIN:
        n = snprintf(to, MIX_LINE_LIMIT, "%s%s", k->head, k->tail);
        break;
    case AT_PLACE:
        n = snprintf(to, MIX_LINE_LIMIT, "%s %s %u.%03u %u.%03u%s", k->head, m->set,
                     mix_random(m, MIX_SPAN), mix_random(m, 1000), mix_random(m, MIX_SPAN),
                     mix_random(m, 1000), k->tail);
        break;
    case OF_POINT:
        n = snprintf(to, MIX_LINE_LIMIT, "%s %s %" PRIu32 "%s", k->head, m->set,
                     mix_random(m, m->points > 0 ? m->points : 1), k->tail);
        break;
    case OF_SET:
        n = snprintf(to, MIX_LINE_LIMIT, "%s %s%s", k->head, m->set, k->tail);
        break;
    case OF_KEY:
        n = snprintf(to, MIX_LINE_LIMIT, "%s key:%012" PRIu32 "%s", k->head,
                     mix_random(m, m->points > 0 ? m->points : 1), k->tail);
        break;
    }
    return (size_t)n;
}

size_t mix_next(struct mix *m, char *to)
{
    char line[MIX_LINE_LIMIT];
    return m->resp ? resp_encode(to, line, next_line(m, line)) : next_line(m, to);
}
