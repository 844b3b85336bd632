#include "distributed/runner.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <stdbool.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

enum { MOST = ORL_COMMAND_OUTPUT - 1, TURN_MS = 50 };

/* Starts a program with empty standard input; its output goes to a pipe (ends). It ignores and
 * blocks no signals, regardless of the calling thread. */
static int spawn(char *const argv[], const int ends[2], pid_t *ret_pid)
{
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    sigset_t none, usual;
    sigemptyset(&none);
    sigemptyset(&usual);
    sigaddset(&usual, SIGPIPE);
    sigaddset(&usual, SIGXFSZ);
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setsigmask(&attributes, &none);
    posix_spawnattr_setsigdefault(&attributes, &usual);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, ends[1], STDERR_FILENO);
    int rc = posix_spawnp(ret_pid, argv[0], &actions, &attributes, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    posix_spawnattr_destroy(&attributes);
    return rc;
}

/* Reads output until its end. Returns 0 or a negative orl_err. */
static int read_output(int from, double limit_s, const atomic_bool *cancel, char *output)
{
    const int turns = (int)(limit_s * 1000 / TURN_MS) + 1;
    struct pollfd waits = {.fd = from, .events = POLLIN};
    size_t size = 0;
    for (int idle = 0; idle < turns; idle++) {
        if (cancel && atomic_load(cancel))
            return ORL_ERR_CANCELLED;
        if (poll(&waits, 1, TURN_MS) <= 0)
            continue;
        const ssize_t got = read(from, output + size, MOST - size);
        if (got > 0)
            size += (size_t)got;
        output[size] = '\0';
        if (got == 0 || (got < 0 && errno != EINTR) || size == MOST)
            return 0;
    }
    return ORL_ERR_IO;
}

static int wait_for_exit(pid_t pid)
{
    int status = 0;
    while (waitpid(pid, &status, 0) < 0 && errno == EINTR)
        ;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

int orl_command_run(char *const argv[], double limit_s, const atomic_bool *cancel,
                    char ret_output[ORL_COMMAND_OUTPUT], struct orl_error *err)
{
    int ends[2], rc, status;
    pid_t pid = 0;
    ret_output[0] = '\0';
    if (pipe2(ends, O_CLOEXEC) != 0)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of file descriptors to run '%s'", argv[0]);
    rc = spawn(argv, ends, &pid);
    close(ends[1]);
    if (rc) {
        close(ends[0]);
        return orl_error_set(err, ORL_ERR_NOT_FOUND, "the command '%s' cannot be started: %s",
                             argv[0], strerror(rc));
    }
    rc = read_output(ends[0], limit_s, cancel, ret_output);
    close(ends[0]);
    if (rc)
        kill(pid, SIGKILL);
    status = wait_for_exit(pid);
    if (rc == 0)
        return status;
    ret_output[0] = '\0';
    return rc == ORL_ERR_CANCELLED
               ? orl_error_set(err, rc, "cancelled while '%s' ran", argv[0])
               : orl_error_set(err, rc, "the command '%s' did not end within %.0f s", argv[0],
                               limit_s);
}
