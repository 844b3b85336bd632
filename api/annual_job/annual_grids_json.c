#include "annual_job/annual_members_json.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <oriel/base/limits.h>

#include "job/job_members_json.h"
#include "schemas.h"
#include "json/decode.h"

enum { NAME_MAX_BYTES = ORL_TARGET_GRID - 1 };

/* A grid of the document before its sensors are decoded. */
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
        {"name", .text = &draft->name},
        {"area", .real = &draft->area},
        {"sensors", .decode = note_value, .into = &draft->sensors},
        {0}};
    const int rc = orl_json_members(value, path, &orl_schema_annual_grid, members, err);
    if (rc == 0 && !draft->sensors)
        return orl_json_fail(err, ORL_ERR_INVALID, path, "the grid has no \"sensors\"");
    return rc;
}

/* Returns the file's name without folder and ending: "model/grid/desks.pts" gives "desks". */
static char *name_after(const char *file)
{
    const char *slash = strrchr(file, '/'), *from = slash ? slash + 1 : file;
    const char *dot = strrchr(from, '.');
    const size_t length = dot && dot > from ? (size_t)(dot - from) : strlen(from);
    return strndup(from, length < NAME_MAX_BYTES ? length : NAME_MAX_BYTES);
}

/* Returns the least power of two that is at least n_sensors. Capacity doubles because a document
 * may have many grids. */
static size_t room_for(size_t n_sensors)
{
    size_t room = 1;
    while (room < n_sensors)
        room *= 2;
    return room;
}

static int add_sensors(struct orl_annual_request *request, const struct orl_job *part,
                       struct orl_error *err)
{
    const size_t n = request->n_sensors + part->n_sensors;
    if (part->n_sensors == 0)
        return 0;
    if (!request->sensors || n > room_for(request->n_sensors)) {
        struct orl_sensor *grown = realloc(request->sensors, room_for(n) * sizeof *grown);
        if (!grown)
            return orl_error_no_memory(err);
        request->sensors = grown;
    }
    memcpy(request->sensors + request->n_sensors, part->sensors,
           part->n_sensors * sizeof *part->sensors);
    request->n_sensors = n;
    return 0;
}

/* Takes name, and the sensors file of part; copies part's sensors. */
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
            return orl_error_no_memory(err);
    }
    return add_sensors(request, part, err);
}

/* ---- Names ----------------------------------------------------------------------------------- */

/* File name of a grid, for finding clashes. */
struct file_name {
    char text[ORL_TARGET_GRID];
    const char *grid;
};

static int compare_names(const void *a, const void *b)
{
    const struct file_name *x = a, *y = b;
    const int order = strcmp(x->text, y->text);
    return order ? order : strcmp(x->grid, y->grid);
}

static int compare_files(const void *a, const void *b)
{
    return strcmp(((const struct file_name *)a)->text, ((const struct file_name *)b)->text);
}

/* Fails if a grid's file, such as NAME.direct.ill or NAME.se.ill, would also be a file of grid
 * NAME. */
static int check_ending(const struct file_name *names, size_t n, const char *ending,
                        struct orl_error *err)
{
    for (size_t i = 0; i < n; i++) {
        struct file_name bare = names[i];
        const size_t length = strlen(bare.text), cut = strlen(ending);
        if (length <= cut || strcmp(bare.text + length - cut, ending) != 0)
            continue;
        bare.text[length - cut] = '\0';
        if (bsearch(&bare, names, n, sizeof *names, compare_files))
            return orl_json_fail(
                err, ORL_ERR_INVALID, "grids",
                "a file of grid '%s' would have the same name as a file of grid '%s': rename one",
                bare.grid, bare.text);
    }
    return 0;
}

static int compare_neighbours(const struct file_name *names, size_t n, struct orl_error *err)
{
    for (size_t i = 1; i < n; i++) {
        const struct file_name *a = &names[i - 1], *b = &names[i];
        if (strcmp(a->text, b->text) != 0)
            continue;
        if (strcmp(a->grid, b->grid) == 0)
            return orl_json_fail(err, ORL_ERR_INVALID, "grids", "two grids are named '%s'",
                                 a->grid);
        return orl_json_fail(
            err, ORL_ERR_INVALID, "grids",
            "files of grid '%s' would have the same names as files of grid '%s': rename one",
            b->grid, a->grid);
    }
    return 0;
}

/* Checks that the grids' names, and the file names made from them, are unique. */
static int check_names(const struct orl_annual_request *request, struct orl_error *err)
{
    const size_t n = request->n_grids;
    struct file_name *names = calloc(n + 1, sizeof *names);
    if (!names)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < n; i++) {
        names[i].grid = request->grids[i].name;
        orl_annual_file_name(names[i].grid, names[i].text, sizeof names[i].text);
    }
    qsort(names, n, sizeof *names, compare_names);
    int rc = compare_neighbours(names, n, err);
    if (rc == 0)
        rc = check_ending(names, n, ".direct", err);
    if (rc == 0)
        rc = check_ending(names, n, ".se", err);
    free(names);
    return rc;
}

/* ---- Grids ----------------------------------------------------------------------------------- */

struct grids_decoder {
    const json_t *scene;
    enum orl_job_origin origin;
    struct orl_annual_job *job;
    char **scene_id;
};

/* Decodes the scene into a temporary job, as a render job's scene is, and moves the result. */
static int decode_scene(const struct grids_decoder *m, struct orl_error *err)
{
    struct orl_annual_request *request = &m->job->request;
    struct orl_job part = {0};
    const int rc = orl_job_scene_from_json(m->scene, "scene", m->origin, &part, m->scene_id, err);
    if (rc == 0) {
        request->scene_files = part.scene_files;
        request->n_scene_files = part.n_scene_files;
        part.scene_files = NULL;
        part.n_scene_files = 0;
    }
    orl_job_done(&part);
    return rc;
}

/* Takes name. */
static int decode_one_grid(const struct grids_decoder *m, char *name, const json_t *sensors,
                           const char *path, struct orl_error *err)
{
    struct orl_job part = {0};
    int rc = orl_job_sensors_from_json(sensors, path, &part, err);
    if (rc == 0 && part.n_sensors == 0 && !part.sensors_file)
        rc = orl_json_fail(err, ORL_ERR_INVALID, path, "there are no sensors");
    if (rc == 0)
        rc = add_grid(m->job, name, &part, err);
    else
        free(name);
    orl_job_done(&part);
    return rc;
}

static int make_room(struct orl_annual_job *job, size_t grids, struct orl_error *err)
{
    job->request.grids = calloc(grids, sizeof *job->request.grids);
    job->grid_files = calloc(grids, sizeof *job->grid_files);
    return job->request.grids && job->grid_files ? 0 : orl_error_no_memory(err);
}

/* Requires areas for all grids or for none. */
static int set_areas(const struct grid_draft *drafts, size_t n,
                     struct orl_report_request *report_request, struct orl_error *err)
{
    size_t known = 0;
    for (size_t i = 0; i < n; i++)
        known += drafts[i].area > 0;
    if (known == 0)
        return 0;
    if (known < n)
        return orl_json_fail(
            err, ORL_ERR_INVALID, "grids",
            "some grids have an \"area\" and some do not: give it for all or none");
    report_request->grid_area = calloc(n, sizeof *report_request->grid_area);
    if (!report_request->grid_area)
        return orl_error_no_memory(err);
    for (size_t i = 0; i < n; i++)
        report_request->grid_area[i] = drafts[i].area;
    return 0;
}

static int decode_grids(const struct grids_decoder *m, const json_t *list, struct orl_error *err)
{
    struct grid_draft *drafts = NULL;
    size_t n = 0;
    const struct orl_json_list grids = {
        .items = &drafts, .count = &n, .size = sizeof *drafts, .each = decode_grid};
    int rc = orl_json_list(list, "grids", &orl_schema_annual_grids, &grids, err);
    if (rc == 0)
        rc = make_room(m->job, n, err);
    if (rc == 0)
        rc = set_areas(drafts, n, &m->job->report_request, err);
    for (size_t i = 0; i < n && rc == 0; i++) {
        char path[ORL_JSON_PATH_MAX];
        char *name = drafts[i].name;
        drafts[i].name = NULL;
        snprintf(path, sizeof path, "grids[%zu].sensors", i);
        rc = decode_one_grid(m, name, drafts[i].sensors, path, err);
    }
    if (rc == 0)
        rc = check_names(&m->job->request, err);
    for (size_t i = 0; drafts && i < n; i++)
        free(drafts[i].name);
    free(drafts);
    return rc;
}

static int decode_only_sensors(const struct grids_decoder *m, const json_t *sensors,
                               struct orl_error *err)
{
    const int rc = make_room(m->job, 1, err);
    m->job->bare = true;
    return rc ? rc : decode_one_grid(m, NULL, sensors, "sensors", err);
}

int orl_annual_grids_from_json(const json_t *doc, enum orl_job_origin origin,
                               struct orl_annual_job *job, char **ret_scene_id,
                               struct orl_error *err)
{
    const json_t *grids = json_object_get(doc, "grids"), *sensors = json_object_get(doc, "sensors");
    const struct grids_decoder m = {json_object_get(doc, "scene"), origin, job, ret_scene_id};
    if (!m.scene)
        return orl_json_fail(err, ORL_ERR_INVALID, "scene", "the annual job names no scene");
    if (!grids == !sensors)
        return orl_json_fail(err, ORL_ERR_INVALID, "grids", "give either \"grids\" or \"sensors\"");
    const int rc = decode_scene(&m, err);
    if (rc)
        return rc;
    return grids ? decode_grids(&m, grids, err) : decode_only_sensors(&m, sensors, err);
}
