#include "checks/check_client.h"

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <poll.h>
#include <pthread.h>
#include <signal.h>
#include <spawn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <oriel/base/json_read.h>

#include "checks/child/child_checks.h"
#include "checks/child/messages.h"
#include "process/limits.h"
#include "json/encode.h"

enum { POLL_MS = 25, VERDICT_BYTES = 1 << 20 };

/* One fork server process. */
struct fork_server {
    pid_t pid;
    int fd;
    struct fork_server *next;
};

struct orl_check_pool {
    pthread_mutex_t mutex;
    struct fork_server *idle;
};

extern char **environ;

/* ---- Fork servers
 * --------------------------------------------------------------------------------- */

static int spawn_fork_server(int fd, pid_t *ret_pid)
{
    char parent[16];
    char *const arguments[] = {(char[]){"orield"}, (char[]){ORL_FORK_SERVER_MODE}, parent, NULL};
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    snprintf(parent, sizeof parent, "%d", (int)getpid());
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    /* A process group of its own keeps signals of the daemon's terminal away from the fork server.
     */
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    int rc = posix_spawn_file_actions_adddup2(&actions, fd, ORL_FORK_SERVER_FD);
    rc |= posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    rc |= posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    if (!ORL_SANITIZED)
        rc |= posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    rc |= posix_spawn_file_actions_addclosefrom_np(&actions, ORL_FORK_SERVER_FD + 1);
    if (rc == 0)
        rc = posix_spawn(ret_pid, "/proc/self/exe", &actions, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return rc;
}

static struct fork_server *fork_server_new(void)
{
    struct fork_server *fork_server = calloc(1, sizeof *fork_server);
    int ends[2];
    if (!fork_server)
        return NULL;
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
        free(fork_server);
        return NULL;
    }
    /* dup2 onto the same descriptor would leave the close-on-exec flag set. */
    const int theirs =
        ends[1] == ORL_FORK_SERVER_FD ? fcntl(ends[1], F_DUPFD_CLOEXEC, 10) : ends[1];
    const int rc = spawn_fork_server(theirs, &fork_server->pid);
    close(ends[1]);
    if (theirs != ends[1])
        close(theirs);
    if (rc) {
        errno = rc;
        close(ends[0]);
        free(fork_server);
        return NULL;
    }
    fork_server->fd = ends[0];
    return fork_server;
}

/* Kills the fork server. Its child ends with it. */
static void fork_server_kill(struct fork_server *fork_server)
{
    close(fork_server->fd);
    kill(fork_server->pid, SIGKILL);
    while (waitpid(fork_server->pid, NULL, 0) < 0 && errno == EINTR)
        ;
    free(fork_server);
}

static struct fork_server *acquire_fork_server(struct orl_check_pool *check_pool)
{
    pthread_mutex_lock(&check_pool->mutex);
    struct fork_server *fork_server = check_pool->idle;
    if (fork_server)
        check_pool->idle = fork_server->next;
    pthread_mutex_unlock(&check_pool->mutex);
    return fork_server ? fork_server : fork_server_new();
}

static void release_fork_server(struct orl_check_pool *check_pool, struct fork_server *fork_server)
{
    pthread_mutex_lock(&check_pool->mutex);
    fork_server->next = check_pool->idle;
    check_pool->idle = fork_server;
    pthread_mutex_unlock(&check_pool->mutex);
}

struct orl_check_pool *orl_check_pool_new(void)
{
    struct orl_check_pool *check_pool = calloc(1, sizeof *check_pool);
    if (!check_pool)
        return NULL;
    pthread_mutex_init(&check_pool->mutex, NULL);
    check_pool->idle = fork_server_new(); /* if this fails, a later check tries again */
    return check_pool;
}

void orl_check_pool_free(struct orl_check_pool *check_pool)
{
    if (!check_pool)
        return;
    while (check_pool->idle) {
        struct fork_server *fork_server = check_pool->idle;
        check_pool->idle = fork_server->next;
        fork_server_kill(fork_server);
    }
    pthread_mutex_destroy(&check_pool->mutex);
    free(check_pool);
}

/* ---- One check ------------------------------------------------------------------------------- */

struct exchange {
    struct orl_check_call *call;
    struct fork_server *fork_server;
    struct orl_frame_text verdict;
    bool complete; /* true once the whole verdict has arrived */
    bool ended;    /* true once the child has ended; `end` is then set */
    struct orl_child_end end;
    struct orl_error *err;
};

static bool is_cancelled(const struct orl_check_call *call)
{
    struct pollfd client = {.fd = call->client_fd, .events = POLLRDHUP};
    if (call->cancel && atomic_load(call->cancel))
        return true;
    return call->client_fd >= 0 && poll(&client, 1, 0) > 0 &&
           (client.revents & (POLLRDHUP | POLLHUP | POLLERR));
}

static int wait_for_socket(struct exchange *t, short events)
{
    struct pollfd fds[2] = {{.fd = t->fork_server->fd, .events = events},
                            {.fd = t->call->client_fd, .events = POLLRDHUP}};
    while (!is_cancelled(t->call)) {
        const int n = poll(fds, 2, POLL_MS);
        if (n < 0 && errno != EINTR)
            return orl_error_set(t->err, ORL_ERR_INTERNAL, "cannot wait for a check");
        if (fds[0].revents)
            return 0;
    }
    return orl_error_set(t->err, ORL_ERR_CANCELLED, "the check was cancelled");
}

/* Sends the request. A fork server that has ended is noticed later, when the reply is read. */
static int send_request(struct exchange *t, const char *text, size_t size)
{
    int rc = 0;
    while (rc == 0) {
        const bool last = size <= ORL_FRAME_BYTES;
        const size_t n = last ? size : ORL_FRAME_BYTES;
        rc = wait_for_socket(t, POLLOUT);
        if (rc == 0 && !orl_frame_send(t->fork_server->fd,
                                       last ? ORL_FRAME_REQUEST_END : ORL_FRAME_REQUEST, text, n))
            break;
        if (last)
            break;
        text += n;
        size -= n;
    }
    return rc;
}

static int refuse_packet(struct exchange *t)
{
    return orl_error_set(t->err, ORL_ERR_INTERNAL, "the check process sent an invalid reply");
}

static int handle_packet(struct exchange *t, char kind, char *data, size_t size)
{
    struct orl_check_call *call = t->call;
    switch (kind) {
    case ORL_FRAME_FILE:
        data[size] = '\0';
        return call->file ? call->file(call->ctx, data, t->err) : refuse_packet(t);
    case ORL_FRAME_DATA:
        return call->data ? call->data(call->ctx, data, size, t->err) : refuse_packet(t);
    case ORL_FRAME_VERDICT:
    case ORL_FRAME_VERDICT_END:
        if (t->complete || size > VERDICT_BYTES - t->verdict.size)
            return refuse_packet(t);
        if (!orl_frame_text_add(&t->verdict, data, size, VERDICT_BYTES))
            return orl_error_no_memory(t->err);
        t->complete = kind == ORL_FRAME_VERDICT_END;
        return 0;
    case ORL_FRAME_END:
        if (size != sizeof t->end)
            return refuse_packet(t);
        memcpy(&t->end, data, size);
        t->ended = true;
        return 0;
    default:
        return refuse_packet(t);
    }
}

static int receive_verdict(struct exchange *t)
{
    char *packet = malloc(ORL_FRAME_BYTES + 2);
    int rc = packet ? 0 : orl_error_no_memory(t->err);
    while (packet && rc == 0 && !t->ended) {
        rc = wait_for_socket(t, POLLIN);
        if (rc)
            break;
        const ssize_t n = recv(t->fork_server->fd, packet, ORL_FRAME_BYTES + 1, 0);
        if (n > 0)
            rc = handle_packet(t, packet[0], packet + 1, (size_t)n - 1);
        else if (n == 0 || errno != EINTR)
            rc = orl_error_set(t->err, ORL_ERR_INTERNAL,
                               "the fork server of the checks ended unexpectedly");
    }
    free(packet);
    return rc;
}

/* ---- Causes of death ------------------------------------------------------------------------ */

static int report_bound(struct exchange *t, enum orl_child_bound bound)
{
    struct orl_check_call *call = t->call;
    call->met = bound;
    if (bound == ORL_CHILD_MEMORY) {
        orl_error_set(t->err, ORL_ERR_LIMIT, "the check takes more than %llu MiB of memory",
                      (unsigned long long)(call->memory >> 20));
        orl_error_hint(t->err, "Reduce the number of surfaces, copies or values; --check-memory "
                               "and --memory set the limit");
        return ORL_ERR_LIMIT;
    }
    /* The kernel's limit counts ticks; the reported time may be a few ticks less. */
    orl_error_set(t->err, ORL_ERR_LIMIT,
                  "the check was stopped after %.1f seconds of processor time; the limit is %u "
                  "(--check-timeout)",
                  fmax((double)t->end.cpu_ms / 1000, call->cpu_s), call->cpu_s);
    orl_error_hint(t->err, "Upload fewer surfaces, copies or values, or start orield with a "
                           "larger --check-timeout");
    return ORL_ERR_LIMIT;
}

static int report_fault(struct exchange *t, int signum)
{
    t->call->met = ORL_CHILD_FAULT;
    orl_error_set(t->err, ORL_ERR_UNSUPPORTED, "the check crashed because of a bug in Oriel (%s)",
                  signum > 0 ? strsignal(signum) : "no answer");
    orl_error_hint(
        t->err,
        "The upload is not stored. Please report this to Oriel's authors and attach the upload");
    return ORL_ERR_UNSUPPORTED;
}

static int report_death(struct exchange *t)
{
    const int status = t->end.status;
    if (t->end.pid <= 0)
        return orl_error_set(t->err, ORL_ERR_NOMEM, "cannot start a process for the check");
    if (WIFEXITED(status) && WEXITSTATUS(status) == ORL_CHILD_NO_MEMORY)
        return report_bound(t, ORL_CHILD_MEMORY);
    if (!WIFSIGNALED(status))
        return report_fault(t, 0);
    if (WTERMSIG(status) == SIGXCPU)
        return report_bound(t, ORL_CHILD_CPU);
    if (WTERMSIG(status) != SIGKILL)
        return report_fault(t, WTERMSIG(status));
    /* The daemon sends no SIGKILL here, so the kernel did. */
    t->call->met = ORL_CHILD_KILLED;
    return orl_error_set(t->err, ORL_ERR_NOMEM,
                         "the system killed the check because memory ran out");
}

static int read_verdict(struct exchange *t, json_t **ret_result)
{
    json_t *doc = orl_json_read(t->verdict.text, t->verdict.size, JSON_REJECT_DUPLICATES, NULL);
    const bool starved = errno == ENOMEM;
    const json_t *error = json_object_get(doc, "error");
    json_t *result = json_object_get(doc, "result");
    struct orl_error found;
    int rc = 0;
    if (error) {
        orl_child_error_from_json(error, &found);
        rc = found.code == ORL_ERR_NOMEM ? report_bound(t, ORL_CHILD_MEMORY) : found.code;
        if (t->err && found.code != ORL_ERR_NOMEM)
            *t->err = found;
    } else if (result) {
        *ret_result = json_incref(result);
    } else if (starved) {
        rc = orl_error_no_memory(t->err);
    } else {
        rc = refuse_packet(t);
    }
    json_decref(doc);
    return rc;
}

int orl_check_pool_run(struct orl_check_call *call, const json_t *request, json_t **ret_result,
                       struct orl_error *err)
{
    struct exchange t = {.call = call, .err = err};
    call->met = ORL_CHILD_NONE;
    call->peak_bytes = 0;
    char *text = orl_json_text(request, JSON_COMPACT);
    if (!text)
        return orl_error_no_memory(err);
    t.fork_server = acquire_fork_server(call->check_pool);
    int rc = t.fork_server
                 ? 0
                 : orl_error_set(err, ORL_ERR_NOMEM, "cannot start a process for the check: %s",
                                 strerror(errno));
    if (rc == 0)
        rc = send_request(&t, text, strlen(text));
    if (rc == 0)
        rc = receive_verdict(&t);
    free(text);
    /* After a clean end the fork server is reused. Otherwise unread packets would be mistaken for
     * the next verdict. */
    const bool clean = rc == 0 && t.complete && WIFEXITED(t.end.status);
    if (t.fork_server && clean)
        release_fork_server(call->check_pool, t.fork_server);
    else if (t.fork_server)
        fork_server_kill(t.fork_server);
    call->peak_bytes = t.end.peak_bytes;
    if (rc == 0)
        rc = t.complete ? read_verdict(&t, ret_result) : report_death(&t);
    free(t.verdict.text);
    return rc;
}
