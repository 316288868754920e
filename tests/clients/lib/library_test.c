/* library_test.c - the installed library: one header, static and shared, pkg-config; the examples
 * compile against it without warnings and work. */
#include <string.h>
#include <unistd.h>

#include "clients/lib/delaunay_client.h"
#include "tests/clients/peer.h"
#include "tests/daemon.h"
#include "tests/test.h"

static void run(const char *command)
{
    int status;
    const char *out = peer_shell(&status, "%s 2>&1", command);
    CHECK_MSG(status == 0, "%s\n%s", command, out);
}

TEST_TIMEOUT(library_is_installed_and_its_examples_work, 120)
{
    static const char *const example[] = {"nearest", "bulk"};
    char root[64], command[1000];
    int status;
    struct daemon d = daemon_start(NULL);
    snprintf(root, sizeof root, "/tmp/delaunay_library_XXXXXX");
    CHECK(mkdtemp(root) != NULL);
    snprintf(command, sizeof command, "MAKEFLAGS= V= make -s install PREFIX=/usr DESTDIR=%s", root);
    run(command);
    snprintf(command, sizeof command,
             "grep -qx 'Libs: -L${libdir} -ldelaunay' %s/usr/lib/pkgconfig/delaunay.pc && "
             "! grep -q '#include \"' %s/usr/include/delaunay_client.h",
             root, root);
    run(command);
    for (int i = 0; i < 4; i++) {
        const char *library = i < 2 ? "-ldelaunay -Wl,-rpath" : "-l:libdelaunay.a -Wl,-rpath";
        snprintf(command, sizeof command,
                 "${CC:-cc} -std=c11 -Wall -Wextra -Werror -I%s/usr/include clients/examples/%s.c "
                 "-L%s/usr/lib %s,%s/usr/lib -lm -o %s/a.out",
                 root, example[i % 2], root, library, root, root);
        run(command);
        const char *out =
            peer_shell(&status, "%s/a.out 127.0.0.1 %s 100000 2>&1", root, d.port_text);
        CHECK_MSG(status == 0, "%s", out);
        const char *want =
            i % 2 == 0 ? "\n1 4 0 1.4142135623730951\n" : " triangles, the first of them ";
        CHECK_MSG(strstr(out, want) != NULL, "%s", out);
        CHECK(peer_shell(&status, "%s/a.out 127.0.0.1 1 2>&1", root)[0] != 0 && status == 1);
    }
    snprintf(command, sizeof command, "rm -rf %s", root);
    run(command);
    daemon_end(&d);
}

TEST(library_takes_binary_replies_whole_and_pipelined)
{
    char why[256];
    void *bytes;
    size_t n;
    double xy[] = {0, 0, 1, 0, 0, 1};
    struct daemon d = daemon_start(NULL);
    struct delaunay_client *c = delaunay_connect("127.0.0.1", d.port_text, why, sizeof why);
    CHECK(c != NULL && delaunay_send_points(c, "t", xy, 3, NULL, NULL) == DELAUNAY_OK);
    CHECK(delaunay_send(c, "EDGES t BINARY", 14) == DELAUNAY_OK);
    CHECK(delaunay_send(c, "TRIANGULATE t", 13) == DELAUNAY_OK);
    CHECK(delaunay_send(c, "TRIANGLES t BINARY", 18) == DELAUNAY_OK);
    CHECK(delaunay_send(c, "PING", 4) == DELAUNAY_OK);
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_OK);
    CHECK(delaunay_receive_bytes(c, &bytes, &n) == DELAUNAY_REFUSED && bytes == NULL && n == 0);
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_OK);
    CHECK(delaunay_receive_bytes(c, &bytes, &n) == DELAUNAY_OK && n == 12);
    CHECK(memcmp(bytes, "\0\0\0\0\1\0\0\0\2\0\0\0", 12) == 0);
    free(bytes);
    CHECK(delaunay_receive(c, NULL, NULL) == DELAUNAY_OK);
    delaunay_close(c);
    daemon_end(&d);
}
