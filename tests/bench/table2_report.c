#include <jansson.h>
#include <math.h>
#include <string.h>

#include "bench/table2.h"

/* ---- Figures --------------------------------------------------------------------------------- */

static void merge(double *mean, double value, int before)
{
    *mean += (value - *mean) / (before + 1);
}

static void merge_rms(double *pool, double rms, int before)
{
    double squares = *pool * *pool;
    merge(&squares, rms * rms, before);
    *pool = sqrt(squares);
}

static void merge_deviation(struct bench_deviation *pool, const struct bench_deviation *d,
                            int before)
{
    merge_rms(&pool->rms, d->rms, before);
    merge_rms(&pool->rms_99, d->rms_99, before);
    merge(&pool->bias, d->bias, before);
    if (fabs(d->worst) > fabs(pool->worst)) {
        pool->worst = d->worst;
        pool->worst_at = d->worst_at;
    }
}

void table_merge(struct table_row *row, const struct table_row *of_run, int run)
{
    for (int kind = 0; kind < TABLE_KINDS; kind++) {
        merge(&row->photon_s[kind], of_run->photon_s[kind], run);
        merge(&row->photons[kind], of_run->photons[kind], run);
    }
    merge(&row->load_s, of_run->load_s, run);
    merge(&row->sensors_s, of_run->sensors_s, run);
    merge(&row->image_s, of_run->image_s, run);
    merge(&row->image_bias, of_run->image_bias, run);
    merge_deviation(&row->sensors, &of_run->sensors, run);
    merge_deviation(&row->image, &of_run->image, run);
}

void table_judge(const struct table *table, const double *lx, const double *luminances,
                 struct table_row *row)
{
    row->sensors = bench_compare(&table->reference.sensors, lx, 0);
    row->image = bench_compare(&table->reference.image, luminances, OFFICE_DARKEST);
    row->image_bias = bench_bias_of_mean(&table->reference.image, luminances);
}

static double fixed_s(const struct table_row *row)
{
    double sum = row->load_s;
    for (int kind = 0; kind < TABLE_KINDS; kind++)
        sum += row->photon_s[kind];
    return sum;
}

double table_total_s(const struct table_row *row)
{
    return fixed_s(row) + row->image_s;
}

/* Scales backward's image time: its noise falls as 1/sqrt(n), the time of the image grows as n; the
 * rest of the time is constant. */
static double backward_image_s(const struct table *table, double noise, double wanted)
{
    return wanted > 0 ? table->rows[0].image_s * pow(noise / wanted, 2) : 0;
}

static double speed_up(const struct table *table, const struct table_row *row)
{
    const struct table_row *b = &table->rows[0];
    return (fixed_s(b) + backward_image_s(table, b->image.rms, row->image.rms)) /
           table_total_s(row);
}

static double speed_up_maps_ready(const struct table *table, const struct table_row *row)
{
    const struct table_row *b = &table->rows[0];
    return backward_image_s(table, b->image.rms, row->image.rms) / row->image_s;
}

static double speed_up_99(const struct table *table, const struct table_row *row)
{
    const struct table_row *b = &table->rows[0];
    return (fixed_s(b) + backward_image_s(table, b->image.rms_99, row->image.rms_99)) /
           table_total_s(row);
}

/* ---- As a table ------------------------------------------------------------------------------ */

static void print_seconds(const struct table *table, double seconds)
{
    if (seconds > 0)
        printf(" %7.2f (%6.1f)", seconds, seconds * table->rate / 1e6);
    else
        printf(" %7s %8s", "-", "");
}

static void print_name(const struct table_row *row)
{
    printf("  %-9s%-30s %-4s", row->radiance ? "Radiance " : "", row->name, row->paper);
}

static void print_times(const struct table *table)
{
    printf("\n  %-39s %-4s %16s %16s %16s %16s %16s %16s %16s\n", "seconds (M ray-times)", "",
           "load", "global", "caustic", "precomputed", "image", "total", "57 sensors");
    for (int i = 0; i < table->n_rows; i++) {
        const struct table_row *row = &table->rows[i];
        print_name(row);
        print_seconds(table, row->load_s);
        for (int kind = 0; kind < TABLE_KINDS; kind++)
            print_seconds(table, row->photon_s[kind]);
        print_seconds(table, row->image_s);
        print_seconds(table, table_total_s(row));
        print_seconds(table, row->sensors_s);
        printf("\n");
    }
    printf("  backward's global photons are its virtual lamps. Total: load, photons and image.\n"
           "  Radiance's programs load the scene themselves, each in its own time.\n");
}

static void print_errors(const struct table *table)
{
    printf("\n  %-39s %-4s | %-34s | %-27s | %s\n", "errors", "", "57 sensors", "image",
           "speed-up over backward, at equal");
    printf("  %-39s %-4s | %8s %8s %16s | %8s %8s %9s | %8s %10s %8s\n", "", "", "rms %", "bias %",
           "worst %", "rms %", "rms99 %", "bias %", "rms", "maps ready", "rms99");
    for (int i = 0; i < table->n_rows; i++) {
        const struct table_row *row = &table->rows[i];
        print_name(row);
        printf(" | %8.2f %+8.2f %+8.1f (no. %2zu) | %8.2f %8.2f %+9.2f", 100 * row->sensors.rms,
               100 * row->sensors.bias, 100 * row->sensors.worst, row->sensors.worst_at + 1,
               100 * row->image.rms, 100 * row->image.rms_99, 100 * row->image_bias);
        printf(" | %8.2f %10.2f %8.2f\n", speed_up(table, row), speed_up_maps_ready(table, row),
               speed_up_99(table, row));
    }
    printf("  Against backward in two independent halves, A and B, of %u samples a pixel and %u a\n"
           "  sensor each. Its own standard error: %.2f %% of a pixel, %.3f %% of"
           " a sensor.\n"
           "  rms: root of the mean of (x - A)(x - B) / R^2, R = (A + B) / 2, which the "
           "reference's noise drops out of;\n"
           "  pixels below %.0f %% of the mean are left out. rms99: without the worst "
           "hundredth of pixels.\n"
           "  Bias of the image: of its mean.\n"
           "  Speed-up: backward's image time times (its rms / the row's rms)^2, as noise falls "
           "with 1/sqrt(n),\n"
           "  plus its load and lamps, over the row's total; maps ready: image times alone.\n",
           table->reference.pixel_samples, table->reference.sensor_samples,
           100 * bench_reference_noise(&table->reference.image, OFFICE_DARKEST),
           100 * bench_reference_noise(&table->reference.sensors, 0), 100 * OFFICE_DARKEST);
}

void table_print(const struct table *table)
{
    printf("\nTable 2: office, laser cut panel 2^6, %.2f M photons of each kind, image %u x %u, "
           "backward %u samples a pixel,\n"
           "%u rays a sensor; one thread, processor seconds, mean of %d. R, Embree alone: %.2f M "
           "rays/s\n",
           (double)table->photons / 1e6, table->reference.width, table->reference.height,
           table->pixel_samples, table->sensor_samples, table->runs, table->rate / 1e6);
    print_times(table);
    print_errors(table);
}

/* ---- As JSON --------------------------------------------------------------------------------- */

static json_t *deviation_json(const struct bench_deviation *d, double bias)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:I}", "rms", d->rms, "rms_99", d->rms_99, "bias", bias,
                     "worst", d->worst, "worst_index", (json_int_t)d->worst_at);
}

static json_t *row_json(const struct table *table, const struct table_row *row)
{
    return json_pack(
        "{s:s, s:s, s:s, s:f, s:{s:f, s:f, s:f}, s:f, s:f, s:f, s:o, s:o, s:f, s:f, s:f}",
        "program", row->radiance ? "Radiance" : "Oriel", "technique", row->name, "paper",
        row->paper, "load_s", row->load_s, "photons_s", "global", row->photon_s[TABLE_GLOBAL],
        "caustic", row->photon_s[TABLE_CAUSTIC], "precomputed", row->photon_s[TABLE_PRECOMPUTED],
        "image_s", row->image_s, "total_s", table_total_s(row), "sensors_s", row->sensors_s,
        "sensors", deviation_json(&row->sensors, row->sensors.bias), "image",
        deviation_json(&row->image, row->image_bias), "speed_up", speed_up(table, row),
        "speed_up_maps_ready", speed_up_maps_ready(table, row), "speed_up_rms_99",
        speed_up_99(table, row));
}

void table_write_json(const struct table *table, const char *path)
{
    json_t *rows = json_array();
    for (int i = 0; i < table->n_rows; i++)
        json_array_append_new(rows, row_json(table, &table->rows[i]));
    json_t *root = json_pack(
        "{s:f, s:I, s:i, s:i, s:i, s:i, s:i, s:{s:i, s:i, s:f, s:f}, s:o}", "rays_per_s",
        table->rate, "photons", (json_int_t)table->photons, "width", (int)table->reference.width,
        "height", (int)table->reference.height, "pixel_samples", (int)table->pixel_samples,
        "sensor_samples", (int)table->sensor_samples, "runs", table->runs, "reference",
        "pixel_samples", (int)table->reference.pixel_samples, "sensor_samples",
        (int)table->reference.sensor_samples, "image_error",
        bench_reference_noise(&table->reference.image, OFFICE_DARKEST), "sensor_error",
        bench_reference_noise(&table->reference.sensors, 0), "rows", rows);
    if (!root || json_dump_file(root, path, JSON_INDENT(2) | JSON_REAL_PRECISION(6)) < 0)
        bench_fail("cannot write the table's JSON", NULL);
    json_decref(root);
    printf("\n  The same as JSON: %s\n", path);
}
