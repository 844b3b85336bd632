/* cmocka needs these headers first. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "support/stability.h"

void stability_row(int number, const char *name, const char *invariant, double measured,
                   double bound)
{
    const bool ok = isfinite(measured) && measured <= bound;
    const char *path = getenv("ORIEL_STABILITY_TABLE");
    FILE *table = path ? fopen(path, "a") : NULL;
    if (table) {
        fprintf(table, "%2d | %-34s | %-62s | %10.3g | %10.3g | %s\n", number, name, invariant,
                measured, bound, ok ? "ok" : "FAIL");
        fclose(table);
    }
    if (!ok)
        fail_msg("case %d, %s: %s: measured %g, bound %g", number, name, invariant, measured,
                 bound);
}

void stability_holds(int number, const char *name, const char *invariant, bool holds)
{
    stability_row(number, name, invariant, holds ? 0 : 1, 0);
}

bool stability_full(void)
{
    const char *full = getenv("ORIEL_STABILITY_FULL");
    return full && strcmp(full, "1") == 0;
}
