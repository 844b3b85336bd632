/*
 * Values compared with references, row by row: the case, the place, the reference and the result. A
 * test fills a set of rows and ends it; a row off by more than its tolerance fails the test at the
 * end, after all rows have been recorded.
 *
 * If the variable ORIEL_REFERENCE_TABLE names a file, rows are also appended to it: `make cie171`
 * and `make oracles` print these as a table. stability_full selects the long form, as for the hard
 * cases.
 */
#ifndef ORL_TESTS_REFERENCES_H
#define ORL_TESTS_REFERENCES_H

struct references {
    const char *name;  /* name of the case */
    double tolerance;  /* relative: 0.01 for 1 % */
    int rows, failed;  /* this and the following fields start at 0 */
    double worst, sum; /* largest absolute relative difference, and the sum of the signed ones */
    char first[160];   /* the first row that failed */
};

/* A reference of 0 requires exactly 0. */
void reference_row(struct references *set, const char *place, double reference, double found);

/* Adds a row with its own tolerance. */
void reference_row_within(struct references *set, const char *place, double reference, double found,
                          double tolerance);

/* Prints one summary line to the test's output; fails the test if a row failed. */
void references_end(const struct references *set);

#endif
