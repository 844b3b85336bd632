/*
 * Which program or library an address of code lies in, for who may call next to nothing: a handler
 * of a fault.
 *
 * Threads: listed once, before any handler may run; looked up from any.
 */
#ifndef ORL_SERVER_HEALTH_MODULES_H
#define ORL_SERVER_HEALTH_MODULES_H

#include <stdint.h>

/* Those that are loaded now; what is loaded later is not known. */
void orl_modules_list(void);

/* The module's name, borrowed, and the address as an offset into it, which addr2line takes; NULL:
 * it is in none. */
const char *orl_module_of(uintptr_t address, uintptr_t *ret_offset);

#endif
