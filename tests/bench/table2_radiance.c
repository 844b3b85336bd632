/* Radiance's rows: the same files, photon counts and view through its own programs. */
#include <stdlib.h>
#include <string.h>

#include "bench/radiance.h"
#include "bench/table2.h"

struct recipe {
    const char *name, *paper;
    bool uses[TABLE_KINDS];
    const char *sensors, *image; /* options */
};
static const struct recipe recipes[] = {
    {"global and caustic maps",
     "GCx",
     {true, true, false},
     "-ab 1 -aa 0 -ad 4096",
     "-ab 1 -aa .15 -ar 64 -ad 512 -as 256"},
    {"precomputed and caustic maps",
     "xCP",
     {false, true, true},
     "-ab 1 -aa 0 -ad 4096",
     "-ab 1 -aa .15 -ar 64 -ad 512 -as 256"},
    {"precomputed map",
     "xxP",
     {false, false, true},
     "-ab 1 -aa 0 -ad 4096",
     "-ab 1 -aa .15 -ar 64 -ad 512 -as 256"},
    {"global map, direct", "-", {true, false, false}, "-ab -1", "-ab -1"},
    {"backward",
     "xxx",
     {false, false, false},
     "-ab 4 -aa .1 -ar 128 -ad 4096 -as 2048 -lw 1e-4",
     "-ab 4 -aa .1 -ar 128 -ad 4096 -as 2048"},
};
enum { RECIPES = sizeof recipes / sizeof *recipes };

static void measure_row(struct table *table, const struct radiance *radiance,
                        const struct recipe *recipe, const double map_s[])
{
    struct table_row *row = &table->rows[table->n_rows++];
    char use[256], options[512];
    double lx[OFFICE_SENSORS], *luminances;
    *row = (struct table_row){.name = recipe->name, .paper = recipe->paper, .radiance = true};
    fprintf(stderr, "  Radiance: %s\n", recipe->name);
    for (int kind = 0; kind < TABLE_KINDS; kind++)
        row->photon_s[kind] = recipe->uses[kind] ? map_s[kind] : 0;
    radiance_use_maps(recipe->uses, use);
    snprintf(options, sizeof options, "%s%s", recipe->sensors, use);
    row->sensors_s = radiance_sensors(radiance, options, lx).cpu_s;
    snprintf(options, sizeof options, "%s%s", recipe->image, use);
    row->image_s = radiance_image(radiance, options, table->reference.width,
                                  table->reference.height, &luminances)
                       .cpu_s;
    table_judge(table, lx, luminances, row);
    free(luminances);
}

void table_add_radiance(struct table *table)
{
    struct radiance radiance;
    const char *missing = radiance_missing();
    double map_s[TABLE_KINDS];
    if (!table->radiance)
        return;
    if (missing) {
        printf("  (no %s on PATH: Radiance's rows are left out)\n", missing);
        return;
    }
    radiance_open(&radiance, &table->office, "radiance");
    fprintf(stderr, "  Radiance: maps\n");
    for (int kind = 0; kind < TABLE_KINDS; kind++)
        map_s[kind] = radiance_make_map(&radiance, (enum radiance_map)kind, table->photons).cpu_s;
    for (int i = 0; i < RECIPES; i++)
        if (recipes[i].uses[TABLE_GLOBAL] || recipes[i].uses[TABLE_PRECOMPUTED] ||
            table->radiance_backward)
            measure_row(table, &radiance, &recipes[i], map_s);
}
