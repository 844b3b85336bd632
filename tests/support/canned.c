#include "support/canned.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdint.h>

#include <cmocka.h>
#include <microhttpd.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_REQUESTS = 32 };

size_t canned_asked(const struct canned_daemon *f, const char *line)
{
    size_t count = 0;

    for (size_t i = 0; i < f->n_requests; i++)
        count += strcmp(f->requests[i].line, line) == 0;
    return count;
}

/* Returns the answer to a request that has just been counted. */
static const struct canned *find_answer(const struct canned_daemon *f, const char *line)
{
    const struct canned *found = NULL;
    size_t turn = canned_asked(f, line);

    for (const struct canned *c = f->canned; c->request && turn > 0; c++) {
        if (strcmp(c->request, line) == 0) {
            found = c;
            turn--;
        }
    }
    return found;
}

static enum MHD_Result answer_locked(struct canned_daemon *f, struct MHD_Connection *connection,
                                     const char *url, const char *method, const char *data,
                                     size_t *data_size, void **context)
{
    struct canned_request *request = *context;
    const struct canned *canned;
    struct MHD_Response *response;
    enum MHD_Result rc;

    if (!request) {
        if (f->n_requests == MAX_REQUESTS)
            return MHD_NO;
        request = *context = &f->requests[f->n_requests++];
        snprintf(request->line, sizeof request->line, "%s %s", method, url);
        return MHD_YES;
    }
    if (*data_size) {
        const size_t room = CANNED_BODY_MAX - 1 - request->size;
        const size_t taken = *data_size < room ? *data_size : room;

        memcpy(request->body + request->size, data, taken);
        request->size += taken;
        *data_size = 0;
        return MHD_YES;
    }
    canned = find_answer(f, request->line);
    response = MHD_create_response_from_buffer(canned ? strlen(canned->body) : 0,
                                               (void *)(uintptr_t)(canned ? canned->body : ""),
                                               MHD_RESPMEM_MUST_COPY);
    rc = MHD_queue_response(connection, canned ? canned->status : 404, response);
    MHD_destroy_response(response);
    return rc;
}

static enum MHD_Result answer(void *arg, struct MHD_Connection *connection, const char *url,
                              const char *method, const char *version, const char *data,
                              size_t *data_size, void **context)
{
    struct canned_daemon *f = arg;
    enum MHD_Result rc;

    (void)version;
    pthread_mutex_lock(&f->lock);
    rc = answer_locked(f, connection, url, method, data, data_size, context);
    pthread_mutex_unlock(&f->lock);
    return rc;
}

/* Runs the command. Locking the mutex afterwards makes the daemon thread's writes visible to this
 * thread. */
void canned_run_args(struct canned_daemon *f, const struct canned *canned, const char *const *args)
{
    pthread_mutex_lock(&f->lock);
    f->canned = canned;
    pthread_mutex_unlock(&f->lock);
    cli_run(args, &f->result);
    pthread_mutex_lock(&f->lock);
    pthread_mutex_unlock(&f->lock);
}

int canned_set_up(void **state)
{
    struct canned_daemon *f = calloc(1, sizeof *f);
    const union MHD_DaemonInfo *info;

    pthread_mutex_init(&f->lock, NULL);
    f->requests = calloc(MAX_REQUESTS, sizeof *f->requests);
    cli_make_folder(f->folder);
    f->daemon =
        MHD_start_daemon(MHD_USE_INTERNAL_POLLING_THREAD, 0, NULL, NULL, answer, f, MHD_OPTION_END);
    assert_non_null(f->daemon);
    info = MHD_get_daemon_info(f->daemon, MHD_DAEMON_INFO_BIND_PORT);
    assert_non_null(info);
    snprintf(f->url, sizeof f->url, "http://127.0.0.1:%u", (unsigned)info->port);
    *state = f;
    return 0;
}

int canned_tear_down(void **state)
{
    struct canned_daemon *f = *state;

    if (f->daemon)
        MHD_stop_daemon(f->daemon);
    cli_remove_folder(f->folder);
    free(f->requests);
    free(f);
    return 0;
}

void canned_says(const char *text, const char *wanted)
{
    if (!strstr(text, wanted))
        fail_msg("expected \"%s\" in:\n%s", wanted, text);
}

void canned_run(struct canned_daemon *f, const struct canned *canned, const char *command,
                const char *operand, const char *output)
{
    const char *args[8] = {command};
    int n = 1;

    if (operand)
        args[n++] = operand;
    if (output) {
        args[n++] = "-o";
        args[n++] = output;
    }
    args[n++] = "--server";
    args[n++] = f->url;
    canned_run_args(f, canned, args);
}

const struct canned_request *canned_find(const struct canned_daemon *f, const char *line)
{
    for (size_t i = 0; i < f->n_requests; i++)
        if (strcmp(f->requests[i].line, line) == 0)
            return &f->requests[i];
    fail_msg("no request \"%s\"", line);
    return NULL;
}
