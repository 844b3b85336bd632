#include "view/view_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "chart/charts.h"
#include "schemas.h"
#include "json/encode.h"

/* ---- Request --------------------------------------------------------------------------------- */

int orl_sequence_from_json(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_sequence_request *request = into;
    const struct orl_json_member members[] = {{"frame_s", .real = &request->frame_s},
                                              {"columns", .whole_32 = &request->columns},
                                              {"picture_width", .whole_32 = &request->width_px},
                                              {0}};
    request->asked = true;
    return orl_json_members(value, path, &orl_schema_sequence, members, err);
}

/* ---- Results of a view under each sky -------------------------------------------------------- */

enum { PATH = 4096 };

/* Results of one view under all skies. */
struct view_sequence {
    const struct orl_job *job;
    const struct orl_view_request *view;
    const char *folder;
    size_t count;
    struct {
        const json_t *view, *sky; /* results of the view and the sky, borrowed */
        char path[PATH];          /* path of the frame's picture */
    } * parts;                    /* one per sky; owned, like the two arrays below */
    struct orl_sequence_frame *frames;
    struct orl_glare_hour *hours;
    bool has_dgp;
};

static void view_sequence_done(struct view_sequence *view_sequence)
{
    free(view_sequence->parts);
    free(view_sequence->frames);
    free(view_sequence->hours);
}

static const json_t *find_named(const json_t *list, const char *name)
{
    const json_t *entry;
    size_t i;
    json_array_foreach(list, i, entry)
    {
        const char *its = json_string_value(json_object_get(entry, "name"));
        if (its && strcmp(its, name) == 0)
            return entry;
    }
    return NULL;
}

static int path_of(const struct view_sequence *view_sequence, const char *what, char ret_path[PATH],
                   struct orl_error *err)
{
    const int length = snprintf(ret_path, PATH, "%s/sequence.%s.%s", view_sequence->folder,
                                view_sequence->view->name, what);
    return length >= 0 && length < PATH
               ? 0
               : orl_error_set(err, ORL_ERR_LIMIT, "the path of the results is too long");
}

/* Writes "22 Mar 11:30", "11:30" without the day, or the sky's name. */
static void format_time(const struct orl_named_sky *sky, bool with_day, char *ret_text, size_t size)
{
    static const char *const months[] = {"Jan", "Feb", "Mar", "Apr", "May", "Jun",
                                         "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
    const struct orl_sky_request *r = &sky->request;
    const int minutes = (int)floor(60 * r->hour + 1e-6);
    if (!r->time_given || r->month < 1 || r->month > 12)
        snprintf(ret_text, size, "%s", sky->name);
    else if (with_day)
        snprintf(ret_text, size, "%d %s %02d:%02d", r->day, months[r->month - 1], minutes / 60,
                 minutes % 60);
    else
        snprintf(ret_text, size, "%02d:%02d", minutes / 60, minutes % 60);
}

static bool is_one_day(const struct orl_job *job)
{
    const struct orl_sky_request *first = &job->skies[0].request;
    for (size_t i = 0; i < job->n_skies; i++) {
        const struct orl_sky_request *r = &job->skies[i].request;
        if (!r->time_given || r->month != first->month || r->day != first->day)
            return false;
    }
    return true;
}

static double real_or_nan(const json_t *value)
{
    return json_is_number(value) ? json_number_value(value) : NAN;
}

static enum orl_glare_class class_named(const char *name)
{
    int i = ORL_GLARE_UNDECIDED;
    while (i > 0 && !(name && strcmp(name, orl_glare_class_name((enum orl_glare_class)i)) == 0))
        i--;
    return (enum orl_glare_class)i;
}

static void read_hour(const struct view_sequence *view_sequence, size_t i, bool one_day)
{
    const struct orl_named_sky *sky = &view_sequence->job->skies[i];
    const json_t *glare = json_object_get(view_sequence->parts[i].view, "glare");
    const json_t *dgp = json_object_get(json_object_get(glare, "metrics"), "dgp");
    const json_t *interval = json_object_get(dgp, "interval_95");
    struct orl_glare_hour *hour = &view_sequence->hours[i];
    *hour = (struct orl_glare_hour){
        .hour = one_day ? sky->request.hour : NAN,
        .dgp = real_or_nan(json_object_get(dgp, "value")),
        .low = real_or_nan(json_array_get(interval, 0)),
        .high = real_or_nan(json_array_get(interval, 1)),
        .class_of = class_named(json_string_value(json_object_get(glare, "class"))),
        .dark = json_is_true(json_object_get(view_sequence->parts[i].sky, "dark"))};
    format_time(sky, !one_day, hour->label, sizeof hour->label);
}

/* Writes the captions below a picture: the time, and its glare. */
static void write_lines(const struct view_sequence *view_sequence, size_t i)
{
    const struct orl_glare_hour *h = &view_sequence->hours[i];
    char(*lines)[ORL_SEQUENCE_TEXT] = view_sequence->frames[i].lines;
    format_time(&view_sequence->job->skies[i], true, lines[0], sizeof lines[0]);
    const double margin = ceil(1000 * (h->high - h->low) / 2 - 1e-6) / 1000;
    if (h->dark)
        snprintf(lines[1], sizeof lines[1], "no light from the sky");
    else if (isfinite(h->dgp) && isfinite(margin))
        snprintf(lines[1], sizeof lines[1], "DGP %.3f \xc2\xb1 %.3f, %s", h->dgp, margin,
                 orl_glare_class_name(h->class_of));
    else if (isfinite(h->dgp))
        snprintf(lines[1], sizeof lines[1], "DGP %.3f, %s", h->dgp,
                 orl_glare_class_name(h->class_of));
}

static int read_sky(struct view_sequence *view_sequence, size_t i, const json_t *results,
                    bool one_day, struct orl_error *err)
{
    const char *name = view_sequence->job->skies[i].name;
    char what[128];
    view_sequence->parts[i].sky = find_named(json_object_get(results, "skies"), name);
    view_sequence->parts[i].view = find_named(json_object_get(view_sequence->parts[i].sky, "views"),
                                              view_sequence->view->name);
    const char *picture = json_string_value(json_object_get(view_sequence->parts[i].view, "hdr"));
    if (!picture)
        return orl_error_set(err, ORL_ERR_INTERNAL, "there is no picture of '%s' under '%s'",
                             view_sequence->view->name, name);
    snprintf(what, sizeof what, "frame-%.64s.png", name);
    view_sequence->frames[i].picture = picture;
    view_sequence->frames[i].shown = view_sequence->parts[i].path;
    read_hour(view_sequence, i, one_day);
    view_sequence->has_dgp = view_sequence->has_dgp || isfinite(view_sequence->hours[i].dgp);
    write_lines(view_sequence, i);
    return path_of(view_sequence, what, view_sequence->parts[i].path, err);
}

static int view_sequence_init(struct view_sequence *view_sequence, const struct orl_job *job,
                              size_t view, const char *folder, const json_t *results,
                              struct orl_error *err)
{
    const size_t n = job->n_skies;
    *view_sequence =
        (struct view_sequence){.job = job, .view = &job->views[view], .folder = folder, .count = n};
    view_sequence->parts = calloc(n + 1, sizeof *view_sequence->parts);
    view_sequence->frames = calloc(n + 1, sizeof *view_sequence->frames);
    view_sequence->hours = calloc(n + 1, sizeof *view_sequence->hours);
    if (!view_sequence->parts || !view_sequence->frames || !view_sequence->hours)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a sequence");
    int rc = 0;
    for (size_t i = 0; i < n && rc == 0; i++)
        rc = read_sky(view_sequence, i, results, is_one_day(job), err);
    return rc;
}

/* ---- Output ---------------------------------------------------------------------------------- */

static int draw_pictures(const struct view_sequence *view_sequence, const atomic_bool *cancel,
                         struct orl_error *err)
{
    const struct orl_files files = orl_files_from_folder(view_sequence->folder);
    char title[192], sheet[PATH], animation[PATH];
    struct orl_sequence sequence = {.files = &files,
                                    .display = &view_sequence->view->display,
                                    .how = &view_sequence->job->sequence,
                                    .frames = view_sequence->frames,
                                    .n_frames = view_sequence->count,
                                    .title = title,
                                    .sheet = sheet,
                                    .animation = animation,
                                    .cancel = cancel};
    snprintf(title, sizeof title, "%.100s, in one common exposure", view_sequence->view->name);
    int rc = path_of(view_sequence, "sheet.png", sheet, err);
    if (rc == 0)
        rc = path_of(view_sequence, "animation.png", animation, err);
    return rc ? rc : orl_sequence_write(&sequence, err);
}

static int draw_chart(const struct view_sequence *view_sequence, enum orl_canvas_kind kind,
                      const char *what, struct orl_error *err)
{
    char title[192], day[40] = "", path[PATH];
    if (is_one_day(view_sequence->job)) {
        format_time(&view_sequence->job->skies[0], true, day, sizeof day);
        *strrchr(day, ' ') = '\0'; /* cuts the hour off */
    }
    snprintf(title, sizeof title, "Glare in '%.100s'%s%s", view_sequence->view->name,
             day[0] ? ", " : "", day);
    const int rc = path_of(view_sequence, what, path, err);
    return rc ? rc
              : orl_glare_chart_write(view_sequence->hours, view_sequence->count, title, kind, path,
                                      err);
}

/* Encodes the file names, without the folder. */
static json_t *view_sequence_to_json(const struct view_sequence *view_sequence)
{
    const char *name = view_sequence->view->name;
    json_t *frames = json_array();
    for (size_t i = 0; i < view_sequence->count; i++)
        json_array_append_new(frames, json_sprintf("sequence.%s.frame-%s.png", name,
                                                   view_sequence->job->skies[i].name));
    json_t *json = json_pack("{s:s, s:o, s:o, s:o}", "view", name, "frames", frames, "sheet",
                             json_sprintf("sequence.%s.sheet.png", name), "animation",
                             json_sprintf("sequence.%s.animation.png", name));
    int rc = json && json_array_size(frames) == view_sequence->count ? 0 : -1;
    if (rc == 0 && view_sequence->has_dgp)
        rc = json_object_set_new(json, "dgp_png", json_sprintf("sequence.%s.dgp.png", name)) |
             json_object_set_new(json, "dgp_svg", json_sprintf("sequence.%s.dgp.svg", name));
    return orl_json_checked(json, rc);
}

static int draw_view(const struct orl_job *job, size_t view, const char *folder,
                     const atomic_bool *cancel, const json_t *results, json_t *list,
                     struct orl_error *err)
{
    struct view_sequence view_sequence;
    int rc = view_sequence_init(&view_sequence, job, view, folder, results, err);
    if (rc == 0)
        rc = draw_pictures(&view_sequence, cancel, err);
    if (rc == 0 && view_sequence.has_dgp)
        rc = draw_chart(&view_sequence, ORL_CANVAS_PNG, "dgp.png", err);
    if (rc == 0 && view_sequence.has_dgp)
        rc = draw_chart(&view_sequence, ORL_CANVAS_SVG, "dgp.svg", err);
    if (rc == 0 && json_array_append_new(list, view_sequence_to_json(&view_sequence)))
        rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a sequence");
    view_sequence_done(&view_sequence);
    return rc;
}

int orl_sequence_draw(const struct orl_job *job, const char *folder, const atomic_bool *cancel,
                      json_t *results, struct orl_error *err)
{
    if (!job->sequence.asked)
        return 0;
    json_t *list = json_array();
    int rc = list ? 0 : orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a sequence");
    for (size_t i = 0; i < job->n_views && rc == 0; i++)
        rc = draw_view(job, i, folder, cancel, results, list, err);
    if (rc == 0 && json_object_set(results, "sequence", list))
        rc = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a sequence");
    json_decref(list);
    return rc;
}
