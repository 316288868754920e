/* url_test.c - URLs of daemons and sets, well formed and not. */
#include "clients/lib/url.h"

#include <string.h>

#include "tests/test.h"

static void check_url(const char *text, const char *token, const char *host, const char *port,
                      const char *set)
{
    struct url url;
    CHECK_MSG(url_is(text) && url_read(text, &url), "%s", text);
    CHECK_STR(url.token, token);
    CHECK_STR(url.host, host);
    CHECK_STR(url.port, port);
    CHECK_STR(url.set, set);
}

/* "-" stands for nothing. */
static const char *text_of(const char *word)
{
    return strcmp(word, "-") == 0 ? "" : word;
}

TEST(urls_are_read_as_in_all_clients)
{
    FILE *f = fopen("tests/data/urls.txt", "r");
    char line[200], text[100], host[100], port[20], token[100];
    int urls = 0;
    CHECK_MSG(f != NULL, "tests run in the root of the repository");
    while (fgets(line, sizeof line, f) != NULL) {
        struct url url;
        if (line[0] == '#')
            continue;
        int words = sscanf(line, "%99s %99s %19s %99s", text, host, port, token);
        urls++;
        if (words == 2) {
            CHECK_STR(host, "malformed");
            CHECK_MSG(!url_read(text, &url), "%s", text);
        } else if (strcmp(host, "private") == 0) {
            CHECK(url_read(text, &url) && url_is_private(&url) && !url_is(text));
        } else {
            CHECK(words == 4);
            check_url(text, text_of(token), host, text_of(port), "");
        }
    }
    CHECK(urls > 30);
    fclose(f);
}

TEST(url_may_name_a_set)
{
    static const char *const bad[] = {"h:1/t", "delaunay://:1/t", "delaunay://h:/t",
                                      "delaunay://h:1/a/b", "delaunay://h:1/a%20b"};
    struct url url;
    check_url("delaunay://h:1/t", "", "h", "1", "t");
    check_url("delaunay://user:word@h/t", "word", "h", URL_PORT, "t");
    check_url("delaunay://[::1]:80/t", "", "::1", "80", "t");
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        CHECK_MSG(!url_read(bad[i], &url), "%s", bad[i]);
}

TEST(url_with_a_part_that_is_too_long_is_refused)
{
    struct url url;
    char part[400], text[500];
    for (size_t len = 254; len <= 257; len++) { /* room for 255 and a NUL */
        memset(part, 'p', len);
        part[len] = '\0';
        snprintf(text, sizeof text, "delaunay://%s/t", part);
        CHECK(url_read(text, &url) == (len < sizeof url.host));
        snprintf(text, sizeof text, "delaunay://:%s@h/t", part);
        CHECK(url_read(text, &url) == (len < sizeof url.token));
    }
    memset(part, 's', SET_NAME_LIMIT + 1);
    part[SET_NAME_LIMIT + 1] = '\0';
    snprintf(text, sizeof text, "delaunay://h/%s", part);
    CHECK(!url_read(text, &url));
    text[strlen(text) - 1] = '\0';
    CHECK(url_read(text, &url) && strlen(url.set) == SET_NAME_LIMIT);
}
