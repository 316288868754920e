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

TEST(missing_parts_of_a_url_are_empty_or_the_default_port)
{
    check_url("delaunay://h", "", "h", URL_PORT, "");
    check_url("delaunay://h/", "", "h", URL_PORT, "");
    check_url("delaunay://h:1/t", "", "h", "1", "t");
    check_url("delaunay://:word@h:1234567/t", "word", "h", "1234567", "t");
    check_url("delaunay://user:word@h/t", "word", "h", URL_PORT, "t");
    check_url("delaunay://[::1]", "", "::1", URL_PORT, "");
    check_url("delaunay://[::1]:80/t", "", "::1", "80", "t");
}

TEST(url_of_a_private_server_is_a_word)
{
    struct url url;
    CHECK(url_read("private:", &url) && url_is_private(&url) && !url_is("private:"));
    CHECK(!url_read("private:x", &url));
    CHECK(url_read("delaunay://h", &url) && !url_is_private(&url));
}

TEST(url_of_a_unix_socket_has_a_path_and_no_set)
{
    check_url("unix:///run/delaunayd.sock", "", "/run/delaunayd.sock", "", "");
    check_url("unix://:word@/a@b/c:d", "word", "/a@b/c:d", "", "");
    check_url("unix://user:word@/s", "word", "/s", "", "");
}

TEST(malformed_url_is_refused)
{
    static const char *const bad[] = {"h:1/t",
                                      "delaunay:/h/t",
                                      "delaunay://",
                                      "delaunay://:1/t",
                                      "delaunay://h:/t",
                                      "delaunay://h:x/t",
                                      "delaunay://h:1x/t",
                                      "delaunay://h:12345678/t",
                                      "delaunay://[::1",
                                      "delaunay://[::1]x80/t",
                                      "delaunay://[::1]:/t",
                                      "delaunay://[]:1/t",
                                      "delaunay://u@h",
                                      "delaunay://h:1/a/b",
                                      "delaunay://h:1/a%20b",
                                      "delaunay://h:1:2/t",
                                      "unix://",
                                      "unix://h/path",
                                      "unix://word@/path",
                                      "unix:/path"};
    struct url url;
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
