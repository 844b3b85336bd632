#include "process/hangup.h"

#include <signal.h>

/* A signal's handler has no argument but its number. */
static uv_async_t hangup;

static void on_signal(int signum)
{
    (void)signum;
    uv_async_send(&hangup); /* async-signal-safe */
}

static void handle_by(void (*handler)(int signum))
{
    struct sigaction action = {.sa_handler = handler, .sa_flags = SA_RESTART};
    sigemptyset(&action.sa_mask);
    sigaction(SIGHUP, &action, NULL);
}

void orl_hangup_ignore(void)
{
    handle_by(SIG_IGN);
}

int orl_hangup_heed(uv_loop_t *loop, uv_async_cb on_hangup, void *data)
{
    const int rc = uv_async_init(loop, &hangup, on_hangup);
    if (rc)
        return rc;
    hangup.data = data;
    handle_by(on_signal);
    return 0;
}

void orl_hangup_stop(void)
{
    handle_by(SIG_IGN);
    uv_close((uv_handle_t *)&hangup, NULL);
}
