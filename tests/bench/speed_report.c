/* The table of `make bench`, and its JSON. */
#include <jansson.h>
#include <math.h>
#include <stdio.h>

#include "bench/speed.h"

static double wall_speed_up(const struct speed_row *row, int at)
{
    return row->by_threads[0].seconds / row->by_threads[at].seconds;
}

static double ray_speed_up(const struct speed_row *row, int at)
{
    return row->by_threads[at].rays_per_s / row->by_threads[0].rays_per_s;
}

static bool is_measured(const struct speed_row *row)
{
    return row->by_threads[0].ray_times > 0;
}

static bool meets(const struct speed_row *row)
{
    return row->by_threads[0].ray_times <= row->target &&
           (row->judge == SPEED_NO_ERROR || row->error.rms <= row->wanted_error);
}

/* Allows for rounding, for bytes and similar values. */
static bool fact_meets(const struct speed_fact *fact)
{
    return fact->value <= fact->target * (1 + 1e-4);
}

/* ---- As a table ------------------------------------------------------------------------------ */

static void print_error(double rms, double wanted)
{
    if (wanted > 0)
        printf(" %6.2f (%1.0f)", 100 * rms, 100 * wanted);
    else
        printf(" %10s", "");
}

static void print_row(const struct speed *s, const struct speed_row *row)
{
    const struct speed_figure *f = &row->by_threads[0];
    char name[128];
    if (row->judge == SPEED_NO_ERROR)
        snprintf(name, sizeof name, "%.3g M %s", (double)s->photons / 1e6, row->name);
    else
        snprintf(name, sizeof name, "%s", row->name);
    printf("  %-46s %8.3f %8.1f %8.1f %7.2f", name, f->seconds, f->ray_times / 1e6,
           row->target / 1e6, f->ray_times / row->target);
    print_error(row->error.rms, row->wanted_error);
    printf(" %-4s", meets(row) ? "yes" : "NO");
    if (row->radiance.ray_times > 0) {
        printf(" %8.1f %7.1f", row->radiance.ray_times / 1e6,
               row->radiance.ray_times / f->ray_times);
        if (row->judge != SPEED_NO_ERROR)
            printf(" %6.1f", 100 * row->radiance_error);
        else
            printf(" %6s", "");
    } else {
        printf(" %8s %7s %6s", "-", "-", "");
    }
    printf("  %s\n", row->note);
}

static void print_rows(const struct speed *s)
{
    printf("\n  %-46s %8s %8s %8s %7s %10s %-4s %8s %7s %6s\n", "", "s", "M rays", "target",
           "/target", "rms % (of)", "met", "Radiance", "times", "rms %");
    for (int id = 0; id < SPEED_ROWS; id++)
        if (is_measured(&s->rows[id]))
            print_row(s, &s->rows[id]);
    printf("  M rays: millions of ray-times. Radiance: its ray-times for the same work, how many "
           "times Oriel's they are,\n"
           "  and its error. rms: of sensors, or of pixels, against backward in two halves whose "
           "own error (%.2f %% of a pixel,\n"
           "  %.3f %% of a sensor) drops out.\n",
           100 * bench_reference_noise(&s->reference.image, OFFICE_DARKEST),
           100 * bench_reference_noise(&s->reference.sensors, 0));
}

/* Returns the required gain, 0.95 per thread. */
static double gain_wanted(const struct speed *s, int at)
{
    return 0.95 * s->threads.values[at] / s->threads.values[0];
}

static void print_threads(const struct speed *s)
{
    for (int at = 1; at < s->threads.n; at++) {
        printf("\n  %-46s %8s %8s %14s %-4s %8s %8s\n", "", "s", "M rays", "speed-up", "met",
               "on clock", "Embree's");
        for (int id = 0; id < SPEED_ROWS; id++) {
            const struct speed_row *row = &s->rows[id];
            const struct speed_figure *f = &row->by_threads[at];
            if (f->ray_times > 0)
                printf("  %-46s %8.3f %8.1f %6.2f +- %.2f  %-4s %8.2f %8.2f\n", row->name,
                       f->seconds, f->ray_times / 1e6, row->gains[at], row->gain_errors[at],
                       row->gains[at] >= gain_wanted(s, at) ? "yes" : "NO", wall_speed_up(row, at),
                       ray_speed_up(row, at));
        }
        printf("  %.0f threads against %.0f. Speed-up: by ray-times, in turns, with its standard "
               "error; on clock: by\n"
               "  seconds; Embree's: by how much its own rays gain in the same seconds. Wanted: "
               "0.95 a thread.\n",
               s->threads.values[at], s->threads.values[0]);
    }
}

static void print_facts(const struct speed *s)
{
    if (s->n_facts > 0)
        printf("\n  %-72s %9s %9s %-4s %9s\n", "", "", "target", "met", "Radiance");
    for (int i = 0; i < s->n_facts; i++) {
        const struct speed_fact *f = &s->facts[i];
        printf("  %-60s %11s %9.3g", f->name, f->unit, f->value);
        if (f->target > 0)
            printf(" %9.3g %-4s", f->target, fact_meets(f) ? "yes" : "NO");
        else
            printf(" %9s %-4s", "-", "");
        if (f->radiance > 0)
            printf(" %9.3g", f->radiance);
        printf("\n");
    }
}

void speed_print(const struct speed *s)
{
    double rate = 0;
    for (int id = 0; id < SPEED_ROWS; id++)
        rate = fmax(rate, s->rows[id].by_threads[0].rays_per_s);
    printf(
        "\nSpeed: the office, its panel of 2^6, %.0f thread%s, medians of %d; R, Embree alone, at "
        "best %.2f M rays/s\n",
        s->threads.values[0], s->threads.values[0] > 1 ? "s" : "", s->runs, rate / 1e6);
    print_rows(s);
    print_threads(s);
    print_facts(s);
}

/* ---- As JSON --------------------------------------------------------------------------------- */

/* Returns the figures that do not depend on the machine. */
static json_t *ratios_json(const struct speed *s)
{
    json_t *ratios = json_object();
    for (int id = 0; id < SPEED_ROWS; id++) {
        const struct speed_row *row = &s->rows[id];
        if (!is_measured(row))
            continue;
        json_t *of_row =
            json_pack("{s:f, s:f, s:b}", "ray_times", row->by_threads[0].ray_times, "to_target",
                      row->by_threads[0].ray_times / row->target, "met", meets(row));
        if (row->judge != SPEED_NO_ERROR)
            json_object_set_new(of_row, "rms", json_real(row->error.rms));
        if (row->radiance.ray_times > 0)
            json_object_set_new(of_row, "radiance",
                                json_real(row->radiance.ray_times / row->by_threads[0].ray_times));
        for (int at = 1; at < s->threads.n; at++) {
            char key[32];
            snprintf(key, sizeof key, "speed_up_%.0f", s->threads.values[at]);
            if (row->by_threads[at].ray_times > 0)
                json_object_set_new(of_row, key, json_real(row->gains[at]));
        }
        json_object_set_new(ratios, row->key, of_row);
    }
    return ratios;
}

static json_t *figure_json(const struct speed_figure *f)
{
    return json_pack("{s:f, s:f, s:f}", "seconds", f->seconds, "rays_per_s", f->rays_per_s,
                     "ray_times", f->ray_times);
}

static json_t *rows_json(const struct speed *s)
{
    json_t *rows = json_array();
    for (int id = 0; id < SPEED_ROWS; id++) {
        const struct speed_row *row = &s->rows[id];
        if (!is_measured(row))
            continue;
        json_t *of_row = json_pack("{s:s, s:s, s:s, s:f}", "key", row->key, "name", row->name,
                                   "note", row->note, "target", row->target);
        for (int at = 0; at < s->threads.n; at++) {
            char key[32];
            snprintf(key, sizeof key, "threads_%.0f", s->threads.values[at]);
            json_object_set_new(of_row, key, figure_json(&row->by_threads[at]));
        }
        if (row->radiance.ray_times > 0)
            json_object_set_new(of_row, "radiance", figure_json(&row->radiance));
        json_array_append_new(rows, of_row);
    }
    return rows;
}

static json_t *facts_json(const struct speed *s)
{
    json_t *facts = json_array();
    for (int i = 0; i < s->n_facts; i++) {
        const struct speed_fact *f = &s->facts[i];
        json_array_append_new(facts, json_pack("{s:s, s:s, s:s, s:f, s:f, s:f}", "key", f->key,
                                               "name", f->name, "unit", f->unit, "value", f->value,
                                               "target", f->target, "radiance", f->radiance));
    }
    return facts;
}

void speed_write_json(const struct speed *s, const char *path)
{
    json_t *root =
        json_pack("{s:o, s:o, s:o, s:I, s:i}", "ratios", ratios_json(s), "facts", facts_json(s),
                  "rows", rows_json(s), "photons", (json_int_t)s->photons, "runs", s->runs);
    if (!root || json_dump_file(root, path, JSON_INDENT(2) | JSON_REAL_PRECISION(6)) < 0)
        bench_fail("cannot write the JSON", NULL);
    json_decref(root);
    printf("\n  The same as JSON: %s\n", path);
}
