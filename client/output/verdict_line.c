#include "output/verdict_line.h"

#include "http/json_get.h"

static void print_value(FILE *to, const json_t *verdict)
{
    const json_t *value = json_object_get(verdict, "value");
    const json_t *interval = json_object_get(verdict, "interval_95");
    const json_t *low = json_array_get(interval, 0), *high = json_array_get(interval, 1);

    if (!json_is_number(value))
        return;
    fprintf(to, ": %.4g", json_number_value(value));
    if (json_is_number(low) && json_is_number(high))
        fprintf(to, " [%.4g, %.4g]", json_number_value(low), json_number_value(high));
}

static void print_verdict(FILE *to, const json_t *verdict)
{
    const char *rule = orl_json_text(verdict, "rule"), *target = orl_json_text(verdict, "target");
    const char *grid = orl_json_text(verdict, "grid"), *note = orl_json_text(verdict, "note");

    fprintf(to, "%-10s %s%s%s (%s)", orl_json_text(verdict, "verdict"), rule,
            *rule && *target ? ": " : "", target, *grid ? grid : "all grids");
    print_value(to, verdict);
    fprintf(to, "%s%s\n", *note ? ": " : "", note);
}

void orl_print_verdicts(FILE *to, const json_t *verdicts)
{
    const json_t *one;
    size_t i;

    json_array_foreach(verdicts, i, one)
    {
        print_verdict(to, one);
    }
}
