/* Model of one component, and its leave-one-out errors. */
#include "bsdf/fit/fit.h"

#include <stdlib.h>
#include <string.h>

size_t orl_fit_mirrors(enum orl_bsdf_fit_symmetry symmetry, unsigned ret_mirrors[3])
{
    enum { X = 1, Y = 2 };
    switch (symmetry) {
    case ORL_BSDF_FIT_QUADRILATERAL:
        ret_mirrors[0] = X;
        ret_mirrors[1] = Y;
        ret_mirrors[2] = X | Y;
        return 3;
    case ORL_BSDF_FIT_LEFT_RIGHT:
        ret_mirrors[0] = X;
        return 1;
    case ORL_BSDF_FIT_UP_DOWN:
        ret_mirrors[0] = Y;
        return 1;
    case ORL_BSDF_FIT_HALF_TURN:
        ret_mirrors[0] = X | Y;
        return 1;
    default:
        return 0;
    }
}

void orl_fit_model_done(struct orl_fit_model *model)
{
    for (size_t i = 0; i < model->n; i++)
        orl_fit_shape_done(&model->shapes[i]);
    free(model->shapes);
    free(model->image_of);
    orl_fit_mesh_done(&model->mesh);
    orl_fit_plans_done(&model->plans);
    memset(model, 0, sizeof *model);
}

/* Returns true if a direction is already present; its image is then not added. */
static bool is_taken(const struct orl_fit_model *m, struct orl_vec3 in)
{
    const double near = cos(0.3 * ORL_DEG_TO_RAD);
    for (size_t i = 0; i < m->n; i++)
        if (orl_dot(m->shapes[i].in, in) > near)
            return true;
    return false;
}

static bool add_image(struct orl_fit_model *m, size_t of, unsigned mirror)
{
    const double sx = mirror & 1 ? -1 : 1, sy = mirror & 2 ? -1 : 1;
    const struct orl_vec3 in = m->shapes[of].in;
    if (is_taken(m, orl_v3(sx * in.x, sy * in.y, in.z)))
        return true;
    if (!orl_fit_shape_mirror(&m->shapes[of], mirror, &m->shapes[m->n]))
        return false;
    m->image_of[m->n++] = (uint32_t)of;
    return true;
}

/* Isotropic samples: adds images of the two directions nearest the normal before the row, so that
 * the first one has neighbours on both sides. */
static bool add_row_images(struct orl_fit_model *m)
{
    bool fine = true;
    for (size_t i = 0; i < m->n_own && fine; i++) {
        size_t nearer = 0;
        for (size_t k = 0; k < m->n_own; k++)
            nearer += m->shapes[k].in.z > m->shapes[i].in.z;
        if (nearer < 2)
            fine = add_image(m, i, 1);
    }
    return fine;
}

static bool add_images(struct orl_fit_model *m)
{
    unsigned mirrors[3];
    const size_t n_mirrors = orl_fit_mirrors(m->symmetry, mirrors);
    struct orl_fit_shape *shapes = realloc(m->shapes, (n_mirrors + 3) * m->n * sizeof *shapes);
    m->image_of = malloc((n_mirrors + 3) * m->n * sizeof *m->image_of);
    if (shapes)
        m->shapes = shapes;
    if (!shapes || !m->image_of)
        return false;
    for (size_t i = 0; i < m->n_own; i++)
        m->image_of[i] = (uint32_t)i;
    bool fine = true;
    for (size_t k = 0; k < n_mirrors; k++)
        for (size_t i = 0; i < m->n_own && fine; i++)
            fine = add_image(m, i, mirrors[k]);
    if (m->symmetry == ORL_BSDF_FIT_ISOTROPIC && fine)
        fine = add_row_images(m);
    return fine;
}

int orl_fit_model_make(struct orl_fit_shape *shapes, size_t n, enum orl_bsdf_fit_symmetry symmetry,
                       struct orl_fit_model *ret_model, struct orl_error *err)
{
    struct orl_fit_model m = {.symmetry = symmetry, .shapes = shapes, .n_own = n, .n = n};
    const struct orl_fit_shape **all = NULL;
    int code = add_images(&m) ? 0 : ORL_ERR_NOMEM;
    if (code == 0) {
        all = malloc(m.n * sizeof(void *));
        code = all ? 0 : ORL_ERR_NOMEM;
    }
    if (code < 0)
        orl_error_set(err, code, "out of memory for incident directions");
    for (size_t i = 0; i < m.n && code == 0; i++)
        all[i] = &m.shapes[i];
    if (code == 0)
        code = orl_fit_mesh_make(all, m.n, symmetry == ORL_BSDF_FIT_ISOTROPIC, &m.mesh, err);
    free(all);
    if (code == 0)
        *ret_model = m;
    else
        orl_fit_model_done(&m);
    return code;
}

/* ---- Leave-one-out errors: each incident direction predicted from the others ----------------- */

/* Blur before comparison: two Gaussians of this width overlap by roughly the light within 5
 * degrees. */
static const double blur_rad = 2.5 * ORL_DEG_TO_RAD;
enum { LEVELS = 6 };

struct cross_validation {
    const struct orl_fit_model *model;
    const struct orl_bsdf_make_env *env;
    const struct orl_fit_raster *raster;
    struct orl_bsdf_fit_scan *scans;
    int *codes;
};

/* Returns true for a direction within the border of the others, where no extrapolation is
 * needed. */
static bool is_inside(const struct orl_fit_location *location)
{
    return orl_dot(location->at, location->in) > cos(0.1 * ORL_DEG_TO_RAD);
}

static double sum_of(const struct orl_fit_raster *raster, const double *values)
{
    double sum = 0;
    for (size_t i = 0; i < raster->n_cells; i++)
        sum += values[i] * raster->area;
    return sum;
}

/* Rasterises both lights; returns the share of one that is not where the other is. */
static double misplaced_share(const struct cross_validation *l,
                              const struct orl_fit_light *predicted_light,
                              const struct orl_fit_light *measured_light,
                              struct orl_fit_accumulator accumulators[2])
{
    double off = 0;
    orl_fit_rasterize(l->raster, predicted_light, blur_rad, &accumulators[0]);
    orl_fit_rasterize(l->raster, measured_light, blur_rad, &accumulators[1]);
    const double a = sum_of(l->raster, accumulators[0].value),
                 b = sum_of(l->raster, accumulators[1].value);
    if (!(a > 0) || !(b > 0))
        return 1;
    for (size_t i = 0; i < l->raster->n_cells; i++)
        off += fabs(accumulators[0].value[i] / a - accumulators[1].value[i] / b) * l->raster->area;
    return 0.5 * off;
}

static int compare_prediction(const struct cross_validation *l, const struct orl_fit_mesh *rest,
                              const struct orl_fit_location *location,
                              const struct orl_fit_plans *plans, size_t which)
{
    const struct orl_fit_mesh *mesh = &l->model->mesh;
    const struct orl_fit_plans none = {0};
    struct orl_fit_light lights[2] = {{0}};
    struct orl_fit_accumulator accumulators[2] = {{0}};
    struct orl_fit_location own = {.count = 1, .weight = {1}, .lean = {1}};
    struct orl_bsdf_fit_scan *scan = &l->scans[which];
    const struct orl_fit_shape *shape = &l->model->shapes[which];
    while (mesh->shapes[own.corner[0]] != shape)
        own.corner[0]++;
    own.in = own.at = shape->in;
    for (int k = 0; k < ORL_FIT_KINDS; k++)
        own.mass[k] = shape->parts[k].mass;
    own.mass[ORL_FIT_KINDS] = ORL_PI * shape->floor;
    const bool fine = orl_fit_accumulator_make(l->raster, &accumulators[0]) &&
                      orl_fit_accumulator_make(l->raster, &accumulators[1]) &&
                      orl_fit_interpolate(rest, plans, location, &lights[0]) &&
                      orl_fit_interpolate(mesh, &none, &own, &lights[1]);
    if (fine) {
        scan->left_out = true;
        scan->predicted = 0;
        for (int k = 0; k < ORL_FIT_MASSES; k++)
            scan->predicted += location->mass[k];
        scan->misplaced = misplaced_share(l, &lights[0], &lights[1], accumulators);
    }
    for (int i = 0; i < 2; i++) {
        orl_fit_light_done(&lights[i]);
        orl_fit_accumulator_done(&accumulators[i]);
    }
    return fine ? 0 : ORL_ERR_NOMEM;
}

/* Makes the mesh of all directions except one and its images. */
static int make_rest(const struct orl_fit_model *m, size_t which, struct orl_fit_mesh *ret_rest)
{
    const struct orl_fit_shape **shapes = malloc(m->n * sizeof(void *));
    size_t n = 0;
    if (!shapes)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < m->n; i++)
        if (m->image_of[i] != which)
            shapes[n++] = &m->shapes[i];
    const int code =
        n > 1 ? orl_fit_mesh_make(shapes, n, m->symmetry == ORL_BSDF_FIT_ISOTROPIC, ret_rest, NULL)
              : ORL_ERR_INVALID;
    free(shapes);
    return code;
}

static void leave_one_out(void *arg, size_t index, uint32_t member)
{
    const struct cross_validation *l = arg;
    struct orl_fit_mesh rest = {0};
    struct orl_fit_plans plans = {0};
    struct orl_fit_location location;
    int code = make_rest(l->model, index, &rest);
    (void)member;
    if (code == 0) {
        orl_fit_mesh_locate(&rest, l->model->shapes[index].in, &location);
        if (!is_inside(&location))
            code = ORL_ERR_INVALID;
    }
    if (code == 0)
        code = orl_fit_plans_request(&plans, &location) ? 0 : ORL_ERR_NOMEM;
    if (code == 0)
        code = orl_fit_plans_make(&plans, &rest, NULL, l->env->cancel, NULL);
    if (code == 0)
        code = compare_prediction(l, &rest, &location, &plans, index);
    orl_fit_plans_done(&plans);
    orl_fit_mesh_done(&rest);
    l->codes[index] = code == ORL_ERR_INVALID ? 0 : code; /* no directions surround it: skipped */
}

int orl_fit_leave_one_out(const struct orl_fit_model *model, const struct orl_bsdf_make_env *env,
                          struct orl_bsdf_fit_scan *scans, struct orl_error *err)
{
    struct orl_fit_raster raster;
    int code = orl_fit_raster_make(LEVELS, &raster, err);
    if (code < 0)
        return code;
    struct cross_validation cross_validation = {
        model, env, &raster, scans, calloc(model->n_own, sizeof *cross_validation.codes)};
    code = cross_validation.codes
               ? orl_parallel_try(env->pool, model->n_own, leave_one_out, &cross_validation)
               : ORL_ERR_NOMEM;
    for (size_t i = 0; i < model->n_own && code == 0; i++)
        code = cross_validation.codes[i];
    free(cross_validation.codes);
    orl_fit_raster_done(&raster);
    return code == 0 ? 0
                     : orl_error_set(err, code,
                                     code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory");
}
