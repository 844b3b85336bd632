#include "distributed/runner.h"

#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <unistd.h>

#include "distributed/atomic_files.h"

extern char **environ;

struct task {
    uint32_t number;
    pid_t pid; /* 0: waiting */
};

struct local {
    struct orl_runner_spec spec;
    char round[ORL_TASK_ROUND_NAME];
    struct task *tasks; /* waiting or running, in order of arrival */
    size_t n_tasks;
};

static int spawn(const struct local *local, struct task *task, struct orl_error *err)
{
    char file[4200], log[4200];
    char *const argv[] = {(char *)"oriel", (char *)"part", file, NULL};
    posix_spawn_file_actions_t actions;
    snprintf(file, sizeof file, "%s/%s-%u.json", local->spec.folder, local->round, task->number);
    snprintf(log, sizeof log, "%s/%s-%u.log", local->spec.folder, local->round, task->number);
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, log, O_WRONLY | O_CREAT | O_TRUNC,
                                     0600);
    posix_spawn_file_actions_adddup2(&actions, STDOUT_FILENO, STDERR_FILENO);
    int rc = posix_spawn(&task->pid, local->spec.program, &actions, NULL, argv, environ);
    posix_spawn_file_actions_destroy(&actions);
    if (rc == 0)
        return 0;
    task->pid = 0;
    return orl_error_set(err, orl_err_of_errno(rc), "'%s' cannot be started: %s",
                         local->spec.program, strerror(rc));
}

/* Removes ended tasks and starts waiting ones in their place. */
static int replace_ended_tasks(struct local *local, struct orl_error *err)
{
    size_t kept = 0, running = 0;
    int rc = 0;
    for (size_t i = 0; i < local->n_tasks; i++) {
        struct task task = local->tasks[i];
        if (task.pid > 0 && waitpid(task.pid, NULL, WNOHANG) != 0)
            continue;
        running += task.pid > 0;
        local->tasks[kept++] = task;
    }
    local->n_tasks = kept;
    for (size_t i = 0; i < kept && running < local->spec.most && rc == 0; i++)
        if (local->tasks[i].pid == 0) {
            rc = spawn(local, &local->tasks[i], err);
            running++;
        }
    return rc;
}

static int local_start(void *ctx, const char *round, const struct orl_part_request *requests,
                       size_t n, size_t n_all, struct orl_error *err)
{
    struct local *local = ctx;
    struct task *grown = realloc(local->tasks, (local->n_tasks + n) * sizeof *grown);
    (void)n_all;
    if (!grown)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for %zu parts", n);
    local->tasks = grown;
    snprintf(local->round, sizeof local->round, "%s", round);
    for (size_t i = 0; i < n; i++)
        local->tasks[local->n_tasks++] = (struct task){requests[i].number, 0};
    return replace_ended_tasks(local, err);
}

static int local_poll(void *ctx, const char *round, struct orl_part_status *ret_status, size_t n,
                      struct orl_error *err)
{
    struct local *local = ctx;
    const int rc = replace_ended_tasks(local, err);
    (void)round; /* there is only one round at a time */
    for (size_t i = 0; i < n; i++)
        ret_status[i] = (struct orl_part_status){.state = ORL_PART_GONE};
    for (size_t i = 0; i < local->n_tasks; i++)
        if (local->tasks[i].number < n)
            ret_status[local->tasks[i].number].state =
                local->tasks[i].pid > 0 ? ORL_PART_RUNNING : ORL_PART_WAITING;
    return rc;
}

static int local_cancel(void *ctx, const char *round, struct orl_error *err)
{
    struct local *local = ctx;
    (void)round, (void)err;
    for (size_t i = 0; i < local->n_tasks; i++)
        if (local->tasks[i].pid > 0)
            kill(local->tasks[i].pid, SIGTERM);
    for (size_t i = 0; i < local->n_tasks; i++)
        if (local->tasks[i].pid > 0)
            waitpid(local->tasks[i].pid, NULL, 0);
    local->n_tasks = 0;
    return 0;
}

static void local_done(void *ctx)
{
    struct local *local = ctx;
    local_cancel(local, local->round, NULL);
    free(local->tasks);
    free(local);
}

int orl_runner_local(const struct orl_runner_spec *spec, struct orl_runner *ret_runner,
                     struct orl_error *err)
{
    struct local *local = calloc(1, sizeof *local);
    if (!local)
        return orl_error_no_memory(err);
    local->spec = *spec;
    *ret_runner = (struct orl_runner){.ctx = local,
                                      .files_delay_s = 0.2,
                                      .start = local_start,
                                      .poll = local_poll,
                                      .cancel = local_cancel,
                                      .done = local_done};
    return 0;
}

int orl_own_program(char ret_path[4096], struct orl_error *err)
{
    const ssize_t length = readlink("/proc/self/exe", ret_path, 4095);
    if (length < 0)
        return orl_error_set(err, orl_err_of_errno(errno),
                             "the path of this program's executable is not known");
    ret_path[length] = '\0';
    return 0;
}
