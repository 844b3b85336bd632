#include "checks/lanes.h"

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

#include <oriel/json_read.h>

#include "checks/child_checks.h"
#include "checks/confine.h"
#include "checks/frames.h"
#include "checks/keeper.h"
#include "encode.h"
#include "process/sanitized.h"

enum { POLL_MS = 25, VERDICT_BYTES = 1 << 20 };

/* One keeper process. */
struct lane {
    pid_t pid;
    int fd;
    struct lane *next;
};

struct orl_lanes {
    pthread_mutex_t mutex;
    struct lane *idle;
};

extern char **environ;

/* ---- Keepers --------------------------------------------------------------------------------- */

static int spawn_keeper(int fd, pid_t *ret_pid)
{
    char parent[16];
    char *const arguments[] = {(char[]){"orield"}, (char[]){ORL_KEEPER_MODE}, parent, NULL};
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    snprintf(parent, sizeof parent, "%d", (int)getpid());
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    /* A process group of its own keeps signals of the daemon's terminal away from the keeper. */
    posix_spawnattr_setpgroup(&attributes, 0);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    int rc = posix_spawn_file_actions_adddup2(&actions, fd, ORL_KEEPER_FD);
    rc |= posix_spawn_file_actions_addopen(&actions, 0, "/dev/null", O_RDONLY, 0);
    rc |= posix_spawn_file_actions_addopen(&actions, 1, "/dev/null", O_WRONLY, 0);
    if (!ORL_SANITIZED)
        rc |= posix_spawn_file_actions_addopen(&actions, 2, "/dev/null", O_WRONLY, 0);
    rc |= posix_spawn_file_actions_addclosefrom_np(&actions, ORL_KEEPER_FD + 1);
    if (rc == 0)
        rc = posix_spawn(ret_pid, "/proc/self/exe", &actions, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return rc;
}

static struct lane *lane_new(void)
{
    struct lane *lane = calloc(1, sizeof *lane);
    int ends[2];
    if (!lane)
        return NULL;
    if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends) != 0) {
        free(lane);
        return NULL;
    }
    /* dup2 onto the same descriptor would leave the close-on-exec flag set. */
    const int theirs = ends[1] == ORL_KEEPER_FD ? fcntl(ends[1], F_DUPFD_CLOEXEC, 10) : ends[1];
    const int rc = spawn_keeper(theirs, &lane->pid);
    close(ends[1]);
    if (theirs != ends[1])
        close(theirs);
    if (rc) {
        errno = rc;
        close(ends[0]);
        free(lane);
        return NULL;
    }
    lane->fd = ends[0];
    return lane;
}

/* Kills the keeper. Its child ends with it. */
static void lane_kill(struct lane *lane)
{
    close(lane->fd);
    kill(lane->pid, SIGKILL);
    while (waitpid(lane->pid, NULL, 0) < 0 && errno == EINTR)
        ;
    free(lane);
}

static struct lane *take_lane(struct orl_lanes *lanes)
{
    pthread_mutex_lock(&lanes->mutex);
    struct lane *lane = lanes->idle;
    if (lane)
        lanes->idle = lane->next;
    pthread_mutex_unlock(&lanes->mutex);
    return lane ? lane : lane_new();
}

static void return_lane(struct orl_lanes *lanes, struct lane *lane)
{
    pthread_mutex_lock(&lanes->mutex);
    lane->next = lanes->idle;
    lanes->idle = lane;
    pthread_mutex_unlock(&lanes->mutex);
}

struct orl_lanes *orl_lanes_new(void)
{
    struct orl_lanes *lanes = calloc(1, sizeof *lanes);
    if (!lanes)
        return NULL;
    pthread_mutex_init(&lanes->mutex, NULL);
    lanes->idle = lane_new(); /* if this fails, a later check tries again */
    return lanes;
}

void orl_lanes_free(struct orl_lanes *lanes)
{
    if (!lanes)
        return;
    while (lanes->idle) {
        struct lane *lane = lanes->idle;
        lanes->idle = lane->next;
        lane_kill(lane);
    }
    pthread_mutex_destroy(&lanes->mutex);
    free(lanes);
}

/* ---- One check ------------------------------------------------------------------------------- */

struct talk {
    struct orl_asking *asking;
    struct lane *lane;
    struct orl_frame_text verdict;
    bool complete; /* true once the whole verdict has arrived */
    bool ended;    /* true once the child has ended; `end` is then set */
    struct orl_child_end end;
    struct orl_error *err;
};

static bool is_given_up(const struct orl_asking *asking)
{
    struct pollfd client = {.fd = asking->client_fd, .events = POLLRDHUP};
    if (asking->cancel && atomic_load(asking->cancel))
        return true;
    return asking->client_fd >= 0 && poll(&client, 1, 0) > 0 &&
           (client.revents & (POLLRDHUP | POLLHUP | POLLERR));
}

static int wait_for_socket(struct talk *t, short events)
{
    struct pollfd fds[2] = {{.fd = t->lane->fd, .events = events},
                            {.fd = t->asking->client_fd, .events = POLLRDHUP}};
    while (!is_given_up(t->asking)) {
        const int n = poll(fds, 2, POLL_MS);
        if (n < 0 && errno != EINTR)
            return orl_error_set(t->err, ORL_ERR_INTERNAL, "cannot wait for a check");
        if (fds[0].revents)
            return 0;
    }
    return orl_error_set(t->err, ORL_ERR_CANCELLED, "the check was given up");
}

/* Sends the request. A keeper that has ended is noticed later, when the reply is read. */
static int send_request(struct talk *t, const char *text, size_t size)
{
    int rc = 0;
    while (rc == 0) {
        const bool last = size <= ORL_FRAME_BYTES;
        const size_t n = last ? size : ORL_FRAME_BYTES;
        rc = wait_for_socket(t, POLLOUT);
        if (rc == 0 &&
            !orl_frame_send(t->lane->fd, last ? ORL_FRAME_REQUEST_END : ORL_FRAME_REQUEST, text, n))
            break;
        if (last)
            break;
        text += n;
        size -= n;
    }
    return rc;
}

static int refuse_packet(struct talk *t)
{
    return orl_error_set(t->err, ORL_ERR_INTERNAL, "a check answered what makes no sense");
}

static int handle_packet(struct talk *t, char kind, char *data, size_t size)
{
    struct orl_asking *asking = t->asking;
    switch (kind) {
    case ORL_FRAME_FILE:
        data[size] = '\0';
        return asking->file ? asking->file(asking->ctx, data, t->err) : refuse_packet(t);
    case ORL_FRAME_DATA:
        return asking->data ? asking->data(asking->ctx, data, size, t->err) : refuse_packet(t);
    case ORL_FRAME_VERDICT:
    case ORL_FRAME_VERDICT_END:
        if (t->complete || size > VERDICT_BYTES - t->verdict.size)
            return refuse_packet(t);
        if (!orl_frame_text_add(&t->verdict, data, size, VERDICT_BYTES))
            return orl_error_set(t->err, ORL_ERR_NOMEM, "out of memory");
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

static int receive_verdict(struct talk *t)
{
    char *packet = malloc(ORL_FRAME_BYTES + 2);
    int rc = packet ? 0 : orl_error_set(t->err, ORL_ERR_NOMEM, "out of memory");
    while (packet && rc == 0 && !t->ended) {
        rc = wait_for_socket(t, POLLIN);
        if (rc)
            break;
        const ssize_t n = recv(t->lane->fd, packet, ORL_FRAME_BYTES + 1, 0);
        if (n > 0)
            rc = handle_packet(t, packet[0], packet + 1, (size_t)n - 1);
        else if (n == 0 || errno != EINTR)
            rc = orl_error_set(t->err, ORL_ERR_INTERNAL, "a check's keeper ended");
    }
    free(packet);
    return rc;
}

/* ---- Causes of death ------------------------------------------------------------------------ */

static int report_bound(struct talk *t, enum orl_child_bound bound)
{
    struct orl_asking *asking = t->asking;
    asking->met = bound;
    if (bound == ORL_CHILD_MEMORY) {
        orl_error_set(t->err, ORL_ERR_LIMIT, "checking it takes more than %llu MiB of memory",
                      (unsigned long long)(asking->memory >> 20));
        orl_error_hint(t->err, "Fewer surfaces, copies or values take less; --check-memory and "
                               "--memory set the bound");
        return ORL_ERR_LIMIT;
    }
    /* The kernel's limit counts ticks; the reported time may be a few ticks less. */
    orl_error_set(t->err, ORL_ERR_LIMIT,
                  "the check was stopped after %.1f seconds of a processor; the limit is %u "
                  "(--check-timeout)",
                  fmax((double)t->end.cpu_ms / 1000, asking->cpu_s), asking->cpu_s);
    orl_error_hint(t->err, "Upload fewer surfaces, copies or values, or start orield with a "
                           "larger --check-timeout");
    return ORL_ERR_LIMIT;
}

static int report_fault(struct talk *t, int signum)
{
    t->asking->met = ORL_CHILD_FAULT;
    orl_error_set(t->err, ORL_ERR_UNSUPPORTED, "checking it ended in a fault of Oriel's (%s)",
                  signum > 0 ? strsignal(signum) : "no answer");
    orl_error_hint(t->err, "It is not kept. Please tell Oriel's authors, with the upload");
    return ORL_ERR_UNSUPPORTED;
}

static int report_death(struct talk *t)
{
    const int status = t->end.status;
    if (t->end.pid <= 0)
        return orl_error_set(t->err, ORL_ERR_NOMEM, "no process for a check");
    if (WIFEXITED(status) && WEXITSTATUS(status) == ORL_CHILD_NO_MEMORY)
        return report_bound(t, ORL_CHILD_MEMORY);
    if (!WIFSIGNALED(status))
        return report_fault(t, 0);
    if (WTERMSIG(status) == SIGXCPU)
        return report_bound(t, ORL_CHILD_CPU);
    if (WTERMSIG(status) != SIGKILL)
        return report_fault(t, WTERMSIG(status));
    /* The daemon sends no SIGKILL here, so the kernel did. */
    t->asking->met = ORL_CHILD_KILLED;
    return orl_error_set(t->err, ORL_ERR_NOMEM, "the system ended the check for want of memory");
}

static int read_verdict(struct talk *t, json_t **ret_result)
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
        rc = orl_error_set(t->err, ORL_ERR_NOMEM, "out of memory");
    } else {
        rc = refuse_packet(t);
    }
    json_decref(doc);
    return rc;
}

int orl_lanes_run(struct orl_asking *asking, const json_t *request, json_t **ret_result,
                  struct orl_error *err)
{
    struct talk t = {.asking = asking, .err = err};
    asking->met = ORL_CHILD_NONE;
    asking->peak_bytes = 0;
    char *text = request ? orl_json_text(request, JSON_COMPACT) : NULL;
    if (!text)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    t.lane = take_lane(asking->lanes);
    int rc = t.lane
                 ? 0
                 : orl_error_set(err, ORL_ERR_NOMEM, "no process for a check: %s", strerror(errno));
    if (rc == 0)
        rc = send_request(&t, text, strlen(text));
    if (rc == 0)
        rc = receive_verdict(&t);
    free(text);
    /* After a clean end the keeper is reused. Otherwise unread packets would be mistaken for the
     * next verdict. */
    const bool clean = rc == 0 && t.complete && WIFEXITED(t.end.status);
    if (t.lane && clean)
        return_lane(asking->lanes, t.lane);
    else if (t.lane)
        lane_kill(t.lane);
    asking->peak_bytes = t.end.peak_bytes;
    if (rc == 0)
        rc = t.complete ? read_verdict(&t, ret_result) : report_death(&t);
    free(t.verdict.text);
    return rc;
}
