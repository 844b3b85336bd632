/*
 * A real daemon for a test: $ORIEL_BUILD/orield (default build/orield) as a child process, on a
 * free port, with a temporary data folder, which does not wait for jobs when it stops; and HTTP
 * requests to it by libcurl.
 *
 * Everything here fails the running test (cmocka) on error. Replies are owned: reply_done. The
 * child dies with the test program, however that ends.
 */
#ifndef ORL_TESTS_SUPPORT_DAEMON_H
#define ORL_TESTS_SUPPORT_DAEMON_H

#include <jansson.h>
#include <stdbool.h>
#include <stddef.h>
#include <sys/types.h>

struct daemon {
    pid_t pid;
    char url[64];  /* "http://127.0.0.1:40123" */
    char root[64]; /* data folder */
    char ca[80];   /* certificate to trust for an HTTPS daemon */
    void *curl;    /* one connection, kept alive */
};

struct reply {
    long status;
    char *headers; /* as received */
    char *body;    /* NUL-terminated */
    size_t size;
    json_t *json; /* the body if it is JSON */
    double seconds;
};

/* Starts a daemon with a new data folder; extra (may be NULL) are further arguments, ending with
 * NULL. */
void daemon_start(struct daemon *daemon, const char *const *extra);
/* Starts it again on its data folder, after daemon_end. */
void daemon_restart(struct daemon *daemon, const char *const *extra);
/* Sends the signal and waits. Returns the exit status, or -1 if a signal ended it. */
int daemon_end(struct daemon *daemon, int signum); /* -1 also if none runs */
/* Waits for a daemon that has already been asked to end; returns as daemon_end. */
int daemon_wait_end(struct daemon *daemon);
/* Ends it by SIGTERM if it runs, expects status 0, and removes its folder. */
void daemon_remove(struct daemon *daemon);
/* Returns a value of /proc/<pid>/status in MiB: "VmHWM", the peak so far; "VmRSS", the current
 * size. */
double daemon_memory_mb(const struct daemon *daemon, const char *name);
/* Counts the files below a subfolder of the data folder ("blobs"). */
size_t daemon_count_files(const struct daemon *daemon, const char *folder);
/* Waits until there are none: the daemon may remove files after it has answered. */
void daemon_expect_no_files(const struct daemon *daemon, const char *folder);

/* Sends a request. method "GET", "POST", ...; body and type may be NULL; header may be NULL or one
 * line. */
void daemon_request(struct daemon *daemon, const char *method, const char *path, const char *type,
                    const void *body, size_t size, const char *header, struct reply *ret_reply);
/* Opens a plain TCP connection to it, for raw bytes; the caller closes it. */
int daemon_dial(const struct daemon *daemon);
void daemon_get(struct daemon *daemon, const char *path, struct reply *ret_reply);
void daemon_post_json(struct daemon *daemon, const char *path, const char *json,
                      struct reply *ret_reply);

struct upload_file {
    const char *name, *data;
    size_t size;
    bool resource; /* true: sent as a part named "resource" */
};
/* Posts multipart/form-data to /v1/scenes; bsdfs may be NULL. */
void daemon_upload(struct daemon *daemon, const struct upload_file *files, size_t count,
                   const char *bsdfs, struct reply *ret_reply);

void reply_done(struct reply *reply);
/* Returns a member of the reply's JSON by a path of names and indices, "maps.0.cached"; NULL:
 * absent. */
const json_t *reply_at(const struct reply *reply, const char *path);
const char *reply_text(const struct reply *reply, const char *path); /* "" if absent */
double reply_number(const struct reply *reply, const char *path);    /* NAN if absent */
/* Returns a header's value, or NULL; valid until the next call. */
const char *reply_header(const struct reply *reply, const char *name);

/* ---- Jobs ----------------------------------------------------------------------------------- */

/* Uploads a glazed room under a sunny sky and returns its id. */
void daemon_upload_room(struct daemon *daemon, char ret_id[65]);
/*
 * Submits a job of that scene: two sensors and, if a name is given, a 32x24 view. Returns its path.
 */
void daemon_submit(struct daemon *daemon, const char *scene, long photons, int seed,
                   const char *view, char ret_path[80]);
void daemon_cancel(struct daemon *daemon, const char *path, struct reply *ret_reply);
/* Polls until the job's state is one of the last three, for at most that many seconds. */
void daemon_wait(struct daemon *daemon, const char *path, double seconds, struct reply *ret_reply);
/* Polls until the job runs and has passed that percentage. */
void daemon_wait_running(struct daemon *daemon, const char *path, double percent);
/* Polls until a GET of PATH has that status, for at most two minutes. */
void daemon_wait_status(struct daemon *daemon, const char *path, long status);

extern const char room_scene[], room_sky[];

/* ---- For cmocka's set-up and tear-down (set_ups.c) ------------------------------------------- */

/* An empty daemon: struct daemon. */
int daemon_set_up(void **state);
int daemon_tear_down(void **state);

/* A daemon with the room as its scene. */
struct daemon_room {
    struct daemon daemon;
    char scene[65];
};
int daemon_room_set_up(void **state);
/* The daemon has the room without its sky, and a weather file, place.wea. */
int daemon_weather_set_up(void **state);
int daemon_room_tear_down(void **state); /* for both fixtures */

#endif
