/* json_scan.c - see json_scan.h. A recursive descent. */
#include "clients/reading/json_scan.h"

char json_peek(struct json_scan *j)
{
    for (; j->p < j->end; j->p++) {
        if (*j->p == '\n')
            j->line++;
        else if (*j->p != ' ' && *j->p != '\t' && *j->p != '\r')
            return *j->p;
    }
    return 0;
}

bool json_take(struct json_scan *j, char c)
{
    if (json_peek(j) != c || j->p == j->end)
        return false;
    j->p++;
    return true;
}

bool json_take_string(struct json_scan *j, struct json_part *part)
{
    if (!json_take(j, '"'))
        return false;
    part->text = j->p;
    for (; j->p < j->end && *j->p != '"'; j->p++) {
        j->line += *j->p == '\n';
        if (*j->p == '\\')
            j->p++;
    }
    if (j->p >= j->end)
        return false;
    part->len = (size_t)(j->p - part->text);
    j->p++;
    return true;
}

/* A number, true, false, null, or what programs write in their place: NaN, Infinity. */
static bool take_word(struct json_scan *j)
{
    const char *from = j->p;
    while (j->p < j->end &&
           ((*j->p >= '0' && *j->p <= '9') || (*j->p >= 'a' && *j->p <= 'z') ||
            (*j->p >= 'A' && *j->p <= 'Z') || *j->p == '+' || *j->p == '-' || *j->p == '.'))
        j->p++;
    return j->p > from;
}

static bool take_array(struct json_scan *j)
{
    struct json_part part;
    if (json_take(j, ']'))
        return true;
    do {
        if (!json_take_value(j, &part))
            return false;
    } while (json_take(j, ','));
    return json_take(j, ']');
}

static bool take_object(struct json_scan *j)
{
    struct json_part part;
    if (json_take(j, '}'))
        return true;
    do {
        if (!json_take_string(j, &part) || !json_take(j, ':') || !json_take_value(j, &part))
            return false;
    } while (json_take(j, ','));
    return json_take(j, '}');
}

bool json_take_value(struct json_scan *j, struct json_part *part)
{
    struct json_part string;
    char c = json_peek(j);
    bool ok;
    part->text = j->p;
    if (c == '"') {
        ok = json_take_string(j, &string);
    } else if (c != '{' && c != '[') {
        ok = take_word(j);
    } else {
        if (j->depth == JSON_DEPTH)
            return false;
        j->depth++;
        j->p++;
        ok = c == '{' ? take_object(j) : take_array(j);
        j->depth--;
    }
    part->len = ok ? (size_t)(j->p - part->text) : 0;
    return ok;
}
