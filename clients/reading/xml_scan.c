/* xml_scan.c - see xml_scan.h. */
#include "clients/reading/xml_scan.h"

#include "proto/text.h"

#include <string.h>

static bool begins(const struct xml_scan *x, const char *text)
{
    size_t n = strlen(text);
    return (size_t)(x->end - x->p) >= n && memcmp(x->p, text, n) == 0;
}

/* Moves to `to`, and counts lines. */
static void move(struct xml_scan *x, const char *to)
{
    for (; x->p < to; x->p++)
        x->line += *x->p == '\n';
}

/* Passes what ends with this text; false if that does not come. */
static bool pass(struct xml_scan *x, const char *ending)
{
    size_t n = strlen(ending);
    const char *at = memmem(x->p, (size_t)(x->end - x->p), ending, n);
    if (at != NULL)
        move(x, at + n);
    return at != NULL;
}

/* <!DOCTYPE ... [ ... ]>: brackets may be nested, once. */
static bool pass_declaration(struct xml_scan *x)
{
    int depth = 0;
    for (const char *p = x->p; p < x->end; p++) {
        depth += *p == '[' ? 1 : *p == ']' ? -1 : 0;
        if (*p == '>' && depth <= 0) {
            move(x, p + 1);
            return true;
        }
    }
    return false;
}

/* The tag that begins at '<'. */
static bool read_tag(struct xml_scan *x, struct xml_tag *tag)
{
    const char *p = x->p + 1, *end = p;
    for (char quote = '\0'; end < x->end && (quote != '\0' || *end != '>'); end++)
        if (quote == *end)
            quote = '\0';
        else if (quote == '\0' && (*end == '"' || *end == '\''))
            quote = *end;
    if (end == x->end)
        return false;
    tag->line = x->line;
    move(x, end + 1);
    tag->closes = p < end && *p == '/';
    tag->opens = !tag->closes;
    p += tag->closes;
    if (tag->opens && end > p && end[-1] == '/') {
        tag->closes = true;
        end--;
    }
    const char *name = p;
    for (; p < end && !text_is_space(*p); p++)
        if (*p == ':')
            name = p + 1;
    tag->name = (struct xml_part){name, (size_t)(p - name)};
    tag->attribute = (struct xml_part){p, (size_t)(end - p)};
    return true;
}

int xml_next(struct xml_scan *x, struct xml_tag *tag)
{
    *tag = (struct xml_tag){.opens = false};
    for (const char *from = x->p; x->p < x->end; from = x->p) {
        const char *at = memchr(x->p, '<', (size_t)(x->end - x->p));
        if (at == NULL) {
            move(x, x->end);
            return 0;
        }
        tag->before = (struct xml_part){from, (size_t)(at - from)};
        move(x, at);
        bool ok = begins(x, "<!--")        ? pass(x, "-->")
                  : begins(x, "<![CDATA[") ? pass(x, "]]>")
                  : begins(x, "<?")        ? pass(x, "?>")
                  : begins(x, "<!")        ? pass_declaration(x)
                                           : read_tag(x, tag);
        if (!ok)
            return -1;
        if (tag->opens || tag->closes)
            return 1;
    }
    return 0;
}

bool xml_attribute(const struct xml_tag *tag, const char *name, struct xml_part *value)
{
    const char *p = tag->attribute.text, *end = p + tag->attribute.len;
    while (p < end) {
        while (p < end && text_is_space(*p))
            p++;
        const char *key = p;
        while (p < end && *p != '=' && !text_is_space(*p))
            p++;
        struct xml_part found = {key, (size_t)(p - key)};
        while (p < end && *p != '"' && *p != '\'')
            p++;
        if (p == end)
            return false;
        const char *close = memchr(p + 1, *p, (size_t)(end - p - 1));
        if (close == NULL)
            return false;
        *value = (struct xml_part){p + 1, (size_t)(close - p - 1)};
        if (xml_is(found, name))
            return true;
        p = close + 1;
    }
    return false;
}

bool xml_is(struct xml_part part, const char *text)
{
    return part.len == strlen(text) && memcmp(part.text, text, part.len) == 0;
}
