/*
 * A separate stack for the handler of fatal signals, so that a stack overflow can be reported.
 *
 * Threads: each thread that the daemon starts, or runs work on, calls this once for itself; further
 * calls do nothing. Sanitized builds keep the sanitizer's own stack.
 */
#ifndef ORL_SERVER_PROCESS_SIGNAL_STACK_H
#define ORL_SERVER_PROCESS_SIGNAL_STACK_H

void orl_signal_stack_install(void);

#endif
