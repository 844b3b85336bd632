/*
 * The hard cases, by number: what must hold (the invariant), what was measured, and the bound it is
 * held against. Each case is a cmocka test in tests/stability/ that ends in one row or several.
 *
 * stability_row fails the test when measured is not a number or is above the bound. When the
 * variable ORIEL_STABILITY_TABLE names a file, the row is also appended there: `make stability`
 * prints these as a table. stability_full tells whether the long form of a case (minutes) is asked
 * for, which `make stability` does and `make check` does not.
 */
#ifndef ORL_TESTS_STABILITY_H
#define ORL_TESTS_STABILITY_H

#include <stdbool.h>

/* measured <= bound is wanted. Both in the invariant's own unit, which its text names. */
void stability_row(int number, const char *name, const char *invariant, double measured,
                   double bound);

/* The same for an exact statement: measured 0 against bound 0 when it holds, 1 when not. */
void stability_holds(int number, const char *name, const char *invariant, bool holds);

bool stability_full(void);

#endif
