/* cmocka needs these headers first. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>

#include "support/references.h"

void reference_row_within(struct references *set, const char *place, double reference, double found,
                          double tolerance)
{
    const double off = reference != 0 ? found / reference - 1 : found == 0 ? 0 : INFINITY;
    const bool ok = fabs(off) <= tolerance; /* false for NaN */
    const char *path = getenv("ORIEL_REFERENCE_TABLE");
    FILE *table = path ? fopen(path, "a") : NULL;
    if (table) {
        fprintf(table, "%-36s | %-46s | %11.5g | %11.5g | %+8.3f | %6.2f | %s\n", set->name, place,
                reference, found, 100 * off, 100 * tolerance, ok ? "ok" : "FAIL");
        fclose(table);
    }
    if (!ok && set->failed++ == 0)
        snprintf(set->first, sizeof set->first, "%s: %.6g, not %.6g (%+.3f %%)", place, found,
                 reference, 100 * off);
    set->rows++;
    set->sum += off;
    set->worst = fmax(set->worst, fabs(off));
}

void reference_row(struct references *set, const char *place, double reference, double found)
{
    reference_row_within(set, place, reference, found, set->tolerance);
}

void references_end(const struct references *set)
{
    print_message("# %s: %d rows, worst %.3f %%, mean %+.3f %%\n", set->name, set->rows,
                  100 * set->worst, 100 * set->sum / set->rows);
    if (set->rows == 0)
        fail_msg("%s: no rows", set->name);
    if (set->failed > 0)
        fail_msg("%s: %d of %d rows are off; first %s", set->name, set->failed, set->rows,
                 set->first);
}
