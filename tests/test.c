/* test.c - runs the registered tests, several at once, each in a forked process, and counts. */
#include "tests/test.h"

#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

static struct test *first, **last = &first;
static uint64_t seed, state;

void test_register(struct test *t)
{
    *last = t;
    last = &t->next;
}

void test_fail(const char *file, int line, const char *format, ...)
{
    va_list ap;
    test_fail_alloc(0);
    fprintf(stderr, "%s:%d: ", file, line);
    va_start(ap, format);
    vfprintf(stderr, format, ap);
    va_end(ap);
    fprintf(stderr, "\n");
    exit(1);
}

/* The length of a set's version at `text`; 0: there is none. HELLO has a version of another kind. */
static size_t version_at(const char *text)
{
    static const char *const mark[] = {" version=", ",\"version\":"};
    enum { LEAST_DIGITS = 10 };
    size_t n = 0;
    for (int i = 0; i < 2 && n == 0; i++)
        n = strncmp(text, mark[i], strlen(mark[i])) == 0 ? strlen(mark[i]) : 0;
    size_t digits = strspn(text + n, "0123456789");
    return n == 0 || digits < LEAST_DIGITS ? 0 : n + digits;
}

size_t test_drop_versions(char *text)
{
    char *to = text, *start = text;
    while (*text != '\0') {
        size_t n = version_at(text);
        text += n;
        if (n == 0)
            *to++ = *text++;
    }
    *to = '\0';
    return (size_t)(to - start);
}

void test_check_str(const char *file, int line, const char *what, const char *got, const char *want)
{
    if (strcmp(got, want) == 0)
        return;
    char *is = strdup(got), *should = strdup(want);
    if (is == NULL || should == NULL)
        abort();
    test_drop_versions(is);
    test_drop_versions(should);
    if (strcmp(is, should) != 0)
        test_fail(file, line, "%s\n--- got\n%s\n--- want\n%s\n---", what, got, want);
    free(is);
    free(should);
}

bool test_names_error(const char *text, const char *what, int error)
{
    char line[512];
    snprintf(line, sizeof line, "%s: %s", what, strerror(error));
    return strstr(text, line) != NULL;
}

uint64_t test_random(void) /* splitmix64 [Steele, Lea & Flood 2014] */
{
    uint64_t z = (state += 0x9E3779B97F4A7C15u);
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9u;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBu;
    return z ^ (z >> 31);
}

double test_uniform(void)
{
    return (double)(test_random() >> 11) * 0x1p-53;
}

uint32_t test_below(uint32_t n)
{
    return (uint32_t)(test_random() % n);
}

static bool selected(const struct test *t, int argc, char **argv)
{
    if (argc == 0)
        return true;
    for (int i = 0; i < argc; i++)
        if (strstr(t->name, argv[i]) != NULL || strstr(t->file, argv[i]) != NULL)
            return true;
    return false;
}

static double now(void)
{
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

unsigned test_slowness(void)
{
    const char *text = getenv("TEST_SLOWNESS");
    unsigned long factor = text == NULL ? 1 : strtoul(text, NULL, 10);
    return factor < 1 || factor > 1000 ? 1 : (unsigned)factor;
}

/* A test that runs, in a process group of its own, so that all processes that it started end with it. */
struct run {
    const struct test *test; /* NULL: none */
    pid_t pid;
    double start;
    FILE *output; /* what it prints, so that the lines of tests that run at once do not mix */
};

static unsigned jobs; /* tests at once */
static struct run running[64];
static unsigned passed, failed;

/* Many tests mostly wait: for a time-out, a disk, a process. */
static unsigned usual_jobs(void)
{
    long cpus = sysconf(_SC_NPROCESSORS_ONLN);
    return cpus < 1 ? 2 : cpus > 4 ? 8 : 2 * (unsigned)cpus;
}

static void start(struct run *r, const struct test *t)
{
    *r = (struct run){.test = t, .start = now(), .output = tmpfile()};
    r->pid = -1;
    if (r->output != NULL && fcntl(fileno(r->output), F_SETFD, FD_CLOEXEC) == 0)
        r->pid = fork();
    if (r->pid < 0) {
        perror(t->name);
        exit(2);
    }
    if (r->pid == 0) {
        setpgid(0, 0);
        dup2(fileno(r->output), 1);
        dup2(fileno(r->output), 2);
        fclose(r->output);
        alarm(t->timeout_s * test_slowness());
        state = seed;
        t->run();
        exit(0);
    }
}

static void print_output(struct run *r)
{
    char piece[4096];
    size_t n;
    rewind(r->output);
    while ((n = fread(piece, 1, sizeof piece, r->output)) > 0)
        fwrite(piece, 1, n, stdout);
    fclose(r->output);
}

static void end(struct run *r, int status)
{
    const struct test *t = r->test;
    kill(-r->pid, SIGKILL);
    print_output(r);
    bool ok = WIFEXITED(status) && WEXITSTATUS(status) == 0;
    if (!ok && WIFSIGNALED(status))
        printf("%s: %s\n", t->file,
               WTERMSIG(status) == SIGALRM ? "timed out" : strsignal(WTERMSIG(status)));
    if (!ok)
        printf("FAIL %s (seed %" PRIu64 ")\n", t->name, seed);
    else if (isatty(1) || now() - r->start > 1)
        printf("ok   %s (%.2f s)\n", t->name, now() - r->start);
    *(ok ? &passed : &failed) += 1;
    r->test = NULL;
}

/* Waits for the end of a test; the run that is free then. */
static struct run *wait_for_one(void)
{
    int status;
    pid_t pid = wait(&status);
    for (unsigned i = 0; i < jobs; i++)
        if (running[i].test != NULL && running[i].pid == pid) {
            end(&running[i], status);
            return &running[i];
        }
    perror("wait");
    exit(2);
}

static struct run *free_run(void)
{
    for (unsigned i = 0; i < jobs; i++)
        if (running[i].test == NULL)
            return &running[i];
    return wait_for_one();
}

static bool any_runs(void)
{
    for (unsigned i = 0; i < jobs; i++)
        if (running[i].test != NULL)
            return true;
    return false;
}

bool test_is_sanitized(void)
{
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    return true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
    return true;
#endif
#endif
    return false;
}

int main(int argc, char **argv)
{
    int opt;
    seed = (uint64_t)time(NULL);
    jobs = usual_jobs();
    while ((opt = getopt(argc, argv, "lj:s:")) != -1) {
        if (opt == 's') {
            seed = strtoull(optarg, NULL, 10);
        } else if (opt == 'j') {
            jobs = (unsigned)strtoul(optarg, NULL, 10);
        } else if (opt == 'l') {
            for (struct test *t = first; t != NULL; t = t->next)
                printf("%s (%s)\n", t->name, t->file);
            return 0;
        } else {
            return 2;
        }
    }
    if (jobs < 1 || jobs > sizeof running / sizeof *running)
        return 2;
    setvbuf(stdout, NULL, _IOLBF, 0);
    for (struct test *t = first; t != NULL; t = t->next)
        if (selected(t, argc - optind, argv + optind))
            start(free_run(), t);
    while (any_runs())
        wait_for_one();
    printf("%u passed, %u failed\n", passed, failed);
    return failed != 0;
}
