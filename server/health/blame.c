#include "health/blame.h"

#include <dlfcn.h>
#include <execinfo.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

#include "health/modules.h"
#include "process/sanitized.h"

static struct orl_past *page; /* shared with the file; NULL: there is none */
static bool lines_are_json;
static _Thread_local const char *whose;
/* A stack that has overflowed is none to handle the signal on. */
static _Thread_local char other_stack[16 << 10];

/* ---- Signals --------------------------------------------------------------------------------- */

enum { MOST_FRAMES = 24 };

/* Nothing but what may be called while a signal is handled. */
static void write_line(const char *const *parts, size_t n)
{
    char line[1024];
    size_t used = 0;
    for (size_t i = 0; i < n; i++)
        for (const char *c = parts[i]; *c && used < sizeof line; c++)
            line[used++] = *c;
    if (write(STDERR_FILENO, line, used) < 0)
        return;
}

static void say(const char *event, int signum, const char *job)
{
    char number[3] = {(char)('0' + signum / 10), (char)('0' + signum % 10), '\0'};
    const char *pairs[] = {"level=error event=", event, " signal=", number, " job=", job, "\n"};
    const char *object[] = {"{\"level\":\"error\",\"event\":\"",
                            event,
                            "\",\"signal\":",
                            signum < 10 ? number + 1 : number,
                            ",\"job\":\"",
                            job,
                            "\"}\n"};
    const char *const *parts = lines_are_json ? object : pairs;
    write_line(parts, 7);
}

static size_t add_text(char *to, size_t used, size_t room, const char *text)
{
    while (*text && used + 1 < room)
        to[used++] = *text++;
    to[used] = '\0';
    return used;
}

/* Where it was: the calls, from the innermost out, each as its module and the offset in there. A
 * second line, for the stack may be what is broken. */
static void say_where(void)
{
    void *frames[MOST_FRAMES];
    char text[768] = "";
    size_t used = 0;
    const int n = backtrace(frames, MOST_FRAMES);
    for (int i = 0; i < n; i++) {
        uintptr_t offset = 0;
        char digits[2 * sizeof offset + 1] = "";
        const char *const module = orl_module_of((uintptr_t)frames[i], &offset);
        for (size_t k = sizeof digits - 1; k-- > 0; offset >>= 4)
            digits[k] = "0123456789abcdef"[offset & 15];
        const char *const shown = digits + strspn(digits, "0");
        used = add_text(text, used, sizeof text, used > 0 ? "," : "");
        used = add_text(text, used, sizeof text, module ? module : "?");
        used = add_text(text, used, sizeof text, "+0x");
        used = add_text(text, used, sizeof text, shown);
    }
    const char *pairs[] = {"level=error event=crashed-at frames=", text, "\n"};
    const char *object[] = {"{\"level\":\"error\",\"event\":\"crashed-at\",\"frames\":\"", text,
                            "\"}\n"};
    write_line(lines_are_json ? object : pairs, 3);
}

static void on_fault(int signum, siginfo_t *info, void *context)
{
    (void)context;
    /* Sent by a process, it says nothing of the thread that it came to. */
    const bool own = info->si_code > 0 || signum == SIGABRT;
    const char *job = own && whose ? whose : "";
    if (page && page->signum == 0) {
        for (size_t i = 0; i < sizeof page->job; i++) {
            page->job[i] = job[i];
            if (!job[i])
                break;
        }
        page->signum = signum;
    }
    say("crashed", signum, job[0] ? job : "-");
    say_where();
    raise(signum); /* as it would have been: the handler is gone */
}

static void on_terminate(void)
{
    say("out-of-memory-in-a-library", SIGABRT, whose ? whose : "-");
    abort();
}

void orl_heed_terminate(void (*handler)(void))
{
    void (*(*set)(void (*)(void)))(void);
    void *symbol = dlsym(RTLD_DEFAULT, "_ZSt13set_terminatePFvvE");
    memcpy(&set, &symbol, sizeof set);
    if (symbol)
        set(handler);
}

/* Sanitizers have handlers of their own, which say more. */
static void catch_faults(void)
{
    static const int signals[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
    struct sigaction action = {.sa_flags =
                                   (int)(SA_SIGINFO | SA_ONSTACK | SA_RESETHAND | SA_NODEFER)};
    void *frame;
    action.sa_sigaction = on_fault;
    backtrace(&frame, 1); /* loads what it takes now, and not in a handler */
    orl_modules_list();
    for (size_t i = 0; i < sizeof signals / sizeof *signals && !ORL_SANITIZED; i++)
        sigaction(signals[i], &action, NULL);
    orl_heed_terminate(on_terminate);
}

/* ---- The page -------------------------------------------------------------------------------- */

void orl_blame_open(const char *root, bool log_json, struct orl_past *ret_past)
{
    char path[ORL_PATH_MAX];
    memset(ret_past, 0, sizeof *ret_past);
    lines_are_json = log_json;
    snprintf(path, sizeof path, "%s/oriel.running", root);
    const int fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    /* Room is made now: on a full disk a store to the page would end the process. */
    void *data = fd >= 0 && posix_fallocate(fd, 0, sizeof *page) == 0
                     ? mmap(NULL, sizeof *page, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0)
                     : MAP_FAILED;
    if (fd >= 0)
        close(fd);
    catch_faults();
    if (data == MAP_FAILED)
        return;
    page = data;
    *ret_past = *page;
    ret_past->job[sizeof ret_past->job - 1] = '\0';
    memset(page, 0, sizeof *page);
}

void orl_blame_close(void)
{
    if (page)
        munmap(page, sizeof *page);
    page = NULL;
}

void orl_blame_note(const struct orl_memory *memory, uint32_t checks)
{
    if (!page)
        return;
    page->resident = orl_memory_resident();
    page->capacity = memory->capacity;
    page->checks = checks;
}

void orl_blame_begin(const char *job)
{
    const stack_t stack = {.ss_sp = other_stack, .ss_size = sizeof other_stack};
    if (!ORL_SANITIZED)
        sigaltstack(&stack, NULL);
    whose = job;
}

void orl_blame_end(void)
{
    whose = NULL;
}

/*
 * Where a signal names a job it is that one. Where nobody said, one of several may be anyone, and
 * each runs alone from then on; one that ran alone has to take it, unless the kernel had others to
 * choose from, checks, and the daemon had not grown.
 */
bool orl_blame_is(const struct orl_past *past, bool is_named, bool alone)
{
    if (past->signum != 0 && past->job[0])
        return is_named;
    return alone && (past->checks == 0 || past->resident > past->capacity / 2);
}
