/* wkt.c - see wkt.h. */
#include "clients/reading/wkt.h"

#include <string.h>

#include "proto/number.h"

static bool read_word(struct value *v, const char *word)
{
    *v = value_trim(v->text, v->text + v->len);
    size_t n = strlen(word);
    if (v->len < n || !value_is_word((struct value){v->text, n}, word))
        return false;
    *v = value_trim(v->text + n, v->text + v->len);
    return true;
}

struct value wkt_srid(struct value v)
{
    const char *semicolon = memchr(v.text, ';', v.len);
    if (semicolon == NULL || !read_word(&v, "SRID="))
        return (struct value){"", 0};
    return value_trim(v.text, semicolon);
}

bool wkt_read_point(struct value v, double xyz[3], int *values)
{
    const char *semicolon = memchr(v.text, ';', v.len);
    if (semicolon != NULL && read_word(&v, "SRID="))
        v = value_trim(semicolon + 1, v.text + v.len);
    if (!read_word(&v, "POINT"))
        return false;
    bool flat = !read_word(&v, "ZM") && !read_word(&v, "Z") && read_word(&v, "M");
    if (!read_word(&v, "(") || v.len == 0 || v.text[v.len - 1] != ')')
        return false;
    v.len--;
    int n = 0;
    while (v.len > 0) {
        double x;
        size_t len = 0;
        while (len < v.len && !value_is_blank(v.text[len]))
            len++;
        if (n == 4 || !proto_read_double(v.text, len, &x))
            return false;
        if (n < 3)
            xyz[n] = x;
        n++;
        v = value_trim(v.text + len, v.text + v.len);
    }
    *values = flat || n < 3 ? 2 : 3; /* the third value of POINT M is no height */
    return n >= 2;
}
