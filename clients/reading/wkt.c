/* wkt.c - see wkt.h. */
#include "clients/reading/wkt.h"

#include <string.h>

#include "proto/number.h"

bool wkt_take_word(struct value *v, const char *word)
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
    if (semicolon == NULL || !wkt_take_word(&v, "SRID="))
        return (struct value){"", 0};
    return value_trim(v.text, semicolon);
}

struct value wkt_without_srid(struct value v)
{
    const char *semicolon = memchr(v.text, ';', v.len);
    return value_trim(semicolon != NULL && wkt_take_word(&v, "SRID=") ? semicolon + 1 : v.text,
                      v.text + v.len);
}

bool wkt_take_kind(struct value *v, const char *kind, bool *flat)
{
    struct value rest = *v;
    if (!wkt_take_word(&rest, kind))
        return false;
    bool solid = wkt_take_word(&rest, "ZM") || wkt_take_word(&rest, "Z");
    *flat = !solid && wkt_take_word(&rest, "M");
    if (rest.len == 0 || (rest.text[0] != '(' && rest.text[0] != 'E' && rest.text[0] != 'e'))
        return false;
    *v = rest;
    return true;
}

const char *wkt_curved_kind(struct value v)
{
    static const char *const kinds[] = {"CIRCULARSTRING", "COMPOUNDCURVE", "CURVEPOLYGON",
                                        "MULTICURVE", "MULTISURFACE"};
    bool flat;
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++)
        if (wkt_take_kind(&v, kinds[i], &flat))
            return kinds[i];
    return NULL;
}

bool wkt_is_geometry(struct value v, bool *solid)
{
    static const char *const kinds[] = {
        "POINT",        "MULTIPOINT",         "LINESTRING",        "MULTILINESTRING", "POLYGON",
        "MULTIPOLYGON", "GEOMETRYCOLLECTION", "POLYHEDRALSURFACE", "TRIANGLE",        "TIN"};
    bool flat;
    v = wkt_without_srid(v);
    if (wkt_curved_kind(v) != NULL) {
        *solid = false;
        return true;
    }
    for (size_t i = 0; i < sizeof kinds / sizeof kinds[0]; i++) {
        if (!wkt_take_kind(&v, kinds[i], &flat))
            continue;
        size_t values = 0;
        double x;
        while (v.len > 0 && (v.text[0] == '(' || (v.text[0] >= 'A' && v.text[0] <= 'z')))
            v = value_trim(v.text + 1, v.text + v.len);
        for (size_t n; values < 4 && (n = proto_read_leading_double(v.text, v.len, &x)) > 0;
             values++)
            v = value_trim(v.text + n, v.text + v.len);
        *solid = values > 2 && !flat;
        return true;
    }
    return false;
}
