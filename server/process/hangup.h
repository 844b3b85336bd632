/*
 * SIGHUP, by which files are read anew. The signal has no default effect while the process starts
 * and stops: libuv's own handle would restore it when it is closed, and a late SIGHUP would end the
 * process in the midst of an orderly stop.
 *
 * Threads: the loop's. One loop of a process.
 */
#ifndef ORL_SERVER_PROCESS_HANGUP_H
#define ORL_SERVER_PROCESS_HANGUP_H

#include <uv.h>

/* From now on the signal is ignored, until it is heeded. */
void orl_hangup_ignore(void);

/* Calls on_hangup on the loop after one signal or several; data is the handle's. */
int orl_hangup_heed(uv_loop_t *loop, uv_async_cb on_hangup, void *data);

/* Ignores it again and closes the handle. */
void orl_hangup_stop(void);

#endif
