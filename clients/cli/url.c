/* url.c - see url.h. */
#include "clients/cli/url.h"

#include <stdio.h>
#include <string.h>

static const char scheme[] = "delaunay://", private[] = "private:";

bool url_is(const char *text)
{
    return strncmp(text, scheme, sizeof scheme - 1) == 0;
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
        return copy(url->port, sizeof url->port, DELAUNAY_PORT, strlen(DELAUNAY_PORT));
    size_t digits = strspn(colon + 1, "0123456789");
    return *colon == ':' && digits > 0 && colon + 1 + digits == end &&
           copy(url->port, sizeof url->port, colon + 1, digits);
}

bool url_read(const char *text, struct url *url)
{
    *url = (struct url){.host = ""};
    if (strcmp(text, private) == 0)
        return copy(url->host, sizeof url->host, text, strlen(text));
    if (!url_is(text))
        return false;
    const char *at = text + sizeof scheme - 1;
    size_t len = strcspn(at, "/");
    const char *user_end = memchr(at, '@', len);
    if (user_end != NULL) {
        const char *colon = memchr(at, ':', (size_t)(user_end - at));
        if (colon == NULL ||
            !copy(url->token, sizeof url->token, colon + 1, (size_t)(user_end - colon) - 1))
            return false;
        len -= (size_t)(user_end + 1 - at);
        at = user_end + 1;
    }
    const char *set = at[len] == '/' ? at + len + 1 : at + len;
    return read_place(url, at, len) && copy(url->set, sizeof url->set, set, strlen(set)) &&
           (*set == '\0' || word_is_set_name(&(struct word){set, strlen(set)}));
}

struct delaunay_client *url_connect(const struct url *url, char *why, size_t room)
{
    char line[300];
    struct delaunay_client *c = delaunay_connect(url->host, url->port, why, room);
    if (c == NULL || url->token[0] == '\0')
        return c;
    snprintf(line, sizeof line, "AUTH %s", url->token);
    enum delaunay_result r = delaunay_request(c, line, NULL, NULL);
    if (r == DELAUNAY_OK)
        return c;
    snprintf(why, room, "%s",
             r == DELAUNAY_REFUSED ? delaunay_status(c)->text : delaunay_result_text(r));
    delaunay_close(c);
    return NULL;
}
