/* library_test.c - the installed libraries: one header each, static and shared, pkg-config; the examples
 * compile with them without warnings and work; C++ can use them; `make uninstall` leaves nothing. */
#include <fcntl.h>
#include <string.h>
#include <sys/file.h>
#include <unistd.h>

#include "clients/lib/delaunay_client.h"
#include "tests/clients/peer.h"
#include "tests/daemon.h"
#include "tests/test.h"

static char root[64]; /* the folder of the installation */

/* The output of a shell command in which $R is the folder of the installation. */
static const char *run(const char *command)
{
    int status;
    const char *out = peer_shell(&status, "R=%s/usr; { %s\n} 2>&1", root, command);
    CHECK_MSG(status == 0, "%s\n%s", command, out);
    return out;
}

/* Builds the libraries first, in the folder that all tests share, so one test after the other. */
static void install(void)
{
    if (test_is_sanitized())
        SKIP("a sanitizer is not in the libraries, which are built without one");
    int lock = open("Makefile", O_RDONLY | O_CLOEXEC);
    CHECK(lock >= 0 && flock(lock, LOCK_EX) == 0);
    snprintf(root, sizeof root, "/tmp/delaunay_library_XXXXXX");
    CHECK(mkdtemp(root) != NULL);
    run("MAKEFLAGS= V= make -s install PREFIX=/usr DESTDIR=${R%/usr}");
    close(lock);
}

static void uninstall(void)
{
    run("MAKEFLAGS= V= make -s uninstall PREFIX=/usr DESTDIR=${R%/usr}");
    CHECK_STR(run("find $R ! -type d"), "");
    run("rm -rf ${R%/usr}");
}

/* Compiles an example against the installed library and runs it. */
static const char *run_example(const char *name, const char *library, const char *arguments)
{
    char command[500];
    snprintf(command, sizeof command,
             "${CC:-cc} -std=c11 -Wall -Wextra -Werror -I$R/include clients/examples/%s.c -L$R/lib "
             "%s -Wl,-rpath,$R/lib -lm -o $R/a.out && $R/a.out %s; s=$?; rm -f $R/a.out; exit $s",
             name, library, arguments);
    return run(command);
}

static void check_examples(const struct daemon *d, const char *client, const char *core)
{
    char address[64];
    snprintf(address, sizeof address, "127.0.0.1 %s 100000", d->port_text);
    CHECK(strstr(run_example("nearest", client, address), "\n1 4 0 1.4142135623730951\n") != NULL);
    CHECK(strstr(run_example("bulk", client, address), " triangles, the first of them ") != NULL);
    CHECK_STR(run_example("in_process", core, ""),
              "5 points, 4 triangles; near 3 1: 1 4\n0 1 4\n0 4 3\n1 2 4\n2 3 4\n");
}

TEST_TIMEOUT(library_is_installed_and_its_examples_work, 240)
{
    install();
    struct daemon d = daemon_start(NULL);
    check_examples(&d, "-ldelaunay", "-ldelaunay-core");
    check_examples(&d, "-l:libdelaunay.a", "-l:libdelaunay-core.a");
    run("! grep -h '#include \"' $R/include/*.h");
    run("cmp proto/PROTOCOL.md $R/share/doc/delaunayd/PROTOCOL.md");
    run("for l in delaunay delaunay-core; do grep -qx \"Libs: -L.{libdir} -l$l\" "
        "$R/lib/pkgconfig/$l.pc || exit 1; done");
    run("! command -v pkg-config || PKG_CONFIG_PATH=$R/lib/pkgconfig pkg-config --exists "
        "--print-errors delaunay delaunay-core");
    uninstall();
    daemon_end(&d);
}

/* A program that has a function of the same name as one of ours must still link. */
TEST_TIMEOUT(library_has_no_name_without_its_prefix, 240)
{
    install();
    for (int i = 0; i < 2; i++) {
        char command[300];
        snprintf(command, sizeof command,
                 "nm -g --defined-only $R/lib/libdelaunay%s.a | sed -n 's/.* [A-Z] //p' | grep -v "
                 "'^%s_' || true",
                 i == 0 ? "" : "-core", i == 0 ? "delaunay" : "dt");
        CHECK_STR(run(command), "");
    }
    CHECK_STR(run("nm -D --defined-only $R/lib/*.so.0 | sed -n 's/.* [TDBR] //p' | "
                  "grep -vE '^(delaunay|dt)_' || true"),
              "");
    CHECK_STR(run("grep -hE '^#define|^(struct|enum|typedef)|^    [A-Z_]+,' $R/include/*.h | "
                  "grep -viE '(delaunay|dt)(_|;)' || true"),
              "");
    uninstall();
}

TEST_TIMEOUT(library_can_be_used_from_cpp, 240)
{
    int status;
    peer_shell(&status, "command -v ${CXX:-c++}");
    if (status != 0)
        return;
    install();
    run("cat >$R/x.cpp <<'END'\n"
        "#include <delaunay_client.h>\n"
        "#include <delaunay_core.h>\n"
        "#include <cstdio>\n"
        "int main() {\n"
        "    char why[100];\n"
        "    dt_point p[3] = {{0, 0}, {1, 0}, {0, 1}};\n"
        "    dt_added added;\n"
        "    dt_atomic_bool cancel{false};\n"
        "    dt_options options{};\n"
        "    options.cancel = &cancel;\n"
        "    dt *t = dt_new(0);\n"
        "    struct dt_summary s{};\n"
        "    if (dt_add(t, p, 3, &added) == DT_OK && dt_triangulate(t, &options) == DT_OK)\n"
        "        dt_summary(t, &s);\n"
        "    if (DELAUNAY_VERSION_NUMBER < 100 || *DELAUNAY_VERSION == 0 || "
        "*dt_status_text(DT_RANGE) == 0)\n"
        "        return 1;\n"
        "    dt_free(t);\n"
        "    delaunay_client *c = delaunay_connect(\"/nowhere/socket\", \"\", why, sizeof why);\n"
        "    delaunay_close(c);\n"
        "    std::printf(\"%u %s\\n\", s.triangles, c == nullptr ? \"no server\" : why);\n"
        "}\n"
        "END");
    for (int i = 0; i < 2; i++) {
        char command[400];
        snprintf(command, sizeof command,
                 "${CXX:-c++} -std=c++17 -Wall -Wextra -Werror -I$R/include $R/x.cpp -L$R/lib %s "
                 "-Wl,-rpath,$R/lib -o $R/x && $R/x",
                 i == 0 ? "-ldelaunay -ldelaunay-core"
                        : "-l:libdelaunay.a -l:libdelaunay-core.a -lm");
        CHECK_STR(run(command), "1 no server\n");
    }
    run("rm $R/x $R/x.cpp");
    uninstall();
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
