#include "support/polygons.h"

#include <malloc.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

const char polygons_materials[] = "void plastic m0 0 0 5 .6 .55 .5 0 0\n"
                                  "void plastic m1 0 0 5 .3 .35 .3 .02 .1\n"
                                  "void metal m2 0 0 5 .7 .7 .7 .8 .1\n"
                                  "void trans m3 0 0 7 .5 .5 .5 0 0 .3 0\n"
                                  "void plastic m4 0 0 5 .2 .2 .4 0 0\n"
                                  "void glass m5 0 0 3 .9 .9 .9\n";

/*
 * Two rows of parallelograms, then one of pairs of triangles: equal numbers of each. A corner's
 * height is the sum of one value of its row and one of its column, so that four corners lie in a
 * plane.
 */
enum {
    COLUMNS = 1000,
    MATERIALS = 5,
    A_MATERIAL = 64,
    PANES = 1024,
    BAND_ROWS = 3,
    BAND = 4 * COLUMNS,
    STOREY_BANDS = 250
};
enum { CELL_MM = 100, STOREY_MM = 4000, MOST_LETTERS = 160 };

/* Returns 0 to 31 mm, by a hash. */
static int bump(uint32_t i, uint32_t salt)
{
    uint32_t x = i * 2654435761U + salt * 40503U;
    x = (x ^ (x >> 15)) * 2246822519U;
    return (int)(x >> 27);
}

struct cell {
    int row, column, storey;
};

static char *write_number(char *at, int mm)
{
    return at + sprintf(at, " %d.%03d", mm / 1000, mm % 1000);
}

/* Writes the corner `step` cells to the right and up; apart: cells are a millimetre from each
 * other. */
static char *write_corner(char *at, const struct cell *c, const int step[2], int apart)
{
    const int x = (c->column + step[0]) * CELL_MM - apart * step[0];
    const int y = (c->row + step[1]) * CELL_MM - apart * step[1];
    const int z = c->storey * STOREY_MM + bump((uint32_t)(c->row + step[1]), 1) +
                  bump((uint32_t)(c->column + step[0]), 2);
    return write_number(write_number(write_number(at, x), y), z + apart * (c->column & 1));
}

static char *write_polygon(char *at, size_t index, bool apart)
{
    static const int corners[3][4][2] = {
        {{0, 0}, {1, 0}, {1, 1}, {0, 1}}, {{0, 0}, {1, 0}, {1, 1}}, {{0, 0}, {1, 1}, {0, 1}}};
    const size_t band = index / BAND, in_band = index % BAND;
    const bool flat = in_band < 2 * COLUMNS;
    const size_t half = flat ? 0 : 1 + in_band % 2;
    const size_t row = flat ? in_band / COLUMNS : 2;
    const struct cell cell = {
        .row = (int)(band % STOREY_BANDS * BAND_ROWS + row),
        .column = (int)(flat ? in_band % COLUMNS : (in_band - 2 * COLUMNS) / 2),
        .storey = (int)(band / STOREY_BANDS),
    };
    const int n = flat ? 4 : 3;
    const size_t patch = index / A_MATERIAL,
                 material = patch % PANES ? patch % MATERIALS : MATERIALS;
    at += sprintf(at, "m%zu polygon p%zu 0 0 %d", material, index, 3 * n);
    for (int i = 0; i < n; i++)
        at = write_corner(at, &cell, corners[half][i], apart ? 1 + (half == 2) : 0);
    *at++ = '\n';
    return at;
}

char *polygons_text(size_t first, size_t count, bool apart, size_t *ret_size)
{
    char *const text = malloc(count * MOST_LETTERS + 1);
    char *at = text;
    for (size_t i = first; text && i < first + count; i++)
        at = write_polygon(at, i, apart);
    if (text)
        *at = '\0';
    *ret_size = (size_t)(at - text);
    return text;
}

size_t polygons_resident_bytes(void)
{
    unsigned long all = 0, resident = 0;
    malloc_trim(0);
    FILE *const f = fopen("/proc/self/statm", "r");
    if (!f)
        return 0;
    if (fscanf(f, "%lu %lu", &all, &resident) != 2)
        resident = 0;
    fclose(f);
    return resident * (size_t)sysconf(_SC_PAGESIZE);
}
