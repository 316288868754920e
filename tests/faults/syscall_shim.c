/* syscall_shim.c - counts the system calls by which a daemon talks to its clients, loaded into it with
 * LD_PRELOAD.
 *
 *     SYSCALLS_FILE    a file of at least eight bytes; an unsigned 64-bit count at its front grows
 * by one with every call, so that a test that has mapped the file sees it at once */
#include <dlfcn.h>
#include <fcntl.h>
#include <stdatomic.h>
#include <stdint.h>
#include <stdlib.h>
#include <sys/epoll.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/uio.h>
#include <unistd.h>

static _Atomic uint64_t *calls;

__attribute__((constructor)) static void map_file(void)
{
    const char *path = getenv("SYSCALLS_FILE");
    int fd = path == NULL ? -1 : open(path, O_RDWR | O_CLOEXEC);
    void *at =
        fd < 0 ? MAP_FAILED : mmap(NULL, sizeof *calls, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0);
    if (fd >= 0)
        close(fd);
    calls = at == MAP_FAILED ? NULL : at;
}

/* Counts, and finds the real function. */
static void *real(const char *name)
{
    if (calls != NULL)
        atomic_fetch_add(calls, 1);
    return dlsym(RTLD_NEXT, name);
}

ssize_t recv(int fd, void *to, size_t n, int flags)
{
    return ((ssize_t(*)(int, void *, size_t, int))real("recv"))(fd, to, n, flags);
}

ssize_t send(int fd, const void *from, size_t n, int flags)
{
    return ((ssize_t(*)(int, const void *, size_t, int))real("send"))(fd, from, n, flags);
}

ssize_t read(int fd, void *to, size_t n)
{
    return ((ssize_t(*)(int, void *, size_t))real("read"))(fd, to, n);
}

ssize_t write(int fd, const void *from, size_t n)
{
    return ((ssize_t(*)(int, const void *, size_t))real("write"))(fd, from, n);
}

ssize_t writev(int fd, const struct iovec *from, int n)
{
    return ((ssize_t(*)(int, const struct iovec *, int))real("writev"))(fd, from, n);
}

int epoll_wait(int epoll, struct epoll_event *event, int most, int timeout)
{
    return ((int (*)(int, struct epoll_event *, int, int))real("epoll_wait"))(epoll, event, most,
                                                                              timeout);
}

int epoll_ctl(int epoll, int what, int fd, struct epoll_event *event)
{
    return ((int (*)(int, int, int, struct epoll_event *))real("epoll_ctl"))(epoll, what, fd,
                                                                             event);
}
