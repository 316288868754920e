/* crs.c - see crs.h. */
#include "clients/meshes/crs.h"

#include <ctype.h>
#include <string.h>
#include <strings.h>

#include "proto/text.h"

/* Copies s[len], letters and digits, in upper case. */
static bool take_part(char *to, const char *s, size_t len)
{
    if (len == 0 || len > CRS_PART)
        return false;
    for (size_t i = 0; i < len; i++) {
        if (!text_is_digit(s[i]) && !((s[i] | 32) >= 'a' && (s[i] | 32) <= 'z'))
            return false;
        to[i] = (char)toupper((unsigned char)s[i]);
    }
    to[len] = '\0';
    return true;
}

/* `AUTHORITY:CODE`, and in a URN `AUTHORITY:VERSION:CODE`. */
static bool take_name(const char *text, bool urn, struct crs *crs)
{
    const char *colon = strchr(text, ':');
    if (colon == NULL)
        return false;
    const char *code = urn ? strchr(colon + 1, ':') : colon;
    return code != NULL && take_part(crs->authority, text, (size_t)(colon - text)) &&
           take_part(crs->code, code + 1, strlen(code + 1));
}

bool crs_read(const char *text, struct crs *crs)
{
    static const char prefix[] = "urn:ogc:def:crs:";
    struct crs read = {.code = ""};
    bool urn = strncasecmp(text, prefix, sizeof prefix - 1) == 0;
    bool ok = strcasecmp(text, "CRS84") == 0
                  ? take_name("OGC:CRS84", false, &read)
                  : take_name(text + (urn ? sizeof prefix - 1 : 0), urn, &read);
    if (ok)
        *crs = read;
    return ok;
}

void crs_begin_geojson(FILE *out, const struct crs *crs)
{
    fputs("{\"type\":\"FeatureCollection\",", out);
    if (crs_is_given(crs)) /* the URNs of OGC's own systems have a version */
        fprintf(
            out,
            "\"crs\":{\"type\":\"name\",\"properties\":{\"name\":\"urn:ogc:def:crs:%s:%s:%s\"}},",
            crs->authority, strcmp(crs->authority, "OGC") == 0 ? "1.3" : "", crs->code);
    fputs("\"features\":[\n", out);
}
