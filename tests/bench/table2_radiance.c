/* Radiance's rows: the same files, photon counts and view through its own programs. */
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "bench/table2.h"
#include "run/stages.h"

enum { MOST_ARGUMENTS = 64, COMMAND_BYTES = 1024 };

/* The last three are started by oconv, for the scene's command lines. */
static const char *const programs[] = {"oconv", "mkpmap", "rtrace",   "rpict",
                                       "xform", "genbox", "gendaylit"};
enum { PROGRAMS = sizeof programs / sizeof *programs };

/* What the scene's panes are made of: its photon ports. Their panes face the room. */
static const char ports[] = "-apo0 panel_mat -apo0 clear_glass";
static const char sensors_name[] = "sensors.pts", scene_name[] = "office.oct";

struct radiance {
    struct table *table;
    char folder[BENCH_PATH + 16];
};

/* A map, how it is made, and how it is read. */
struct map {
    const char *file, *make, *read;
    const char *more; /* options of mkpmap */
    enum table_kind kind;
};
static const struct map maps[TABLE_KINDS] = {
    {"global.pm", "-apg", "-ap global.pm 50", "", TABLE_GLOBAL},
    {"caustic.pm", "-apc", "-ap caustic.pm 50", "", TABLE_CAUSTIC},
    {"precomputed.pm", "-app", "-ap precomputed.pm 1", "-apP 0.25", TABLE_PRECOMPUTED},
};

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

static bool on_path(const char *program)
{
    const char *path = getenv("PATH");
    while (path && *path) {
        const size_t length = strcspn(path, ":");
        char file[4096];
        snprintf(file, sizeof file, "%.*s/%s", (int)length, path, program);
        if (length > 0 && access(file, X_OK) == 0)
            return true;
        path += length + (path[length] == ':');
    }
    return false;
}

/* A command in words, none of which holds a blank; no shell reads it. Returns its seconds. */
static double command(const struct radiance *r, const char *input, const char *output,
                      const char *format, ...) __attribute__((format(printf, 4, 5)));
static double command(const struct radiance *r, const char *input, const char *output,
                      const char *format, ...)
{
    char text[COMMAND_BYTES], failed[COMMAND_BYTES + 32], *rest = NULL;
    const char *argv[MOST_ARGUMENTS + 1] = {NULL};
    double seconds;
    size_t n = 0;
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    snprintf(failed, sizeof failed, "failed: %s", text);
    for (char *word = strtok_r(text, " ", &rest); word && n < MOST_ARGUMENTS;
         word = strtok_r(NULL, " ", &rest))
        argv[n++] = word;
    if (bench_spawn(argv, r->folder, input, output, &seconds) != 0)
        bench_fail(failed, NULL);
    return seconds;
}

/* rtrace reads no comments: the sensors again, in bare numbers. */
static void write_sensors(const struct radiance *r)
{
    const struct orl_files *files = &r->table->office.files;
    char path[BENCH_PATH + 64];
    struct orl_sensor *sensors;
    struct orl_error err = {0};
    struct orl_file file;
    size_t n;
    if (files->open(files->ctx, office_sensors, &file, &err) < 0 ||
        orl_sensors_parse(office_sensors, file.data, file.size, &sensors, &n, &err) < 0)
        bench_fail("the office's sensors", &err);
    files->close(files->ctx, &file);
    snprintf(path, sizeof path, "%s/%s", r->folder, sensors_name);
    FILE *out = fopen(path, "w");
    if (!out)
        bench_fail("cannot write sensors for Radiance", NULL);
    for (size_t i = 0; i < n; i++)
        fprintf(out, "%.9g %.9g %.9g %.9g %.9g %.9g\n", sensors[i].position.x,
                sensors[i].position.y, sensors[i].position.z, sensors[i].direction.x,
                sensors[i].direction.y, sensors[i].direction.z);
    if (fclose(out) != 0)
        bench_fail("cannot write sensors for Radiance", NULL);
    free(sensors);
}

/* Irradiance in three channels a line, to lux. */
static void read_lux(const struct radiance *r, const char *name, double lx[OFFICE_SENSORS])
{
    char path[BENCH_PATH + 64];
    snprintf(path, sizeof path, "%s/%s", r->folder, name);
    FILE *in = fopen(path, "r");
    for (int i = 0; i < OFFICE_SENSORS; i++) {
        struct orl_rgb c;
        if (!in || fscanf(in, "%lf %lf %lf", &c.r, &c.g, &c.b) != 3)
            bench_fail("rtrace wrote no irradiances", NULL);
        lx[i] = ORL_EFFICACY_LM_PER_W * orl_luma(c);
    }
    fclose(in);
}

/* The scene's files in one folder, and its octree. */
static void prepare(struct radiance *r)
{
    const struct office *office = &r->table->office;
    static const char *const beside[] = {"upper_pane.rad"};
    char list[256] = "", panel[BENCH_PATH + 16];
    snprintf(r->folder, sizeof r->folder, "%s/radiance", office->folder);
    snprintf(panel, sizeof panel, "%s/lcp.xml", office->folder);
    const char *const make[] = {"mkdir", r->folder, NULL};
    const char *const panel_here[] = {"cp", panel, r->folder, NULL};
    int status = bench_spawn(make, NULL, NULL, NULL, NULL);
    status |= bench_spawn(panel_here, NULL, NULL, NULL, NULL);
    for (int i = 0; i <= OFFICE_FILES; i++) {
        const char *name = i < OFFICE_FILES ? office_names[i] : beside[0];
        char path[BENCH_PATH];
        snprintf(path, sizeof path, "%s/%s", office_source, name);
        const char *const copy[] = {"cp", path, r->folder, NULL};
        status |= bench_spawn(copy, NULL, NULL, NULL, NULL);
        if (i < OFFICE_FILES)
            snprintf(list + strlen(list), sizeof list - strlen(list), " %s", name);
    }
    if (status != 0)
        bench_fail("cannot copy the office for Radiance", NULL);
    write_sensors(r);
    command(r, NULL, scene_name, "oconv%s", list);
}

static void measure(struct radiance *r, const struct recipe *recipe, const double map_s[])
{
    struct table *table = r->table;
    struct table_row *row = &table->rows[table->n_rows++];
    char use[256] = "", image[BENCH_PATH + 64];
    double lx[OFFICE_SENSORS];
    *row = (struct table_row){.name = recipe->name, .paper = recipe->paper, .radiance = true};
    fprintf(stderr, "  Radiance: %s\n", recipe->name);
    for (int kind = 0; kind < TABLE_KINDS; kind++) {
        if (!recipe->uses[kind])
            continue;
        row->photon_s[kind] = map_s[kind];
        snprintf(use + strlen(use), sizeof use - strlen(use), " %s", maps[kind].read);
    }
    row->sensors_s = command(r, sensors_name, "sensors.out", "rtrace -h -I %s%s %s",
                             recipe->sensors, use, scene_name);
    row->image_s =
        command(r, NULL, "image.hdr", "rpict %s -x %u -y %u -pa 0 -ps 1 %s%s %s", OFFICE_VIEW,
                table->width, table->height, recipe->image, use, scene_name);
    read_lux(r, "sensors.out", lx);
    snprintf(image, sizeof image, "%s/image.hdr", r->folder);
    double *luminances = bench_read_luminances(image, (int)table->width, (int)table->height);
    table_judge(table, lx, luminances, row);
    free(luminances);
}

void table_add_radiance(struct table *table)
{
    struct radiance r = {.table = table};
    double map_s[TABLE_KINDS];
    if (!table->radiance)
        return;
    for (int i = 0; i < PROGRAMS; i++) {
        if (on_path(programs[i]))
            continue;
        printf("  (no %s on PATH: Radiance's rows are left out)\n", programs[i]);
        return;
    }
    prepare(&r);
    fprintf(stderr, "  Radiance: maps\n");
    for (int kind = 0; kind < TABLE_KINDS; kind++)
        map_s[kind] =
            command(&r, NULL, NULL, "mkpmap %s %s %llu%s %s %s %s", maps[kind].make,
                    maps[kind].file, (unsigned long long)table->photons,
                    kind == TABLE_PRECOMPUTED ? " 50" : "", maps[kind].more, ports, scene_name);
    for (int i = 0; i < RECIPES; i++)
        if (recipes[i].uses[TABLE_GLOBAL] || recipes[i].uses[TABLE_PRECOMPUTED] ||
            table->radiance_backward)
            measure(&r, &recipes[i], map_s);
}
