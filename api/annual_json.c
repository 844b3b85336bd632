#include "annual_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/limits.h>

#include "members.h"

enum {
    TITLE_MAX = 90,
    NAME_MAX_BYTES = ORL_TARGET_GRID - 1,
    FILE_MAX_BYTES = 1024,
    GRIDS_MAX = 4096,
    LIST_MAX = 256,
    FIRST_ROUND = 256 /* paths, where accuracy is asked for */
};

void orl_annual_job_done(struct orl_annual_job *job)
{
    if (!job)
        return;
    for (size_t i = 0; job->grid_files && i < job->request.n_grids; i++)
        free(job->grid_files[i]);
    free(job->grid_files);
    free(job->title);
    orl_annual_request_done(&job->request);
    orl_annual_wishes_done(&job->wishes);
    *job = (struct orl_annual_job){.title = NULL};
}

/* ---- Grids ----------------------------------------------------------------------------------- */

/* A grid as it is written. */
struct grid_draft {
    const json_t *doc, *sensors;
    char *name;
    double area;
};

static int note_value(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    (void)path, (void)err;
    *(const json_t **)into = value;
    return 0;
}

static int decode_grid(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct grid_draft *draft = into;
    const struct orl_json_member members[] = {
        {"name", .text = &draft->name, .longest = NAME_MAX_BYTES},
        {"area", .real = &draft->area, .most = INFINITY, .above = true,
         .bounds = "a number above zero is wanted"},
        {"sensors", .decode = note_value, .into = &draft->sensors},
        {0}};
    const int rc = orl_json_members(value, path, members, err);
    if (rc == 0 && !draft->sensors)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "the grid has no \"sensors\"");
    return rc;
}

/* "model/grid/desks.pts" gives "desks". */
static char *name_after(const char *file)
{
    const char *slash = strrchr(file, '/'), *from = slash ? slash + 1 : file;
    const char *dot = strrchr(from, '.');
    const size_t length = dot && dot > from ? (size_t)(dot - from) : strlen(from);
    return strndup(from, length < NAME_MAX_BYTES ? length : NAME_MAX_BYTES);
}

static int add_sensors(struct orl_annual_request *request, const struct orl_job *part,
                       struct orl_error *err)
{
    const size_t n = request->n_sensors + part->n_sensors;
    if (part->n_sensors == 0)
        return 0;
    struct orl_sensor *grown = realloc(request->sensors, n * sizeof *grown);
    if (!grown)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    memcpy(grown + request->n_sensors, part->sensors, part->n_sensors * sizeof *grown);
    request->sensors = grown;
    request->n_sensors = n;
    return 0;
}

/* Takes the name over, and what it needs of part. */
static int add_grid(struct orl_annual_job *job, char *name, struct orl_job *part,
                    struct orl_error *err)
{
    struct orl_annual_request *request = &job->request;
    const size_t at = request->n_grids++;
    request->grids[at] = (struct orl_annual_grid){
        .name = name, .first = request->n_sensors, .count = part->n_sensors};
    job->grid_files[at] = part->sensors_file;
    part->sensors_file = NULL;
    if (!name) {
        request->grids[at].name = job->grid_files[at] ? name_after(job->grid_files[at]) : NULL;
        if (!request->grids[at].name && asprintf(&request->grids[at].name, "grid%zu", at + 1) < 0)
            return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    }
    for (size_t i = 0; i < at; i++)
        if (strcmp(request->grids[i].name, request->grids[at].name) == 0)
            return orl_error_set(err, ORL_ERR_INVALID, "two grids are named '%s'",
                                 request->grids[at].name);
    return add_sensors(request, part, err);
}

/* Scene and sensors are written, and decoded, as those of a job. */
static int decode_part(const json_t *scene, const json_t *sensors, const char *path,
                       enum orl_job_origin origin, struct orl_job *ret_part, char **ret_scene_id,
                       struct orl_error *err)
{
    json_t *doc = json_pack("{s:O, s:O}", "scene", scene, "sensors", sensors);
    struct orl_error found = {0};
    if (!doc)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    const int rc = orl_job_from_json(doc, origin, ret_part, ret_scene_id, &found);
    json_decref(doc);
    if (rc && err) {
        *err = found;
        if (path[0] && strncmp(found.primitive, "sensors", 7) == 0)
            orl_json_fail(err, rc, path, "%s", found.message);
    }
    return rc;
}

struct making {
    const json_t *scene;
    enum orl_job_origin origin;
    struct orl_annual_job *job;
    char **scene_id;
};

/* Of the first grid the scene is kept. */
static int take_grid(const struct making *m, char *name, const json_t *sensors, const char *path,
                     struct orl_error *err)
{
    struct orl_job part = {0};
    char *scene_id = NULL;
    int rc = decode_part(m->scene, sensors, path, m->origin, &part, &scene_id, err);
    if (rc) {
        free(name);
        return rc;
    }
    if (m->job->request.n_grids == 0) {
        m->job->request.scene_files = part.scene_files;
        m->job->request.n_scene_files = part.n_scene_files;
        part.scene_files = NULL;
        part.n_scene_files = 0;
        *m->scene_id = scene_id;
        scene_id = NULL;
    }
    rc = add_grid(m->job, name, &part, err);
    free(scene_id);
    orl_job_done(&part);
    return rc;
}

static int make_room(struct orl_annual_job *job, size_t grids, struct orl_error *err)
{
    job->request.grids = calloc(grids, sizeof *job->request.grids);
    job->grid_files = calloc(grids, sizeof *job->grid_files);
    return job->request.grids && job->grid_files
               ? 0
               : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

/* Areas are known of all grids, or of none. */
static int take_areas(const struct grid_draft *drafts, size_t n, struct orl_annual_wishes *wishes,
                      struct orl_error *err)
{
    size_t known = 0;
    for (size_t i = 0; i < n; i++)
        known += drafts[i].area > 0;
    if (known == 0)
        return 0;
    if (known < n)
        return orl_json_fail(err, ORL_ERR_INVALID, "grids",
                             "some have an \"area\" and some have not");
    wishes->grid_area = calloc(n, sizeof *wishes->grid_area);
    if (!wishes->grid_area)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < n; i++)
        wishes->grid_area[i] = drafts[i].area;
    return 0;
}

static int take_grids(const struct making *m, const json_t *list, struct orl_error *err)
{
    struct grid_draft *drafts = NULL;
    size_t n = 0;
    const struct orl_json_list grids = {.items = &drafts,
                                        .count = &n,
                                        .size = sizeof *drafts,
                                        .most = GRIDS_MAX,
                                        .each = decode_grid,
                                        .empty = "the list is empty"};
    int rc = orl_json_list(list, "grids", &grids, err);
    if (rc == 0)
        rc = make_room(m->job, n, err);
    if (rc == 0)
        rc = take_areas(drafts, n, &m->job->wishes, err);
    for (size_t i = 0; i < n && rc == 0; i++) {
        char path[ORL_JSON_PATH_MAX];
        char *name = drafts[i].name;
        drafts[i].name = NULL;
        snprintf(path, sizeof path, "grids[%zu].sensors", i);
        rc = take_grid(m, name, drafts[i].sensors, path, err);
    }
    for (size_t i = 0; drafts && i < n; i++)
        free(drafts[i].name);
    free(drafts);
    return rc;
}

static int take_sensors(const struct making *m, const json_t *sensors, struct orl_error *err)
{
    const int rc = make_room(m->job, 1, err);
    return rc ? rc : take_grid(m, NULL, sensors, "", err);
}

/* ---- Occupancy ------------------------------------------------------------------------------- */

static const char *const day_names[] = {"mon", "tue", "wed", "thu", "fri", "sat", "sun", NULL};

static int decode_day(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    unsigned day = 0;
    const struct orl_json_member word = {.word = &day, .words = day_names};
    const int rc = orl_json_value(value, path, &word, err);
    if (rc == 0)
        *(unsigned *)into |= 1U << day;
    return rc;
}

static int decode_days(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    unsigned days = 0;
    const int rc = orl_json_each(value, path, 7, decode_day, &days, err);
    if (rc == 0 && days == 0)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "no day of the week is named");
    if (rc == 0)
        *(unsigned *)into = days;
    return rc;
}

static int decode_occupancy(const json_t *value, const char *path, void *into,
                            struct orl_error *err)
{
    struct orl_annual_wishes *wishes = into;
    struct orl_occupancy *use = &wishes->occupancy;
    const struct orl_json_member members[] = {
        {"file", .text = &wishes->occupancy_file, .longest = FILE_MAX_BYTES},
        {"from", .real = &use->from_h, .least = 0, .most = 24},
        {"to", .real = &use->to_h, .least = 0, .most = 24},
        {"days", .decode = decode_days, .into = &use->days},
        {"first_day", .word = &use->first_day, .words = day_names},
        {0}};
    const int rc = orl_json_members(value, path, members, err);
    if (rc == 0 && wishes->occupancy_file && json_object_size(value) > 1)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "the file says all of it");
    return rc;
}

/* ---- Metrics, targets, rules ------------------------------------------------------------------
 */

/* A text, and what its parser makes of it. */
static int decode_words(const json_t *value, const char *path,
                        int (*parse)(const char *text, void *into, struct orl_error *err),
                        void *into, struct orl_error *err)
{
    struct orl_error found = {0};
    char *text = NULL;
    int rc = orl_json_string(value, path, LIST_MAX, &text, err);
    if (rc)
        return rc;
    rc = parse(text, into, &found);
    free(text);
    if (rc) {
        orl_json_fail(err, rc, path, "%s", found.message);
        orl_error_hint(err, "%s", found.hint);
    }
    return rc;
}

static int parse_metric(const char *text, void *into, struct orl_error *err)
{
    return orl_annual_metric_parse(text, into, err);
}

static int parse_target(const char *text, void *into, struct orl_error *err)
{
    return orl_annual_target_parse(text, into, err);
}

static int decode_metric(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return decode_words(value, path, parse_metric, into, err);
}

static int decode_target(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return decode_words(value, path, parse_target, into, err);
}

/* A name stands for all rules it begins. */
static int add_rules(const char *text, void *into, struct orl_error *err)
{
    struct orl_annual_wishes *wishes = into;
    const struct orl_annual_rule *first;
    size_t count;
    const int rc = orl_annual_rules_find(text, &first, &count, err);
    if (rc)
        return rc;
    const size_t n = wishes->n_rules + count;
    struct orl_annual_rule *grown = realloc(wishes->rules, n * sizeof *grown);
    if (!grown)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < count; i++)
        grown[wishes->n_rules + i] = first[i];
    wishes->rules = grown;
    wishes->n_rules = n;
    return 0;
}

static int decode_rule(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return decode_words(value, path, add_rules, into, err);
}

static int decode_rules(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    return orl_json_each(value, path, LIST_MAX / 8, decode_rule, into, err);
}

static int decode_metrics(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_annual_wishes *wishes = into;
    const struct orl_json_list list = {.items = &wishes->metrics,
                                       .count = &wishes->n_metrics,
                                       .size = sizeof *wishes->metrics,
                                       .most = LIST_MAX / 8,
                                       .each = decode_metric,
                                       .empty = "the list is empty"};
    free(wishes->metrics);
    wishes->metrics = NULL;
    wishes->n_metrics = 0;
    return orl_json_list(value, path, &list, err);
}

/* ---- The document ---------------------------------------------------------------------------- */

static int decode_until(const json_t *value, const char *path, void *into, struct orl_error *err)
{
    struct orl_annual_wishes *wishes = into;
    wishes->until = calloc(1, sizeof *wishes->until);
    return wishes->until ? decode_target(value, path, wishes->until, err)
                         : orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
}

static int decode_members(const json_t *doc, struct orl_annual_job *job, struct orl_error *err)
{
    struct orl_annual_request *request = &job->request;
    struct orl_annual_wishes *wishes = &job->wishes;
    const struct orl_json_list targets = {.items = &wishes->targets,
                                          .count = &wishes->n_targets,
                                          .size = sizeof *wishes->targets,
                                          .most = LIST_MAX,
                                          .each = decode_target};
    const struct orl_json_member accuracy[] = {
        {"verdict", .decode = decode_until, .into = wishes, .required = true}, {0}};
    const struct orl_json_member members[] = {
        {.name = "kind"},
        {"title", .text = &job->title, .longest = TITLE_MAX},
        {.name = "scene"}, /* and grids or sensors: read behind the rest */
        {.name = "grids"},
        {.name = "sensors"},
        {"weather", .text = &request->weather_file, .longest = FILE_MAX_BYTES, .required = true},
        {"north", .real = &request->north_deg, .least = -360, .most = 360},
        {"ground_reflectance", .real = &request->ground_reflectance, .least = 0, .most = 1},
        {"occupancy", .decode = decode_occupancy, .into = wishes},
        {"metrics", .decode = decode_metrics, .into = wishes},
        {"targets", .list = &targets},
        {"rules", .decode = decode_rules, .into = wishes},
        {"samples", .whole_32 = &request->samples, .from = 1, .to = ORL_ANNUAL_MOST_SAMPLES},
        {"seed", .whole = &request->seed, .from = 0, .to = INT64_MAX},
        {"accuracy", .members = accuracy},
        {.name = "priority"},
        {0}};
    const int rc = orl_json_members(doc, "", members, err);
    if (rc == 0 && wishes->until && request->samples == 0)
        request->samples = FIRST_ROUND;
    return rc;
}

static int decode(const json_t *doc, enum orl_job_origin origin, struct orl_annual_job *job,
                  char **ret_scene_id, struct orl_error *err)
{
    const json_t *grids = json_object_get(doc, "grids"), *sensors = json_object_get(doc, "sensors");
    const struct making m = {json_object_get(doc, "scene"), origin, job, ret_scene_id};
    const char *kind = json_string_value(json_object_get(doc, "kind"));
    if (json_is_object(doc) && (!kind || strcmp(kind, "annual") != 0))
        return orl_json_fail(err, ORL_ERR_INVALID, "kind", "a year says \"kind\": \"annual\"");
    const int rc = decode_members(doc, job, err);
    if (rc)
        return rc;
    if (!m.scene)
        return orl_json_fail(err, ORL_ERR_INVALID, "scene", "the year names no scene");
    if (!grids == !sensors)
        return orl_json_fail(err, ORL_ERR_INVALID, "grids",
                             "either \"grids\" or \"sensors\" are wanted");
    return grids ? take_grids(&m, grids, err) : take_sensors(&m, sensors, err);
}

int orl_annual_job_from_json(const json_t *doc, enum orl_job_origin origin,
                             struct orl_annual_job *ret_job, char **ret_scene_id,
                             struct orl_error *err)
{
    struct orl_annual_job job = {.title = NULL};
    char *scene_id = NULL;
    orl_annual_request_init(&job.request);
    int rc = orl_annual_wishes_init(&job.wishes);
    if (rc)
        orl_error_set(err, rc, "out of memory");
    else
        rc = decode(doc, origin, &job, &scene_id, err);
    if (rc) {
        orl_annual_job_done(&job);
        free(scene_id);
        return rc;
    }
    *ret_job = job;
    if (ret_scene_id)
        *ret_scene_id = scene_id;
    else
        free(scene_id);
    return 0;
}
