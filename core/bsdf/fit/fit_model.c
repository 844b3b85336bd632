#include "bsdf/fit/fit_model.h"

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
    if (!model)
        return;
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
