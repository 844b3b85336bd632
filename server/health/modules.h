/*
 * Finds the program or library that contains a code address, for fault handlers, which may call
 * almost no functions.
 *
 * Threads: list once, before any handler may run; look up from any.
 */
#ifndef ORL_SERVER_HEALTH_MODULES_H
#define ORL_SERVER_HEALTH_MODULES_H

#include <stdint.h>

/* Lists the modules loaded now. Modules loaded later are not known. */
void orl_modules_list(void);

/* Returns the module's name (borrowed); *ret_offset is the address as an offset into it, as
 * addr2line takes it. NULL: the address is in no module. */
const char *orl_module_of(uintptr_t address, uintptr_t *ret_offset);

#endif
