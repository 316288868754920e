/* test.c - runs the registered tests, several at once, each in a forked process, and counts: passed, failed, skipped. The names of
 * those that failed come before the counts again. The output of tests that pass is shown only if words have selected them. */
#include "tests/test.h"

#include <fcntl.h>
#include <inttypes.h>
#include <signal.h>
#include <stdarg.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { SKIPPED = 77 }; /* the exit status of a test that ends by SKIP */

static struct test *first;
static const struct test *current; /* in the process of a test */
static uint64_t seed, state;

/* The longest begin first, as far as their time limits show; those with one limit in the order of the program. */
void test_register(struct test *t)
{
    struct test **at = &first;
    while (*at != NULL && (*at)->timeout_s >= t->timeout_s)
        at = &(*at)->next;
    t->next = *at;
    *at = t;
}

static _Thread_local const char *caller_file; /* of TEST_CALL; NULL: none */
static _Thread_local int caller_line;

void test_called(const char *file, int line)
{
    caller_file = file;
    caller_line = line;
}

void test_fail(const char *file, int line, const char *format, ...)
{
    va_list ap;
    test_fail_alloc(0);
    if (caller_file != NULL)
        fprintf(stderr, "%s:%d: from here\n", caller_file, caller_line);
    fprintf(stderr, "%s:%d: ", file, line);
    va_start(ap, format);
    vfprintf(stderr, format, ap);
    va_end(ap);
    fprintf(stderr, "\n");
    exit(1);
}

void test_skip(const char *format, ...)
{
    va_list ap;
    fprintf(stderr, "SKIP %s: ", current->name);
    va_start(ap, format);
    vfprintf(stderr, format, ap);
    va_end(ap);
    fprintf(stderr, "\n");
    exit(SKIPPED);
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

/* Whether the texts are equal except for versions of sets in `got` that `want` does not have. */
static bool equals(const char *got, const char *want)
{
    for (;;) {
        if (version_at(want) == 0)
            got += version_at(got);
        if (*got != *want)
            return false;
        if (*got == '\0')
            return true;
        got++;
        want++;
    }
}

void test_check_str(const char *file, int line, const char *what, const char *got, const char *want)
{
    if (!equals(got, want))
        test_fail(file, line, "%s\n--- got\n%s\n--- want\n%s\n---", what, got, want);
}

void test_check_unversioned(const char *file, int line, const char *what, const char *a,
                            const char *b)
{
    char *x = strdup(a), *y = strdup(b);
    if (x == NULL || y == NULL)
        abort();
    test_drop_versions(x);
    test_drop_versions(y);
    if (strcmp(x, y) != 0)
        test_fail(file, line, "%s\n--- one\n%s\n--- other\n%s\n---", what, a, b);
    free(x);
    free(y);
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

static bool matches(const struct test *t, const char *word)
{
    return strstr(t->name, word) != NULL || strstr(t->file, word) != NULL;
}

static bool selected(const struct test *t, char **words)
{
    bool found = *words == NULL;
    for (; *words != NULL && !found; words++)
        found = matches(t, *words);
    return found;
}

/* Names each word that selects no test; returns their number. */
static unsigned useless_words(char **words)
{
    unsigned useless = 0;
    for (; *words != NULL; words++) {
        const struct test *t = first;
        while (t != NULL && !matches(t, *words))
            t = t->next;
        if (t == NULL)
            printf("FAIL no test is called %s, nor its file\n", *words);
        useless += t == NULL;
    }
    return useless;
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
    struct test *test; /* NULL: none */
    pid_t pid;
    double start;
    FILE *output; /* what it prints, so that the lines of tests that run at once do not mix */
};

static unsigned jobs; /* tests at once */
static struct run running[64];
static unsigned passed, failed, skipped;
static bool any_words;

/* Many tests mostly wait: for a time-out, a disk, a process. */
static unsigned usual_jobs(void)
{
    long cpus = sysconf(_SC_NPROCESSORS_ONLN);
    return cpus < 1 ? 2 : cpus > 4 ? 8 : 2 * (unsigned)cpus;
}

/* Ends all tests, with the processes that they have started. */
static void stop(int signal_number)
{
    for (unsigned i = 0; i < jobs; i++)
        if (running[i].test != NULL && running[i].pid > 0)
            kill(-running[i].pid, SIGKILL);
    _exit(128 + signal_number);
}

static void on_stop(void (*handler)(int))
{
    signal(SIGINT, handler);
    signal(SIGTERM, handler);
}

static void start(struct run *r, struct test *t)
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
        on_stop(SIG_DFL);
        setpgid(0, 0);
        dup2(fileno(r->output), 1);
        dup2(fileno(r->output), 2);
        fclose(r->output);
        alarm(t->timeout_s * test_slowness());
        state = seed;
        current = t;
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
}

static void end(struct run *r, int status, const struct rusage *used)
{
    struct test *t = r->test;
    kill(-r->pid, SIGKILL);
    double wall = now() - r->start;
    int code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    if (any_words || code != 0)
        print_output(r);
    fclose(r->output);
    if (WIFSIGNALED(status))
        printf("%s: %s\n", t->file,
               WTERMSIG(status) == SIGALRM ? "timed out" : strsignal(WTERMSIG(status)));
    if (code != 0 && code != SKIPPED)
        printf("FAIL %s (seed %" PRIu64 ")\n", t->name, seed);
    else if (code == 0 && (isatty(1) || wall > 1))
        printf("ok   %s (%.2f s, %.2f s of processors)\n", t->name, wall,
               (double)(used->ru_utime.tv_sec + used->ru_stime.tv_sec) +
                   1e-6 * (double)(used->ru_utime.tv_usec + used->ru_stime.tv_usec));
    *(code == 0 ? &passed : code == SKIPPED ? &skipped : &failed) += 1;
    t->failed = code != 0 && code != SKIPPED;
    r->test = NULL;
}

/* Waits for the end of a test; returns the run that has become free. */
static struct run *wait_for_one(void)
{
    int status;
    struct rusage used;
    pid_t pid = wait4(-1, &status, 0, &used);
    for (unsigned i = 0; i < jobs; i++)
        if (running[i].test != NULL && running[i].pid == pid) {
            end(&running[i], status, &used);
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

static int list(char **words)
{
    for (const struct test *t = first; t != NULL; t = t->next)
        if (selected(t, words))
            printf("%s (%s)\n", t->name, t->file);
    return useless_words(words) != 0;
}

static void run_all(char **words)
{
    for (struct test *t = first; t != NULL; t = t->next)
        if (selected(t, words))
            start(free_run(), t);
    while (any_runs())
        wait_for_one();
}

int main(int argc, char **argv)
{
    int opt;
    bool lists = false, any = false;
    seed = (uint64_t)time(NULL);
    jobs = usual_jobs();
    while ((opt = getopt(argc, argv, "alj:s:")) != -1) {
        if (opt == 's')
            seed = strtoull(optarg, NULL, 10);
        else if (opt == 'j')
            jobs = (unsigned)strtoul(optarg, NULL, 10);
        else if (opt == 'a')
            any = true;
        else if (opt == 'l')
            lists = true;
        else
            return 2;
    }
    if (jobs < 1 || jobs > sizeof running / sizeof *running)
        return 2;
    char **words = argv + optind;
    setvbuf(stdout, NULL, _IOLBF, 0);
    if (lists)
        return list(words);
    any_words = *words != NULL;
    on_stop(stop);
    run_all(words);
    if (!any)
        failed += useless_words(words);
    for (const struct test *t = first; t != NULL; t = t->next)
        if (t->failed)
            printf("failed: %s (%s)\n", t->name, t->file);
    printf("%u passed, %u failed", passed, failed);
    if (skipped > 0)
        printf(", %u skipped", skipped);
    printf("\n");
    return failed != 0;
}
