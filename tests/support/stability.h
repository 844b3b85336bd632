/*
 * The hard cases, by number: the invariant, the measured value, and its bound. Each case is a
 * cmocka test in tests/stability/ that ends in one or several rows.
 *
 * stability_row fails the test if measured is NaN or above the bound. If the variable
 * ORIEL_STABILITY_TABLE names a file, the row is also appended there: `make stability` prints these
 * as a table. stability_full returns true if the long form of a case (minutes) is requested, as by
 * `make stability` but not by `make check`.
 */
#ifndef ORL_TESTS_STABILITY_H
#define ORL_TESTS_STABILITY_H

#include <stdbool.h>

/* Requires measured <= bound. Both are in the invariant's unit, which its text names. */
void stability_row(int number, const char *name, const char *invariant, double measured,
                   double bound);

/* Records an exact statement: measured 0 if it holds, otherwise 1; bound 0. */
void stability_holds(int number, const char *name, const char *invariant, bool holds);

bool stability_full(void);

#endif
