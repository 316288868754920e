/* url.c - see url.h. */
#include "clients/lib/url.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

static const char scheme[] = "delaunay://", unix_scheme[] = "unix://", private[] = "private:";

bool url_is(const char *text)
{
    return strncmp(text, scheme, sizeof scheme - 1) == 0 ||
           strncmp(text, unix_scheme, sizeof unix_scheme - 1) == 0;
}

bool url_is_private(const struct url *url)
{
    return strcmp(url->host, private) == 0;
}

static bool copy(char *to, size_t room, const char *from, size_t len)
{
    if (len >= room)
        return false;
    memcpy(to, from, len);
    to[len] = '\0';
    return true;
}

/* `host`, `host:port`, `[v6]:port` */
static bool read_place(struct url *url, const char *at, size_t len)
{
    const char *end = at + len, *host = at, *colon;
    size_t host_len;
    if (len > 0 && *at == '[') {
        const char *close = memchr(at, ']', len);
        if (close == NULL)
            return false;
        host = at + 1;
        host_len = (size_t)(close - host);
        colon = close + 1 < end ? close + 1 : NULL;
    } else {
        colon = memchr(at, ':', len);
        host_len = colon != NULL ? (size_t)(colon - at) : len;
    }
    if (host_len == 0 || !copy(url->host, sizeof url->host, host, host_len))
        return false;
    if (colon == NULL)
        return copy(url->port, sizeof url->port, URL_PORT, strlen(URL_PORT));
    size_t digits = strspn(colon + 1, "0123456789");
    return *colon == ':' && digits > 0 && colon + 1 + digits == end &&
           strtol(colon + 1, NULL, 10) <= URL_MOST_PORT &&
           copy(url->port, sizeof url->port, colon + 1, digits);
}

/* Replaces each %xx, two hexadecimal digits, by its byte. */
static void decode(char *text)
{
    char *to = text, digits[3] = "";
    for (const char *at = text; *at != '\0'; at++) {
        bool coded =
            at[0] == '%' && isxdigit((unsigned char)at[1]) && isxdigit((unsigned char)at[2]);
        *to++ = coded ? (char)strtoul(memcpy(digits, at + 1, 2), NULL, 16) : *at;
        at += coded ? 2 : 0;
    }
    *to = '\0';
}

/* Reads `[user]:token@`, if the text begins so within its first `len` characters. NULL if it is malformed, otherwise what follows. */
static const char *read_token(struct url *url, const char *at, size_t len)
{
    const char *end = memchr(at, '@', len);
    if (end == NULL)
        return at;
    const char *colon = memchr(at, ':', (size_t)(end - at));
    if (colon == NULL || !copy(url->token, sizeof url->token, colon + 1, (size_t)(end - colon) - 1))
        return NULL;
    decode(url->token);
    return end + 1;
}

/* A path may contain any character, so a URL of a Unix socket names no set. */
static bool read_unix(struct url *url, const char *text)
{
    const char *path = read_token(url, text, strcspn(text, "/"));
    return path != NULL && *path == '/' && copy(url->host, sizeof url->host, path, strlen(path));
}

bool url_read(const char *text, struct url *url)
{
    *url = (struct url){.host = ""};
    if (strcmp(text, private) == 0)
        return copy(url->host, sizeof url->host, text, strlen(text));
    if (!url_is(text))
        return false;
    if (strncmp(text, unix_scheme, sizeof unix_scheme - 1) == 0)
        return read_unix(url, text + sizeof unix_scheme - 1);
    const char *at = text + sizeof scheme - 1, *end = at + strcspn(at, "/");
    at = read_token(url, at, (size_t)(end - at));
    if (at == NULL || !read_place(url, at, (size_t)(end - at)))
        return false;
    const char *set = *end == '/' ? end + 1 : end;
    return copy(url->set, sizeof url->set, set, strlen(set)) &&
           (*set == '\0' || word_is_set_name(&(struct word){set, strlen(set)}));
}
