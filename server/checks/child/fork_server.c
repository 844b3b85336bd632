#include "checks/child/child_checks.h"

#include <errno.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <oriel/job/run.h>

#include "checks/child/messages.h"

enum { CHILD_NICE = 5 };

/* Makes the process end when its parent ends. */
static void end_with_parent(pid_t parent)
{
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    if (getppid() != parent)
        _exit(1);
}

/* Returns false if the daemon is gone. */
static bool wait_for_request(void)
{
    char first;
    ssize_t n;
    do
        n = recv(ORL_FORK_SERVER_FD, &first, 1, MSG_PEEK);
    while (n < 0 && errno == EINTR);
    return n > 0;
}

static uint64_t milliseconds(const struct timeval *time)
{
    return (uint64_t)time->tv_sec * 1000 + (uint64_t)time->tv_usec / 1000;
}

static struct orl_child_end run_child(void)
{
    const pid_t fork_server = getpid();
    struct orl_child_end end = {.status = -1};
    struct rusage usage;
    int status;
    const pid_t child = fork();
    if (child == 0) {
        end_with_parent(fork_server);
        orl_child_check(ORL_FORK_SERVER_FD);
        _exit(0);
    }
    end.pid = child;
    while (child > 0 && wait4(child, &status, 0, &usage) < 0 && errno == EINTR)
        ;
    if (child > 0) {
        end.status = status;
        end.peak_bytes = (uint64_t)usage.ru_maxrss << 10;
        end.cpu_ms = milliseconds(&usage.ru_utime) + milliseconds(&usage.ru_stime);
    }
    return end;
}

int orl_fork_server_main(const char *daemon_pid)
{
    end_with_parent((pid_t)strtol(daemon_pid, NULL, 10));
    if (getpriority(PRIO_PROCESS, 0) < CHILD_NICE)
        setpriority(PRIO_PROCESS, 0, CHILD_NICE);
    orl_prepare_thread(NULL); /* if this fails, each child tries again */
    while (wait_for_request()) {
        const struct orl_child_end end = run_child();
        if (!orl_frame_send(ORL_FORK_SERVER_FD, ORL_FRAME_END, &end, sizeof end))
            break;
    }
    return 0;
}
