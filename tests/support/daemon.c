#include "support/daemon.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <arpa/inet.h>
#include <cmocka.h>
#include <curl/curl.h>
#include <errno.h>
#include <fcntl.h>
#include <ftw.h>
#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "process/limits.h"
#include "support/patience.h"

static double now_s(void)
{
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static void nap(double seconds)
{
    const struct timespec t = {(time_t)seconds, (long)(1e9 * (seconds - floor(seconds)))};
    nanosleep(&t, NULL);
}

/* ---- The process ---------------------------------------------------------------------------- */

enum { MAX_ARGS = 32 };

static void run_child(const struct daemon *daemon, const char *const *extra, int out)
{
    char program[512], log[96];
    const char *build = getenv("ORIEL_BUILD");
    /* Checks take ten times as long and more under a sanitizer. */
    const char *args[MAX_ARGS] = {"orield", "--port",          "0",
                                  "--data", daemon->root,      "--drain-timeout",
                                  "0",      "--check-timeout", ORL_SANITIZED ? "1200" : "120"};
    snprintf(program, sizeof program, "%s/orield", build ? build : "build");
    for (int i = 0; extra && extra[i] && i + 10 < MAX_ARGS; i++)
        args[9 + i] = extra[i];
    snprintf(log, sizeof log, "%s.log", daemon->root);
    const int err = open(log, O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0666);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    dup2(out, STDOUT_FILENO);
    dup2(err, STDERR_FILENO);
    execv(program, (char *const *)(uintptr_t)args);
    _exit(127);
}

/* Reads "listening on http://..." from the child. */
static void read_url(struct daemon *daemon, int fd)
{
    static const char prefix[] = "listening on ";
    char line[128] = "";
    size_t used = 0;
    while (used + 1 < sizeof line && !strchr(line, '\n')) {
        const ssize_t n = read(fd, line + used, sizeof line - 1 - used);
        if (n <= 0)
            fail_msg("the daemon did not start; see %s.log", daemon->root);
        used += (size_t)n;
        line[used] = '\0';
    }
    line[strcspn(line, "\n")] = '\0';
    assert_int_equal(strncmp(line, prefix, sizeof prefix - 1), 0);
    snprintf(daemon->url, sizeof daemon->url, "%.63s", line + sizeof prefix - 1);
}

void daemon_restart(struct daemon *daemon, const char *const *extra)
{
    int fds[2];
    assert_int_equal(pipe2(fds, O_CLOEXEC), 0);
    daemon->pid = fork();
    assert_true(daemon->pid >= 0);
    if (daemon->pid == 0)
        run_child(daemon, extra, fds[1]);
    close(fds[1]);
    read_url(daemon, fds[0]);
    close(fds[0]);
    daemon->curl = curl_easy_init();
    assert_non_null(daemon->curl);
}

void daemon_start(struct daemon *daemon, const char *const *extra)
{
    memset(daemon, 0, sizeof *daemon);
    snprintf(daemon->root, sizeof daemon->root, "/tmp/oriel-test-XXXXXX");
    assert_non_null(mkdtemp(daemon->root));
    daemon_restart(daemon, extra);
}

int daemon_end(struct daemon *daemon, int signum)
{
    if (daemon->pid <=
        0) /* kill(0) would signal the whole process group, the test runner included */
        return -1;
    kill(daemon->pid, signum);
    return daemon_wait_end(daemon);
}

int daemon_wait_end(struct daemon *daemon)
{
    int status = 0;
    curl_easy_cleanup(daemon->curl);
    daemon->curl = NULL;
    while (waitpid(daemon->pid, &status, 0) < 0 && errno == EINTR)
        continue;
    daemon->pid = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

static int remove_entry(const char *path, const struct stat *st, int type, struct FTW *ftw)
{
    (void)st, (void)type, (void)ftw;
    return remove(path);
}

void daemon_remove(struct daemon *daemon)
{
    char log[96];
    /* Ends it in order, so that a sanitizer reports everything that the daemon did. */
    const int status = daemon->pid > 0 ? daemon_end(daemon, SIGTERM) : 0;
    if (status != 0)
        fail_msg("the daemon ended with status %d; see %s.log", status, daemon->root);
    nftw(daemon->root, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
    snprintf(log, sizeof log, "%s.log", daemon->root);
    unlink(log);
}

double daemon_memory_mb(const struct daemon *daemon, const char *name)
{
    char path[64], line[256];
    double kb = -1;
    snprintf(path, sizeof path, "/proc/%d/status", (int)daemon->pid);
    FILE *status = fopen(path, "r");
    assert_non_null(status);
    while (kb < 0 && fgets(line, sizeof line, status))
        if (strncmp(line, name, strlen(name)) == 0)
            kb = strtod(line + strlen(name) + 1, NULL);
    fclose(status);
    assert_true(kb >= 0);
    return kb / 1024;
}

static size_t counted;

static int count_entry(const char *path, const struct stat *st, int type, struct FTW *ftw)
{
    (void)path, (void)ftw;
    counted += type == FTW_F && S_ISREG(st->st_mode);
    return 0;
}

size_t daemon_count_files(const struct daemon *daemon, const char *folder)
{
    char path[160];
    snprintf(path, sizeof path, "%s/%s", daemon->root, folder);
    do
        counted = 0;
    while (nftw(path, count_entry, 16, FTW_PHYS) < 0 && errno == ENOENT && access(path, F_OK) == 0);
    return counted; /* the count of a walk during which no folder was removed */
}

void daemon_expect_no_files(const struct daemon *daemon, const char *folder)
{
    for (double until = patience_until(); daemon_count_files(daemon, folder) > 0;)
        if (!patience_nap(until))
            fail_msg("%zu files stay in %s", daemon_count_files(daemon, folder), folder);
}

/* ---- Requests ------------------------------------------------------------------------------- */

struct buffer {
    char *data;
    size_t size;
};

static size_t collect(char *data, size_t one, size_t count, void *ctx)
{
    struct buffer *buffer = ctx;
    char *grown = realloc(buffer->data, buffer->size + one * count + 1);
    if (!grown)
        return 0;
    memcpy(grown + buffer->size, data, one * count);
    buffer->data = grown;
    buffer->size += one * count;
    grown[buffer->size] = '\0';
    return one * count;
}

static void perform(struct daemon *daemon, const char *path, struct reply *ret_reply)
{
    char url[512];
    struct buffer body = {calloc(1, 1), 0}, headers = {calloc(1, 1), 0};
    snprintf(url, sizeof url, "%s%s", daemon->url, path);
    curl_easy_setopt(daemon->curl, CURLOPT_URL, url);
    curl_easy_setopt(daemon->curl, CURLOPT_TIMEOUT, 300L);
    if (daemon->ca[0])
        curl_easy_setopt(daemon->curl, CURLOPT_CAINFO, daemon->ca);
    curl_easy_setopt(daemon->curl, CURLOPT_WRITEFUNCTION, collect);
    curl_easy_setopt(daemon->curl, CURLOPT_WRITEDATA, &body);
    curl_easy_setopt(daemon->curl, CURLOPT_HEADERFUNCTION, collect);
    curl_easy_setopt(daemon->curl, CURLOPT_HEADERDATA, &headers);
    const double started = now_s();
    const CURLcode code = curl_easy_perform(daemon->curl);
    memset(ret_reply, 0, sizeof *ret_reply);
    ret_reply->seconds = now_s() - started;
    if (code != CURLE_OK)
        fail_msg("%s: %s", path, curl_easy_strerror(code));
    curl_easy_getinfo(daemon->curl, CURLINFO_RESPONSE_CODE, &ret_reply->status);
    ret_reply->body = body.data;
    ret_reply->size = body.size;
    ret_reply->headers = headers.data;
    ret_reply->json = json_loadb(body.data, body.size, 0, NULL);
}

void daemon_request(struct daemon *daemon, const char *method, const char *path, const char *type,
                    const void *body, size_t size, const char *header, struct reply *ret_reply)
{
    char content[128];
    struct curl_slist *list = curl_slist_append(NULL, "Expect:");
    snprintf(content, sizeof content, "Content-Type:%s%s", type ? " " : "", type ? type : "");
    list = curl_slist_append(list, content);
    if (header)
        list = curl_slist_append(list, header);
    curl_easy_reset(daemon->curl);
    curl_easy_setopt(daemon->curl, CURLOPT_HTTPHEADER, list);
    curl_easy_setopt(daemon->curl, CURLOPT_CUSTOMREQUEST, method);
    if (strcmp(method, "HEAD") == 0)
        curl_easy_setopt(daemon->curl, CURLOPT_NOBODY, 1L);
    if (body) {
        curl_easy_setopt(daemon->curl, CURLOPT_POSTFIELDSIZE_LARGE, (curl_off_t)size);
        curl_easy_setopt(daemon->curl, CURLOPT_POSTFIELDS, body);
    }
    perform(daemon, path, ret_reply);
    curl_slist_free_all(list);
}

int daemon_dial(const struct daemon *daemon)
{
    struct sockaddr_in address = {.sin_family = AF_INET};
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    address.sin_port = htons((uint16_t)strtoul(strrchr(daemon->url, ':') + 1, NULL, 10));
    const int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    assert_true(fd >= 0);
    assert_int_equal(connect(fd, (struct sockaddr *)&address, sizeof address), 0);
    return fd;
}

void daemon_get(struct daemon *daemon, const char *path, struct reply *ret_reply)
{
    daemon_request(daemon, "GET", path, NULL, NULL, 0, NULL, ret_reply);
}

void daemon_post_json(struct daemon *daemon, const char *path, const char *json,
                      struct reply *ret_reply)
{
    daemon_request(daemon, "POST", path, "application/json", json, strlen(json), NULL, ret_reply);
}

void daemon_upload(struct daemon *daemon, const struct upload_file *files, size_t count,
                   const char *bsdfs, struct reply *ret_reply)
{
    curl_easy_reset(daemon->curl);
    curl_mime *form = curl_mime_init(daemon->curl);
    for (size_t i = 0; i < count; i++) {
        curl_mimepart *part = curl_mime_addpart(form);
        curl_mime_name(part, files[i].resource ? "resource" : "file");
        curl_mime_data(part, files[i].data, files[i].size);
        curl_mime_filename(part, files[i].name);
    }
    if (bsdfs) {
        curl_mimepart *part = curl_mime_addpart(form);
        curl_mime_name(part, "bsdfs");
        curl_mime_data(part, bsdfs, CURL_ZERO_TERMINATED);
    }
    curl_easy_setopt(daemon->curl, CURLOPT_MIMEPOST, form);
    perform(daemon, "/v1/scenes", ret_reply);
    curl_mime_free(form);
}

void reply_done(struct reply *reply)
{
    free(reply->headers);
    free(reply->body);
    json_decref(reply->json);
    memset(reply, 0, sizeof *reply);
}

const json_t *reply_at(const struct reply *reply, const char *path)
{
    const json_t *at = reply->json;
    while (at && *path) {
        char name[64];
        const size_t length = strcspn(path, ".");
        snprintf(name, sizeof name, "%.*s", (int)length, path);
        at = json_is_array(at) ? json_array_get(at, strtoul(name, NULL, 10))
                               : json_object_get(at, name);
        path += length + (path[length] == '.');
    }
    return at;
}

const char *reply_text(const struct reply *reply, const char *path)
{
    const char *text = json_string_value(reply_at(reply, path));
    return text ? text : "";
}

double reply_number(const struct reply *reply, const char *path)
{
    const json_t *value = reply_at(reply, path);
    return json_is_number(value) ? json_number_value(value) : (double)NAN;
}

const char *reply_header(const struct reply *reply, const char *name)
{
    static char value[512];
    const size_t length = strlen(name);
    for (const char *line = reply->headers; line && *line;) {
        if (strncasecmp(line, name, length) == 0 && line[length] == ':') {
            line += length + 1;
            line += strspn(line, " ");
            snprintf(value, sizeof value, "%.*s", (int)strcspn(line, "\r\n"), line);
            return value;
        }
        line = strchr(line, '\n');
        line = line ? line + 1 : NULL;
    }
    return NULL;
}

/* ---- Jobs ----------------------------------------------------------------------------------- */

/* 4 x 5 x 3 m, a window to the south; normals face inwards. */
const char room_scene[] = "void plastic white\n0\n0\n5 0.7 0.7 0.7 0 0\n"
                          "void plastic grey\n0\n0\n5 0.2 0.2 0.2 0 0\n"
                          "void glass pane\n0\n0\n3 0.9 0.9 0.9\n"
                          "grey polygon floor\n0\n0\n12 0 0 0  4 0 0  4 5 0  0 5 0\n"
                          "white polygon ceiling\n0\n0\n12 0 0 3  0 5 3  4 5 3  4 0 3\n"
                          "white polygon east\n0\n0\n12 4 0 0  4 0 3  4 5 3  4 5 0\n"
                          "white polygon west\n0\n0\n12 0 0 0  0 5 0  0 5 3  0 0 3\n"
                          "white polygon north\n0\n0\n12 0 5 0  4 5 0  4 5 3  0 5 3\n"
                          "white polygon sill\n0\n0\n12 0 0 0  0 0 1  4 0 1  4 0 0\n"
                          "white polygon lintel\n0\n0\n12 0 0 2.5  0 0 3  4 0 3  4 0 2.5\n"
                          "pane polygon window\n0\n0\n12 0 0 1  0 0 2.5  4 0 2.5  4 0 1\n";

const char room_sky[] = "!gendaylit 3 22 12 -a 38.42 -o -27.14 -m -30 -W 800 120\n"
                        "skyfunc glow sky_glow\n0\n0\n4 1 1 1 0\n"
                        "sky_glow source sky\n0\n0\n4 0 0 1 180\n"
                        "skyfunc glow ground_glow\n0\n0\n4 1 0.8 0.5 0\n"
                        "ground_glow source ground\n0\n0\n4 0 0 -1 180\n";

void daemon_upload_room(struct daemon *daemon, char ret_id[65])
{
    const struct upload_file files[] = {{"room.rad", room_scene, strlen(room_scene), false},
                                        {"sky.rad", room_sky, strlen(room_sky), false}};
    struct reply reply;
    daemon_upload(daemon, files, 2, NULL, &reply);
    if (reply.status != 200 && reply.status != 201)
        fail_msg("the room was refused: %s", reply.body);
    snprintf(ret_id, 65, "%s", reply_text(&reply, "id"));
    assert_int_equal(strlen(ret_id), 64);
    reply_done(&reply);
}

void daemon_submit(struct daemon *daemon, const char *scene, long photons, int seed,
                   const char *view, char ret_path[80])
{
    char text[1024], views[256] = "";
    struct reply reply;
    if (view)
        snprintf(views, sizeof views,
                 ",\"views\":[{\"name\":\"%s\",\"view\":\"-vtv -vp 2 4.5 1.6 -vd 0 -1 0 -vu 0 0 1 "
                 "-vh 70 -vv 55\",\"width\":32,\"height\":24}]",
                 view);
    snprintf(text, sizeof text,
             "{\"kind\":\"render\",\"scene\":\"%s\",\"seed\":%d,\"technique\":\"gather\","
             "\"photons\":{\"global\":%ld,\"caustic\":%ld},\"gather_samples\":64,"
             "\"sensors\":[[2,1,0.8,0,0,1],[2,4,0.8,0,0,1]]%s}",
             scene, seed, photons, photons / 2, views);
    daemon_post_json(daemon, "/v1/jobs", text, &reply);
    if (reply.status != 202)
        fail_msg("the job was refused: %s", reply.body);
    const char *location = reply_header(&reply, "Location");
    assert_non_null(location);
    snprintf(ret_path, 80, "%s", location);
    reply_done(&reply);
}

void daemon_cancel(struct daemon *daemon, const char *path, struct reply *ret_reply)
{
    char cancel[96];
    snprintf(cancel, sizeof cancel, "%s/cancel", path);
    daemon_request(daemon, "POST", cancel, NULL, "", 0, NULL, ret_reply);
}

void daemon_wait(struct daemon *daemon, const char *path, double seconds, struct reply *ret_reply)
{
    /* The limit is to detect a hang; five times the expected time allows for busy machines and
     * sanitizers. */
    const double until = now_s() + 5 * seconds;
    for (;;) {
        daemon_get(daemon, path, ret_reply);
        assert_int_equal(ret_reply->status, 200);
        const char *state = reply_text(ret_reply, "state");
        if (strcmp(state, "succeeded") == 0 || strcmp(state, "failed") == 0 ||
            strcmp(state, "cancelled") == 0)
            return;
        if (now_s() > until)
            fail_msg("%s is still %s after %.0f s: %s", path, state, 5 * seconds, ret_reply->body);
        reply_done(ret_reply);
        nap(0.05);
    }
}

void daemon_wait_running(struct daemon *daemon, const char *path, double percent)
{
    const double until = now_s() + 300;
    for (bool there = false; !there;) {
        struct reply reply;
        daemon_get(daemon, path, &reply);
        const char *state = reply_text(&reply, "state");
        there = strcmp(state, "running") == 0 && reply_number(&reply, "percent") > percent;
        if (!there && (now_s() > until || (strcmp(state, "running") && strcmp(state, "queued"))))
            fail_msg("%s does not run: %s", path, reply.body);
        reply_done(&reply);
        nap(0.02);
    }
}

void daemon_wait_status(struct daemon *daemon, const char *path, long status)
{
    const double until = now_s() + 120;
    for (long last = 0; last != status;) {
        struct reply reply;
        daemon_get(daemon, path, &reply);
        last = reply.status;
        reply_done(&reply);
        if (last != status && now_s() > until)
            fail_msg("%s has status %ld for two minutes, not %ld", path, last, status);
        nap(0.005);
    }
}
