/* glob.c - see glob.h. Without recursion: the text after the last `*` is tried at each place, one after the other. Earlier
 * stars need not be tried again. */
#include "server/ops/glob.h"

/* With GLOB_CASELESS capitals are letters like others. */
static unsigned char fold(char c, enum glob_case how)
{
    return (unsigned char)(how == GLOB_CASELESS && c >= 'A' && c <= 'Z' ? c - 'A' + 'a' : c);
}

/* Whether c is in the class pattern[m], which begins after its `[`; *used is its length with its `]`. */
static bool class_has(const char *pattern, size_t m, char c, enum glob_case how, size_t *used)
{
    bool none = m > 0 && pattern[0] == '^', found = false;
    size_t at = none;
    for (; at < m && pattern[at] != ']'; at++) {
        if (pattern[at] == '\\' && at + 1 < m)
            at++;
        unsigned char from = fold(pattern[at], how), to = from, it = fold(c, how);
        if (at + 2 < m && pattern[at + 1] == '-') {
            to = fold(pattern[at + 2], how);
            at += 2;
        }
        found |= from <= to ? from <= it && it <= to : to <= it && it <= from;
    }
    *used = at < m ? at + 1 : m;
    return found != none;
}

/* Whether c matches the first item of pattern[m], which is not `*`; *used is the length of the item. */
static bool item_matches(const char *pattern, size_t m, char c, enum glob_case how, size_t *used)
{
    *used = 1;
    if (pattern[0] == '?')
        return true;
    if (pattern[0] == '[') {
        bool has = class_has(pattern + 1, m - 1, c, how, used);
        ++*used;
        return has;
    }
    *used = pattern[0] == '\\' && m > 1 ? 2 : 1;
    return fold(pattern[*used - 1], how) == fold(c, how);
}

bool glob_matches(const char *pattern, size_t m, const char *name, size_t n, enum glob_case how)
{
    size_t p = 0, at = 0, star = 0, from = 0,
           used; /* star: after the last `*`; 0: there was none */
    while (at < n) {
        if (p < m && pattern[p] == '*') {
            star = ++p;
            from = at;
        } else if (p < m && item_matches(pattern + p, m - p, name[at], how, &used)) {
            p += used;
            at++;
        } else if (star > 0) {
            p = star;
            at = ++from;
        } else {
            return false;
        }
    }
    while (p < m && pattern[p] == '*')
        p++;
    return p == m;
}
