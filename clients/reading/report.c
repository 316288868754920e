/* report.c - see report.h. */
#include "clients/reading/report.h"

#include <stdarg.h>
#include <string.h>

/* The length of the UTF-8 character at s[0 .. len), 0 if it is none. */
static size_t utf8_length(const unsigned char *s, size_t len)
{
    size_t n = s[0] < 0x80                   ? 1
               : s[0] >= 0xC2 && s[0] < 0xE0 ? 2
               : s[0] >= 0xE0 && s[0] < 0xF0 ? 3
               : s[0] >= 0xF0 && s[0] < 0xF5 ? 4
                                             : 0;
    if (n > len)
        return 0;
    for (size_t i = 1; i < n; i++)
        if ((s[i] & 0xC0) != 0x80)
            return 0;
    return n;
}

const char *report_clean(char *to, size_t room, const char *text, size_t len)
{
    const unsigned char *s = (const unsigned char *)text;
    size_t n = 0, fits = 0; /* where "..." fits behind */
    for (size_t i = 0; i < len;) {
        size_t c = utf8_length(s + i, len - i);
        if (n + sizeof "..." <= room)
            fits = n;
        if (n + (c == 0 ? 2 : c) + 1 > room) {
            memcpy(to + fits, "...", 3);
            n = fits + 3;
            break;
        }
        if (c == 0) { /* Latin-1 */
            to[n++] = (char)(0xC0 | s[i] >> 6);
            to[n++] = (char)(0x80 | (s[i] & 0x3F));
            i++;
        } else if (c == 1 && (s[i] < 0x20 || s[i] == 0x7F)) {
            to[n++] = s[i] == '\t' ? ' ' : '?';
            i++;
        } else {
            memcpy(to + n, s + i, c);
            n += c;
            i += c;
        }
    }
    to[n] = '\0';
    return to;
}

void report_add(struct report *r, enum note_kind kind, const char *format, ...)
{
    char text[2 * REPORT_NOTE_ROOM];
    va_list values;
    if (r->n == REPORT_NOTES) {
        r->lost++;
        return;
    }
    va_start(values, format);
    vsnprintf(text, sizeof text, format, values);
    va_end(values);
    r->note[r->n].kind = kind;
    report_clean(r->note[r->n++].text, REPORT_NOTE_ROOM, text, strlen(text));
}

const char *report_kind(enum note_kind kind)
{
    static const char *const names[] = {"read",    "unused",   "missing",
                                        "skipped", "spanning", "doubt"};
    return names[kind];
}

void report_print(const struct report *r, const char *name, FILE *out)
{
    for (int kind = 0; kind < NOTE_KINDS; kind++)
        for (size_t i = 0; i < r->n; i++)
            if ((int)r->note[i].kind == kind)
                fprintf(out, "delaunay: %s: %s\n", name, r->note[i].text);
    if (r->lost > 0)
        fprintf(out, "delaunay: %s: and %zu more notes\n", name, r->lost);
}
