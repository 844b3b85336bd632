/* Parser of targets, and verdicts on them. */
#include <oriel/annual/annual_metrics.h>

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>

#include <oriel/base/suggest.h>

#include "base/text/words.h"

struct target_parser {
    const char *text, *at;
    struct orl_error *err;
};

static int report_wanted(const struct target_parser *r, const char *what)
{
    orl_error_set(r->err, ORL_ERR_SYNTAX, "'%s': %s is expected %s%s%s", r->text, what,
                  *r->at ? "before '" : "at the end", r->at, *r->at ? "'" : "");
    orl_error_hint(r->err, "write for instance \"sDA300/50 >= 55 %%\", \"ASE1000,250 <= 10 %%\", "
                           "\"DA300 of office >= 60 %%\"");
    return ORL_ERR_SYNTAX;
}

static void skip_space(struct target_parser *r)
{
    while (isspace((unsigned char)*r->at))
        r->at++;
}

/* Takes a word, in either case, if no letter follows it. */
static bool take_word(struct target_parser *r, const char *word)
{
    const size_t length = strlen(word);
    skip_space(r);
    if (strncasecmp(r->at, word, length) != 0 ||
        (isalpha((unsigned char)word[length - 1]) && isalpha((unsigned char)r->at[length])))
        return false;
    r->at += length;
    return true;
}

static bool take_number(struct target_parser *r, double *ret_value)
{
    skip_space(r);
    const size_t length = strspn(r->at, "0123456789.");
    if (length == 0 || orl_number_read(r->at, length, ret_value) != ORL_NUMBER_OK)
        return false;
    r->at += length;
    return true;
}

/* ---- Figures --------------------------------------------------------------------------------- */

struct kind_name {
    const char *name;
    enum orl_annual_aggregate aggregate;
    struct orl_annual_metric metric;
    double least;
};

/* Names with default numbers. Longer names come first. */
static const struct kind_name kind_names[] = {
    {"udi_lower", ORL_AGGREGATE_AVERAGE, {ORL_METRIC_UDI_LOWER, ORL_WHEN_OCCUPIED, 100, 0}, 0},
    {"udi_part", ORL_AGGREGATE_AVERAGE, {ORL_METRIC_UDI_PART, ORL_WHEN_OCCUPIED, 100, 300}, 0},
    {"udi_upper", ORL_AGGREGATE_AVERAGE, {ORL_METRIC_UDI_UPPER, ORL_WHEN_OCCUPIED, 3000, 0}, 0},
    {"udi", ORL_AGGREGATE_AVERAGE, {ORL_METRIC_UDI, ORL_WHEN_OCCUPIED, 100, 3000}, 0},
    {"sda", ORL_AGGREGATE_SHARE, {ORL_METRIC_DA, ORL_WHEN_OCCUPIED, 300, 0}, 50},
    {"ase", ORL_AGGREGATE_SHARE, {ORL_METRIC_DIRECT_HOURS, ORL_WHEN_OCCUPIED, 1000, 0}, 250},
    {"sdf", ORL_AGGREGATE_SHARE, {ORL_METRIC_DF, ORL_WHEN_ALWAYS, 0, 0}, 2},
    {"df", ORL_AGGREGATE_AVERAGE, {ORL_METRIC_DF, ORL_WHEN_ALWAYS, 0, 0}, 0},
    {"cda", ORL_AGGREGATE_AVERAGE, {ORL_METRIC_CDA, ORL_WHEN_OCCUPIED, 300, 0}, 0},
    {"da", ORL_AGGREGATE_AVERAGE, {ORL_METRIC_DA, ORL_WHEN_OCCUPIED, 300, 0}, 0},
    {"illuminance", ORL_AGGREGATE_AVERAGE, {ORL_METRIC_MEAN, ORL_WHEN_OCCUPIED, 0, 0}, 0},
    {"cumulative", ORL_AGGREGATE_AVERAGE, {ORL_METRIC_CUMULATIVE, ORL_WHEN_ALWAYS, 0, 0}, 0},
    {"direct_hours",
     ORL_AGGREGATE_AVERAGE,
     {ORL_METRIC_DIRECT_HOURS, ORL_WHEN_OCCUPIED, 1000, 0},
     0},
    {"hours", ORL_AGGREGATE_AVERAGE, {ORL_METRIC_HOURS, ORL_WHEN_ALWAYS, 300, 0}, 0},
};

static const struct kind_name *take_kind(struct target_parser *r)
{
    for (size_t i = 0; i < sizeof kind_names / sizeof *kind_names; i++)
        if (take_word(r, kind_names[i].name))
            return &kind_names[i];
    return NULL;
}

/* Reports an unknown name, and suggests one. also: aggregate whose names are known here, beside
 * those of ORL_AGGREGATE_AVERAGE. */
static int report_kind(const struct target_parser *r, enum orl_annual_aggregate also,
                       const char *what)
{
    char word[ORL_SUGGEST_LETTERS + 1];
    struct orl_suggestion suggestion = {.word = word};
    size_t letters = 0;
    while (isalpha((unsigned char)r->at[letters]) || r->at[letters] == '_')
        letters++;
    snprintf(word, sizeof word, "%.*s", (int)(letters < sizeof word ? letters : 0), r->at);
    for (size_t i = 0; i < sizeof kind_names / sizeof *kind_names; i++)
        if (kind_names[i].aggregate == ORL_AGGREGATE_AVERAGE || kind_names[i].aggregate == also)
            orl_suggestion_add(&suggestion, kind_names[i].name);
    const int code = report_wanted(r, what);
    orl_suggestion_hint(&suggestion, r->err);
    return code;
}

/* Takes the second number of "300/50", "300,50" and "100-3000", if there is one. */
static int take_second(struct target_parser *r, double *ret_value)
{
    skip_space(r);
    if (*r->at == '\0' || !strchr("/,-", *r->at))
        return 0;
    r->at++;
    return take_number(r, ret_value) ? 0 : report_wanted(r, "a number");
}

/* Reads "sDF2", "sDF2 %" or "sDF300lx": a factor, or the illuminance that it must give. */
static int read_factor(struct target_parser *r, struct orl_annual_figure *figure)
{
    double number = 0;
    if (figure->aggregate != ORL_AGGREGATE_SHARE || !take_number(r, &number))
        return 0;
    if (!(number > 0))
        return report_wanted(r, "a daylight factor above 0 %");
    const bool lux = take_word(r, "lx");
    figure->metric.low_lx = lux ? number : 0;
    figure->least = lux ? 0 : number;
    if (!lux)
        take_word(r, "%");
    return 0;
}

static int read_numbers(struct target_parser *r, struct orl_annual_figure *figure)
{
    struct orl_annual_metric *metric = &figure->metric;
    int code = 0;
    if (metric->kind == ORL_METRIC_DF)
        return read_factor(r, figure);
    const bool range = metric->kind == ORL_METRIC_UDI || metric->kind == ORL_METRIC_UDI_PART;
    if (metric->kind == ORL_METRIC_MEAN || metric->kind == ORL_METRIC_CUMULATIVE ||
        !take_number(r, &metric->low_lx))
        return 0;
    if (figure->aggregate == ORL_AGGREGATE_SHARE)
        code = take_second(r, &figure->least);
    else if (range)
        code = take_second(r, &metric->high_lx);
    if (code == 0 && figure->aggregate == ORL_AGGREGATE_SHARE && !take_word(r, "%"))
        take_word(r, "h");
    if (code < 0)
        return code;
    if (!(metric->low_lx > 0) && metric->kind != ORL_METRIC_DIRECT_HOURS)
        return report_wanted(r, "an illuminance above 0 lx");
    if (range && metric->high_lx < metric->low_lx)
        return report_wanted(r, "a range from the lower to the higher illuminance");
    if (metric->kind == ORL_METRIC_DA && figure->aggregate == ORL_AGGREGATE_SHARE &&
        figure->least > 100)
        return report_wanted(r, "a share of the hours, at most 100 %,");
    return 0;
}

/* Reads all words up to the relation, since names may contain spaces. */
static int read_grid(struct target_parser *r, char ret_grid[ORL_TARGET_GRID])
{
    skip_space(r);
    size_t length = strcspn(r->at, "<>=");
    const char *end = r->at + length;
    while (length > 0 && isspace((unsigned char)r->at[length - 1]))
        length--;
    if (length == 0)
        return report_wanted(r, "a grid's name");
    if (length >= ORL_TARGET_GRID)
        return orl_error_set(r->err, ORL_ERR_LIMIT, "'%s': the grid's name is too long", r->text);
    memcpy(ret_grid, r->at, length);
    ret_grid[length] = '\0';
    r->at = end;
    return 0;
}

static void read_when(struct target_parser *r, enum orl_annual_when *when)
{
    if (take_word(r, "in daylight hours"))
        *when = ORL_WHEN_DAYLIGHT;
    else if (take_word(r, "over the year"))
        *when = ORL_WHEN_ALWAYS;
}

static int read_figure(struct target_parser *r, struct orl_annual_target *target)
{
    const bool least = take_word(r, "least");
    const struct kind_name *kind = take_kind(r);
    if (!kind)
        return report_kind(
            r, ORL_AGGREGATE_SHARE,
            "a figure's name (sDA, ASE, DA, cDA, UDI, illuminance, hours, DF, sDF, ...)");
    target->figure = (struct orl_annual_figure){kind->aggregate, kind->metric, kind->least};
    if (least && kind->aggregate == ORL_AGGREGATE_SHARE)
        return orl_error_set(r->err, ORL_ERR_SYNTAX,
                             "'%s': \"least\" does not apply to a share of the area", r->text);
    int code = read_numbers(r, &target->figure);
    if (least)
        target->figure.aggregate = ORL_AGGREGATE_LEAST;
    if (code == 0 && take_word(r, "of mean")) {
        if (kind->aggregate == ORL_AGGREGATE_SHARE || least)
            return orl_error_set(
                r->err, ORL_ERR_SYNTAX,
                "'%s': \"of mean\" does not apply to a share of the area or to \"least\"", r->text);
        target->figure.aggregate = ORL_AGGREGATE_OF_MEAN;
    }
    if (code == 0 && kind->metric.kind != ORL_METRIC_DF)
        read_when(r, &target->figure.metric.when);
    if (code == 0 && take_word(r, "of"))
        code = read_grid(r, target->grid);
    return code;
}

int orl_annual_metric_parse(const char *text, struct orl_annual_metric *ret_metric,
                            struct orl_error *err)
{
    struct target_parser r = {.text = text, .at = text, .err = err};
    const struct kind_name *kind = take_kind(&r);
    if (!kind || kind->aggregate != ORL_AGGREGATE_AVERAGE)
        return report_kind(&r, ORL_AGGREGATE_AVERAGE,
                           "a metric of sensors (DA, cDA, UDI, udi_lower, udi_part, udi_upper, "
                           "illuminance, cumulative, hours, direct_hours, DF)");
    struct orl_annual_figure figure = {kind->aggregate, kind->metric, 0};
    const int code = read_numbers(&r, &figure);
    if (code < 0)
        return code;
    if (kind->metric.kind != ORL_METRIC_DF)
        read_when(&r, &figure.metric.when);
    skip_space(&r);
    if (*r.at)
        return report_wanted(&r, "the end");
    *ret_metric = figure.metric;
    return 0;
}

/* ---- Relation and bound ---------------------------------------------------------------------- */

static int read_relation(struct target_parser *r, enum orl_relation *ret_relation)
{
    static const struct {
        const char *sign;
        enum orl_relation relation;
    } signs[] = {
        {">=", ORL_AT_LEAST}, {"<=", ORL_AT_MOST}, {">", ORL_MORE_THAN}, {"<", ORL_LESS_THAN}};
    skip_space(r);
    for (size_t i = 0; i < sizeof signs / sizeof *signs; i++)
        if (strncmp(r->at, signs[i].sign, strlen(signs[i].sign)) == 0) {
            r->at += strlen(signs[i].sign);
            *ret_relation = signs[i].relation;
            return 0;
        }
    return report_wanted(r, "'>=', '<=', '>' or '<'");
}

static int read_bound(struct target_parser *r, struct orl_annual_target *target)
{
    const struct orl_annual_figure *figure = &target->figure;
    const char *unit =
        figure->aggregate == ORL_AGGREGATE_SHARE ? "%" : orl_annual_unit(figure->metric.kind);
    char what[64];
    if (!take_number(r, &target->bound))
        return report_wanted(r, "a number");
    const bool said = take_word(r, unit);
    snprintf(what, sizeof what, "the end, or the unit %s,", unit);
    skip_space(r);
    if (*r->at)
        return report_wanted(r, what);
    if (strcmp(unit, "%") != 0)
        return 0;
    if (target->bound > 100)
        return orl_error_set(r->err, ORL_ERR_RANGE, "'%s': %g %% is too large: the limit is 100",
                             r->text, target->bound);
    if (!said && target->bound > 0 && target->bound < 1) {
        orl_error_set(r->err, ORL_ERR_RANGE, "'%s': is that %g %% or %g %%?", r->text,
                      target->bound, 100 * target->bound);
        orl_error_hint(r->err, "write %% after the number");
        return ORL_ERR_RANGE;
    }
    return 0;
}

int orl_annual_target_parse(const char *text, struct orl_annual_target *ret_target,
                            struct orl_error *err)
{
    struct target_parser r = {.text = text, .at = text, .err = err};
    struct orl_annual_target target = {.grid = ""};
    if (strlen(text) >= ORL_TARGET_TEXT)
        return orl_error_set(err, ORL_ERR_LIMIT, "a target must have fewer than %d characters",
                             ORL_TARGET_TEXT);
    snprintf(target.text, sizeof target.text, "%s", text);
    int code = read_figure(&r, &target);
    if (code == 0)
        code = read_relation(&r, &target.relation);
    if (code == 0)
        code = read_bound(&r, &target);
    if (code == 0)
        *ret_target = target;
    return code;
}

/* ---- Verdicts -------------------------------------------------------------------------------- */

const char *orl_verdict_name(enum orl_verdict verdict)
{
    static const char *const names[] = {"fail", "undecided", "pass", "unknown"};
    return names[verdict];
}

static bool meets_bound(const struct orl_annual_target *target, double value)
{
    const double bound = target->bound, hair = 1e-9 * fmax(1, fabs(bound));
    switch (target->relation) {
    case ORL_AT_LEAST:
        return value >= bound - hair;
    case ORL_MORE_THAN:
        return value > bound + hair;
    case ORL_AT_MOST:
        return value <= bound + hair;
    default:
        return value < bound - hair;
    }
}

enum orl_verdict orl_annual_judge(const struct orl_annual_target *target,
                                  const struct orl_annual_value *value)
{
    if (isnan(value->low) || isnan(value->high))
        return ORL_VERDICT_UNKNOWN;
    const bool low = meets_bound(target, value->low), high = meets_bound(target, value->high);
    return low != high ? ORL_VERDICT_UNDECIDED : low ? ORL_VERDICT_PASS : ORL_VERDICT_FAIL;
}

bool orl_annual_is_decided(const struct orl_annual_target *target,
                           const struct orl_annual_value *value, double tolerance)
{
    const enum orl_verdict verdict = orl_annual_judge(target, value);
    return verdict == ORL_VERDICT_PASS || verdict == ORL_VERDICT_FAIL ||
           (value->low >= target->bound - tolerance && value->high <= target->bound + tolerance);
}

enum orl_verdict orl_verdict_combine(enum orl_verdict a, enum orl_verdict b)
{
    if (a == ORL_VERDICT_FAIL || b == ORL_VERDICT_FAIL)
        return ORL_VERDICT_FAIL;
    if (a == ORL_VERDICT_UNKNOWN || b == ORL_VERDICT_UNKNOWN)
        return ORL_VERDICT_UNKNOWN;
    return a == ORL_VERDICT_PASS ? b : a;
}
