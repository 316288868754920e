/* sock_test.c - sockets that listen, what their connections inherit, and refusals. */
#include "server/system/sock.h"
#include "tests/server/daemon.h"
#include "tests/test.h"

#include <arpa/inet.h>
#include <errno.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

/* Both ends of a connection, made through a listener of sock.h. */
struct pair {
    int client, server;
};

static struct pair connect_pair(void)
{
    struct pair p;
    struct daemon d = {0};
    struct sock_peer peer;
    int listener = sock_listen("127.0.0.1", &d.port);
    CHECK(listener >= 0);
    p.client = daemon_connect(&d);
    p.server = sock_accept(listener, &peer);
    CHECK(p.server >= 0 && peer.kind == SOCK_V4);
    close(listener);
    return p;
}

static int option(int fd, int level, int name)
{
    int value;
    socklen_t len = sizeof value;
    CHECK(getsockopt(fd, level, name, &value, &len) == 0);
    return value;
}

TEST(connections_notice_that_the_other_machine_has_failed)
{
    struct pair p = connect_pair();
    CHECK(option(p.server, SOL_SOCKET, SO_KEEPALIVE) == 1);
    int noticed =
        option(p.server, IPPROTO_TCP, TCP_KEEPIDLE) +
        option(p.server, IPPROTO_TCP, TCP_KEEPINTVL) * option(p.server, IPPROTO_TCP, TCP_KEEPCNT);
    CHECK_MSG(noticed >= 30 && noticed <= 300, "after %d s", noticed);
    CHECK(option(p.server, IPPROTO_TCP, TCP_NODELAY) == 1);
}

TEST(unix_socket_is_for_its_owner_and_group_whatever_the_umask)
{
    static const mode_t masks[] = {0, 022, 077, 0777};
    for (size_t i = 0; i < sizeof masks / sizeof masks[0]; i++) {
        char path[] = "/tmp/delaunayd-socket-XXXXXX";
        struct stat st;
        CHECK(mkdtemp(path) != NULL && rmdir(path) == 0);
        umask(masks[i]);
        int fd = sock_listen_unix(path);
        CHECK(fd >= 0 && stat(path, &st) == 0 && S_ISSOCK(st.st_mode));
        CHECK_MSG((st.st_mode & 07777) == 0660, "mode %o with umask %o", st.st_mode & 07777,
                  masks[i]);
        close(fd);
        unlink(path);
    }
}

TEST(path_of_a_unix_socket_has_at_most_107_bytes)
{
    char path[200] = "/tmp/delaunayd-XXXXXX";
    CHECK(mkdtemp(path) != NULL);
    size_t n = strlen(path);
    memset(path + n, 'x', 108 - n);
    path[n] = '/';
    path[108] = '\0';
    CHECK(sock_listen_unix(path) < 0 && errno == ENAMETOOLONG);
    path[107] = '\0';
    int fd = sock_listen_unix(path);
    CHECK(fd >= 0);
    close(fd);
    unlink(path);
    path[n] = '\0';
    rmdir(path);
}

TEST(only_a_socket_that_nobody_listens_on_is_replaced)
{
    char path[] = "/tmp/delaunayd-socket-XXXXXX";
    int file = mkstemp(path);
    CHECK(file >= 0 && sock_listen_unix(path) < 0); /* a regular file */
    struct stat st;
    CHECK(stat(path, &st) == 0 && S_ISREG(st.st_mode));
    close(file);
    unlink(path);
    int first = sock_listen_unix(path);
    CHECK(first >= 0 && sock_listen_unix(path) < 0 && errno == EADDRINUSE);
    close(first);
    int second = sock_listen_unix(path);
    CHECK(second >= 0);
    close(second);
    unlink(path);
}

TEST(refusal_reaches_a_client_that_has_sent_its_first_request)
{
    static const char line[] = "ERR BUSY not now\n";
    struct pair p = connect_pair();
    say(p.client, "PING\n");
    sock_refuse(p.server, line);
    expect(p.client, line);
    expect_end(p.client);
}

TEST(refusal_reads_little_of_a_flood)
{
    static char flood[1 << 20];
    int before, after;
    struct pair p = connect_pair();
    CHECK(send(p.client, flood, sizeof flood, MSG_DONTWAIT) > 0);
    int second = dup(p.server);
    CHECK(second >= 0 && ioctl(second, FIONREAD, &before) == 0 && before > 16384);
    sock_refuse(p.server, "ERR BUSY not now\n");
    CHECK(ioctl(second, FIONREAD, &after) == 0);
    CHECK_MSG(before - after <= 4096, "%d of %d bytes were read", before - after, before);
}
