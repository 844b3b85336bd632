#include "process/signal_stack.h"

#include <signal.h>
#include <stdbool.h>
#include <stddef.h>

#include "process/sanitized.h"

/* Space for a signal frame with all vector registers (up to 11 kB) and for unwinding. */
static _Thread_local _Alignas(16) char stack[32 << 10];
static _Thread_local bool installed;

void orl_signal_stack_install(void)
{
    const stack_t other = {.ss_sp = stack, .ss_size = sizeof stack};
    if (!ORL_SANITIZED && !installed)
        installed = sigaltstack(&other, NULL) == 0;
}
