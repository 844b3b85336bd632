/*
 * Figures against references, row by row: what a case is, where, what must come out, what did. A
 * test fills a set of rows and ends it; a row off by more than its tolerance fails the test there,
 * after all rows have been written down.
 *
 * When the variable ORIEL_REFERENCE_TABLE names a file, rows are also appended to it: `make cie171`
 * and `make oracles` print these as a table. The long form is asked for as for the hard cases:
 * stability_full.
 */
#ifndef ORL_TESTS_REFERENCES_H
#define ORL_TESTS_REFERENCES_H

struct references {
    const char *name;  /* of the case */
    double tolerance;  /* relative: 0.01 for 1 % */
    int rows, failed;  /* start at 0, as does the rest */
    double worst, sum; /* of the relative differences: largest size, and all with their sign */
    char first[160];   /* the first row that failed */
};

/* A reference of 0 wants exactly 0. */
void reference_row(struct references *set, const char *place, double reference, double found);

/* The same with a tolerance of its own. */
void reference_row_within(struct references *set, const char *place, double reference, double found,
                          double tolerance);

/* Says how it went in one line of the test's output; fails the test if a row failed. */
void references_end(const struct references *set);

#endif
