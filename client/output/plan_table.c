#include "output/terminal.h"

#include <math.h>
#include <stdbool.h>
#include <string.h>

#include <oriel/job/paths.h>

/* Columns of the table: the longest effect name has 15 letters; the reason takes the rest. */
enum { EFFECT_WIDTH = 15, SIMULATED_WIDTH = 11, BOUND_WIDTH = 9, TIME_WIDTH = 7, GAP = 2 };
enum { WHY_COLUMN = EFFECT_WIDTH + SIMULATED_WIDTH + BOUND_WIDTH + 2 * TIME_WIDTH + 5 * GAP };
enum { HEAD_WIDTH = 13 };

static int left_out(const struct orl_plan *plan)
{
    int count = 0;
    for (int i = 0; i < ORL_EFFECT_COUNT; i++)
        count += !plan->effects[i].simulated;
    return count;
}

void orl_format_plan(const struct orl_plan *plan, char *ret_text, size_t size)
{
    const bool apart = plan->sensor_technique != plan->technique;
    snprintf(ret_text, size, "%s%s%s; %d of %d effects left out",
             orl_technique_name(plan->technique), apart ? ", for sensors " : "",
             apart ? orl_technique_name(plan->sensor_technique) : "", left_out(plan),
             ORL_EFFECT_COUNT);
}

/* Formats a bound with two digits and without an exponent. */
static void format_bound(const struct orl_decision *decision, char *ret_text, size_t size)
{
    const bool relative = decision->unit == ORL_BOUND_RELATIVE;
    const double value = relative ? 100 * decision->bound : decision->bound;
    const char *unit = relative ? "%" : "lx";
    if (decision->unit == ORL_BOUND_NONE)
        snprintf(ret_text, size, "-");
    else if (!isfinite(value) || value >= 1e6)
        snprintf(ret_text, size, "unbounded");
    else if (value > 0 && value < 0.001)
        snprintf(ret_text, size, "<0.001 %s", unit);
    else
        snprintf(ret_text, size, "%.*f %s",
                 value >= 10 || value == 0 ? 0
                 : value >= 1              ? 1
                 : value >= 0.1            ? 2
                                           : 3,
                 value, unit);
}

static void format_time(double seconds, char *ret_text, size_t size)
{
    if (!(seconds > 0) || !isfinite(seconds))
        snprintf(ret_text, size, "-");
    else if (seconds < 0.05)
        snprintf(ret_text, size, "<0.1 s");
    else if (seconds < 100)
        snprintf(ret_text, size, "%.1f s", seconds);
    else
        orl_format_duration(seconds, ret_text, size);
}

static void print_row(FILE *to, enum orl_effect effect, const struct orl_decision *decision)
{
    char simulated[32], bound[32], cost[32], saved[32];
    snprintf(simulated, sizeof simulated, "%s%s%s%s", decision->simulated ? "yes" : "no",
             decision->override ? " (" : "",
             decision->override ? orl_effect_override_name(decision->override) : "",
             decision->override ? ")" : "");
    format_bound(decision, bound, sizeof bound);
    format_time(decision->cost_s, cost, sizeof cost);
    format_time(decision->saved_s, saved, sizeof saved);
    fprintf(to, "%-*s  %-*s  %*s  %*s  %*s  ", EFFECT_WIDTH, orl_effect_name(effect),
            SIMULATED_WIDTH, simulated, BOUND_WIDTH, bound, TIME_WIDTH, cost, TIME_WIDTH, saved);
    orl_print_wrapped(to, ORL_WRAP_COLUMNS, WHY_COLUMN, WHY_COLUMN, decision->why);
}

static void print_photons(FILE *to, const struct orl_plan *plan)
{
    const struct {
        const char *name;
        uint64_t target;
    } maps[] = {{"global", plan->photons_global}, {"caustic", plan->photons_caustic}};
    const char *before = "";
    fprintf(to, "%-*s", HEAD_WIDTH, "photons");
    for (size_t i = 0; i < sizeof maps / sizeof maps[0]; i++) {
        char amount[32];
        if (maps[i].target == 0)
            continue;
        orl_format_amount((double)maps[i].target, "", amount, sizeof amount);
        fprintf(to, "%s%s %s", before, amount, maps[i].name);
        before = ", ";
    }
    if (plan->technique == ORL_TECHNIQUE_BACKWARD && *before)
        fputs(" (used as virtual lights; no map)\n", to);
    else
        fputs(*before ? "\n" : "none\n", to);
}

static void format_forecast(double seconds, char *ret_text, size_t size)
{
    char amount[32] = "";
    if (isfinite(seconds))
        orl_format_duration(seconds, amount, sizeof amount);
    snprintf(ret_text, size, "%s%s", *amount ? "about " : "not known", amount);
}

/* Prints the predicted cost of the photons, if a pilot was run. */
static void print_forecast(FILE *to, const struct orl_plan *plan)
{
    const struct orl_photon_forecast *f = &plan->forecast;
    char seconds[48], job[48], text[ORL_WHY_MAX + 160];
    if (!f->made)
        return;
    format_forecast(f->known ? f->photons_s : NAN, seconds, sizeof seconds);
    format_forecast(f->job_s, job, sizeof job);
    snprintf(text, sizeof text, "%s, the whole job: %s; %s", seconds, job, f->why);
    fprintf(to, "%-*s", HEAD_WIDTH, "photons take");
    orl_print_wrapped(to, ORL_WRAP_COLUMNS, HEAD_WIDTH, HEAD_WIDTH, text);
}

static void print_technique(FILE *to, const char *head, enum orl_technique technique,
                            const char *why)
{
    char text[ORL_WHY_MAX + 64];
    snprintf(text, sizeof text, "%s%s%s", orl_technique_name(technique), why[0] ? ": " : "", why);
    fprintf(to, "%-*s", HEAD_WIDTH, head);
    orl_print_wrapped(to, ORL_WRAP_COLUMNS, HEAD_WIDTH, HEAD_WIDTH, text);
}

static void print_head(FILE *to, const struct orl_plan *plan)
{
    print_technique(to, "technique", plan->technique, plan->technique_why);
    if (plan->sensor_technique != plan->technique)
        print_technique(to, "for sensors", plan->sensor_technique, plan->sensor_why);
    print_photons(to, plan);
    print_forecast(to, plan);
    fprintf(to, "%-*s%s\n", HEAD_WIDTH, "channels", plan->channels == 1 ? "1 (grey)" : "3");
    if (plan->most_reflections == ORL_ALL_REFLECTIONS)
        fprintf(to, "%-*sall diffuse reflections\n", HEAD_WIDTH, "reflections");
    else
        fprintf(to, "%-*sat most %u diffuse reflections\n", HEAD_WIDTH, "reflections",
                plan->most_reflections);
}

/* Formats the names of the strategies that find a class of paths, for views, or for sensors if
 * there are no views. */
static void format_strategies(const struct orl_plan *plan, enum orl_path_class class,
                              char *ret_text, size_t size)
{
    const unsigned found = orl_path_strategies(plan->technique, class, ORL_RECEIVER_SURFACE);
    size_t length = 0;
    for (unsigned i = 0; i < ORL_PATH_STRATEGIES && length < size; i++)
        if (found & 1U << i)
            length +=
                (size_t)snprintf(ret_text + length, size - length, "%s%s", length > 0 ? ", " : "",
                                 orl_path_strategy_name((enum orl_path_strategy)(1U << i)));
}

/* Prints the scene's classes of paths, one per line. */
static void print_paths(FILE *to, const struct orl_plan *plan)
{
    const char *head = "light";
    for (int i = 0; i < ORL_PATH_CLASSES; i++) {
        const enum orl_path_class class = (enum orl_path_class)i;
        char by[160] = "", text[320];
        if (!(plan->paths & 1U << i))
            continue;
        format_strategies(plan, class, by, sizeof by);
        snprintf(text, sizeof text, "%s: by %s", orl_path_class_words(class), by);
        fprintf(to, "%-*s", HEAD_WIDTH, head);
        orl_print_wrapped(to, ORL_WRAP_COLUMNS, HEAD_WIDTH, HEAD_WIDTH, text);
        head = "";
    }
}

void orl_plan_print(FILE *to, const struct orl_plan *plan)
{
    char line[96];
    double saved_s = 0;
    print_head(to, plan);
    print_paths(to, plan);
    fprintf(to, "\n%-*s  %-*s  %*s  %*s  %*s  %s\n", EFFECT_WIDTH, "effect", SIMULATED_WIDTH,
            "simulated", BOUND_WIDTH, "bound", TIME_WIDTH, "costs", TIME_WIDTH, "saved", "why");
    for (int i = 0; i < ORL_EFFECT_COUNT; i++) {
        print_row(to, (enum orl_effect)i, &plan->effects[i]);
        if (isfinite(plan->effects[i].saved_s))
            saved_s += plan->effects[i].saved_s;
    }
    snprintf(line, sizeof line, "%d of %d effects left out", left_out(plan), ORL_EFFECT_COUNT);
    fprintf(to, "\n%s", line);
    if (saved_s >= 0.05)
        fprintf(to, ", which saves about %.1f s of one thread", saved_s);
    fputc('\n', to);
}

void orl_curve_print(FILE *to, const struct orl_accuracy_curve *curve)
{
    fprintf(to, "\n%-*s", HEAD_WIDTH, "accuracy");
    if (curve->n_points > 0)
        fprintf(to, "time, by %s on %u thread%s\n", orl_technique_name(curve->technique),
                curve->threads, curve->threads == 1 ? "" : "s");
    else
        orl_print_wrapped(to, ORL_WRAP_COLUMNS, HEAD_WIDTH, HEAD_WIDTH, curve->model);
    for (uint32_t i = 0; i < curve->n_points; i++) {
        char seconds[32];
        format_time(curve->points[i].seconds, seconds, sizeof seconds);
        fprintf(to, "%*.3g %%  %*s\n", HEAD_WIDTH - 3, 100 * curve->points[i].error, TIME_WIDTH + 1,
                seconds);
    }
}

static const char space[] = " \t\r\n";

/* Returns the number of bytes of the character at text, 1 or more; a character takes one column. */
static size_t character_bytes(const char *text)
{
    size_t length = 1;
    while (((unsigned char)text[length] & 0xc0) == 0x80)
        length++;
    return length;
}

static int count_columns(const char *text, size_t length)
{
    int count = 0;
    for (size_t at = 0; at < length; at += character_bytes(text + at))
        count++;
    return count;
}

static void start_line(FILE *to, int indent)
{
    fprintf(to, "\n%*s", indent, "");
}

/* Prints one word from column on, cut at the line's end. Returns the column after it. */
static int print_word(FILE *to, int width, int column, int indent, const char *word, size_t length)
{
    for (size_t at = 0; at < length;) {
        const size_t step = character_bytes(word + at);
        const unsigned char first = (unsigned char)word[at];
        if (column >= width && indent < width) {
            start_line(to, indent);
            column = indent;
        }
        if (first < 32 || first == 127)
            fputc('?', to);
        else
            fwrite(word + at, 1, step, to);
        at += step;
        column++;
    }
    return column;
}

void orl_print_wrapped(FILE *to, int width, int column, int indent, const char *text)
{
    for (int number = 0;; number++) {
        text += strspn(text, space);
        const size_t length = strcspn(text, space);
        if (length == 0)
            break;
        if (number > 0 && column + 1 + count_columns(text, length) > width) {
            start_line(to, indent);
            column = indent;
        } else if (number > 0) {
            fputc(' ', to);
            column++;
        }
        column = print_word(to, width, column, indent, text, length);
        text += length;
    }
    fputc('\n', to);
}
