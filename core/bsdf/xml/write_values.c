/* Writes numbers in a file. A matrix has a line per direction out; directions in run along the
 * line. */
#include "bsdf/xml/write_xml.h"

#include <stdlib.h>

void orl_write_value(FILE *out, float value)
{
    char text[32];
    int digits = 6;
    do {
        snprintf(text, sizeof text, "%.*g", digits, (double)value);
    } while (digits++ < 9 && strtof(text, NULL) != value);
    fputs(text, out);
}

void orl_bsdf_write_matrix(const struct orl_matrix *matrix, FILE *out)
{
    const int n_a = matrix->basis[ORL_AXIS_A].n_cells, n_b = matrix->basis[ORL_AXIS_B].n_cells;
    for (int b = 0; b < n_b; b++) {
        for (int a = 0; a < n_a; a++) {
            orl_write_value(out, matrix->values[(size_t)a * (size_t)n_b + (size_t)b]);
            fputs(a + 1 < n_a ? ",\t" : ",\n", out);
        }
    }
}
