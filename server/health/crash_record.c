#include "health/crash.h"

#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include <oriel/base/files.h>
#include <sys/mman.h>

#include "process/limits.h"
#include "process/signals.h"

/* ---- Facts from the kernel ------------------------------------------------------------------- */

/* Writes the id of this boot; "" if the kernel does not report it. */
static void read_boot_id(char ret_id[ORL_BOOT_ID])
{
    ret_id[0] = '\0';
    FILE *file = orl_fopen_regular("/proc/sys/kernel/random/boot_id", 'r');
    if (file && fgets(ret_id, ORL_BOOT_ID, file))
        ret_id[strcspn(ret_id, "\n")] = '\0';
    if (file)
        fclose(file);
}

/* Returns the number of processes that the kernel has killed for memory since the boot, including
 * those killed by limits of control groups. UINT64_MAX if the kernel does not report it. */
static uint64_t count_oom_kills(void)
{
    static const char name[] = "oom_kill ";
    uint64_t kills = UINT64_MAX;
    char line[128];
    FILE *file = orl_fopen_regular("/proc/vmstat", 'r');
    while (file && kills == UINT64_MAX && fgets(line, sizeof line, file))
        if (strncmp(line, name, sizeof name - 1) == 0)
            kills = strtoull(line + sizeof name - 1, NULL, 10);
    if (file)
        fclose(file);
    return kills;
}

static struct orl_previous_exit *page; /* mapped from the file and shared with it; NULL: none */
static _Thread_local const char *current_job;

/* ---- Signals --------------------------------------------------------------------------------- */

static void on_fault(int signum, siginfo_t *info, void *context)
{
    /* A signal that another process sent says nothing about the thread that received it. */
    const bool own = info->si_code > 0 || signum == SIGABRT;
    const char *job = own && current_job ? current_job : "";
    if (page && page->signum == 0) {
        for (size_t i = 0; i < sizeof page->job; i++) {
            page->job[i] = job[i];
            if (!job[i])
                break;
        }
        page->signum = signum;
    }
    orl_crash_report_write(
        &(struct orl_crash){.signum = signum, .job = job, .info = info, .context = context});
    raise(signum); /* takes the default action, since the handler was reset */
}

static void on_terminate(void)
{
    orl_crash_report_line("out-of-memory-in-a-library", SIGABRT, current_job ? current_job : "");
    abort();
}

void orl_set_terminate_handler(void (*handler)(void))
{
    void (*(*set)(void (*)(void)))(void);
    void *symbol = dlsym(RTLD_DEFAULT, "_ZSt13set_terminatePFvvE");
    memcpy(&set, &symbol, sizeof set);
    if (symbol)
        set(handler);
}

/* Installs the handlers. Sanitizers have handlers of their own, which report more. */
static void catch_faults(void)
{
    static const int signals[] = {SIGSEGV, SIGBUS, SIGILL, SIGFPE, SIGABRT};
    struct sigaction action = {.sa_flags =
                                   (int)(SA_SIGINFO | SA_ONSTACK | SA_RESETHAND | SA_NODEFER)};
    action.sa_sigaction = on_fault;
    for (size_t i = 0; i < sizeof signals / sizeof *signals && !ORL_SANITIZED; i++)
        sigaction(signals[i], &action, NULL);
    orl_set_terminate_handler(on_terminate);
}

/* ---- The page -------------------------------------------------------------------------------- */

void orl_crash_record_open(const char *root, bool log_json, struct orl_previous_exit *ret_exit)
{
    char path[ORL_PATH_MAX];
    memset(ret_exit, 0, sizeof *ret_exit);
    orl_crash_report_open(log_json);
    orl_signal_stack_install();
    snprintf(path, sizeof path, "%s/oriel.running", root);
    const int fd = orl_open_regular(path, O_RDWR | O_CREAT);
    /* Allocates disk space now: on a full disk, a later store to the page would end the process. */
    void *data = fd >= 0 && posix_fallocate(fd, 0, sizeof *page) == 0
                     ? mmap(NULL, sizeof *page, PROT_READ | PROT_WRITE, MAP_SHARED, fd, 0)
                     : MAP_FAILED;
    if (fd >= 0)
        close(fd);
    catch_faults();
    if (data == MAP_FAILED)
        return;
    page = data;
    *ret_exit = *page;
    ret_exit->job[sizeof ret_exit->job - 1] = '\0';
    ret_exit->boot[sizeof ret_exit->boot - 1] = '\0';
    memset(page, 0, sizeof *page);
    read_boot_id(page->boot);
    page->oom_kills = count_oom_kills();
    const bool known = ret_exit->boot[0] && page->boot[0];
    ret_exit->rebooted = known && strcmp(ret_exit->boot, page->boot) != 0;
    ret_exit->not_oom = known && !ret_exit->rebooted && page->oom_kills != UINT64_MAX &&
                        page->oom_kills == ret_exit->oom_kills;
}

void orl_crash_record_close(void)
{
    if (page)
        munmap(page, sizeof *page);
    page = NULL;
}

void orl_crash_record_update(const struct orl_memory *memory, uint32_t checks)
{
    if (!page)
        return;
    page->resident = orl_memory_resident();
    page->capacity = memory->capacity;
    page->checks = checks;
    page->oom_kills = count_oom_kills();
}

void orl_crash_record_begin_job(const char *job)
{
    orl_signal_stack_install();
    current_job = job;
}

void orl_crash_record_end_job(void)
{
    current_job = NULL;
}

void orl_crash_record_mark_stopped(void)
{
    if (page && page->signum == 0)
        page->signum = ORL_EXIT_STOPPED;
}

/*
 * If a signal's record names a job, that job is to blame. If none is named, any of several jobs may
 * be: none is blamed, and each runs alone from then on. A job that ran alone is blamed, with three
 * exceptions. The machine was restarted. Or the kernel could have killed checks instead, and the
 * daemon had not grown. Or the kernel killed no process and the daemon was not close to its memory
 * limit, so another program may have killed it (earlyoom).
 */
bool orl_previous_exit_caused_by(const struct orl_previous_exit *previous_exit, bool is_named,
                                 bool alone)
{
    if (previous_exit->signum == ORL_EXIT_STOPPED)
        return false;
    if (previous_exit->signum != 0 && previous_exit->job[0])
        return is_named;
    if (!alone || previous_exit->rebooted)
        return false;
    if (previous_exit->not_oom)
        return previous_exit->resident > previous_exit->capacity / 10 * 9;
    return previous_exit->checks == 0 || previous_exit->resident > previous_exit->capacity / 2;
}
