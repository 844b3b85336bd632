/* Writes models as matrices of a Klems basis. */
#include <stdlib.h>
#include <string.h>

#include "bsdf/fit/fit.h"
#include "bsdf/make/make_bsdf.h"
#include "bsdf/tree/shirley.h"
#include "bsdf/xml/bsdf_xml.h"

enum { LEVELS = 6, PARTS = 4 }; /* raster levels; parts a side of a raster cell */

/* Part of a raster cell that lies in a cell of the basis. */
struct share {
    uint32_t from, to;
    float weight; /* share of the basis's cell */
};

struct matrix_fit {
    const struct orl_bsdf_make_env *env;
    struct orl_fit_model *model;
    const struct orl_fit_raster *raster;
    const struct orl_basis *basis;
    struct orl_matrix *matrix;
    const struct share *shares; /* in the order of raster cells */
    size_t n_shares;
    int *codes;
};

/* ---- From the raster to the basis ------------------------------------------------------------ */

static struct orl_vec3 part_of(size_t cell, int part)
{
    const int row = part / PARTS;
    return orl_morton_direction((uint32_t)cell, LEVELS, (part % PARTS + 0.5) / PARTS,
                                (row + 0.5) / PARTS);
}

/* Returns the shares; weights of a basis's cell add up to 1. NULL if out of memory. */
static struct share *assign_shares(const struct orl_basis *basis, size_t cells, size_t *ret_n)
{
    struct share *shares = malloc(cells * PARTS * PARTS * sizeof *shares);
    double *sums = calloc((size_t)basis->n_cells, sizeof *sums);
    size_t n = 0;
    for (size_t cell = 0; cell < cells && shares && sums; cell++) {
        const size_t first = n;
        for (int part = 0; part < PARTS * PARTS; part++) {
            const int to = orl_basis_cell(basis, orl_polar_of(part_of(cell, part)), 0);
            size_t k = first;
            while (k < n && shares[k].to != (uint32_t)to)
                k++;
            if (k == n)
                shares[n++] = (struct share){(uint32_t)cell, (uint32_t)to, 0};
            shares[k].weight += 1;
            sums[to] += 1;
        }
    }
    for (size_t k = 0; k < n; k++)
        shares[k].weight = (float)((double)shares[k].weight / sums[shares[k].to]);
    if (!sums) {
        free(shares);
        shares = NULL;
    }
    free(sums);
    *ret_n = n;
    return shares;
}

/* ---- Incident cells -------------------------------------------------------------------------- */

/* Returns a direction from which light of an incident cell comes; cells hold directions of travel.
 * Isotropic samples are evaluated for light from -x, and the result is turned by the azimuth. */
static struct orl_vec3 incidence(const struct orl_basis *basis, int cell, int location)
{
    const double n = ORL_FIT_CELL_SAMPLES;
    const int row = location / ORL_FIT_CELL_SAMPLES;
    const struct orl_vec3 travel = orl_basis_direction(
        basis, cell, (location % ORL_FIT_CELL_SAMPLES + 0.5) / n, (row + 0.5) / n);
    return orl_v3(-travel.x, -travel.y, travel.z);
}

static void rotate_light(struct orl_fit_light *light, struct orl_vec3 in)
{
    const double r = hypot(in.x, in.y);
    const float cosine = (float)(r > 0 ? -in.x / r : 1), sine = (float)(r > 0 ? -in.y / r : 0);
    for (size_t i = 0; i < light->n; i++) {
        struct orl_fit_gaussian *gaussian = &light->gaussians[i];
        const float x = gaussian->x, y = gaussian->y;
        gaussian->x = cosine * x - sine * y;
        gaussian->y = sine * x + cosine * y;
    }
}

static bool locate_incident(const struct matrix_fit *f, struct orl_vec3 in,
                            struct orl_fit_location *location)
{
    const bool turned = f->model->mesh.isotropic;
    orl_fit_mesh_locate(&f->model->mesh, turned ? orl_v3(-hypot(in.x, in.y), 0, in.z) : in,
                        location);
    return turned;
}

static void fill_row(void *arg, size_t index, uint32_t member)
{
    enum { SAMPLES = ORL_FIT_CELL_SAMPLES * ORL_FIT_CELL_SAMPLES };
    const struct matrix_fit *f = arg;
    const size_t cells = (size_t)f->basis->n_cells;
    struct orl_fit_light light = {0};
    struct orl_fit_accumulator accumulator;
    bool fine = orl_fit_accumulator_make(f->raster, &accumulator);
    float *row = f->matrix->values + index * cells;
    (void)member;
    memset(row, 0, cells * sizeof *row);
    for (int i = 0; i < SAMPLES && fine; i++) {
        const struct orl_vec3 in = incidence(f->basis, (int)index, i);
        struct orl_fit_location location;
        const bool turned = locate_incident(f, in, &location);
        fine = orl_fit_interpolate(&f->model->mesh, &f->model->plans, &location, &light);
        if (!fine)
            break;
        if (turned)
            rotate_light(&light, in);
        orl_fit_rasterize(f->raster, &light, 0, &accumulator);
        for (size_t k = 0; k < f->n_shares; k++)
            row[f->shares[k].to] += (float)((double)f->shares[k].weight *
                                            accumulator.value[f->shares[k].from] / SAMPLES);
    }
    f->codes[index] = fine ? 0 : ORL_ERR_NOMEM;
    orl_fit_light_done(&light);
    orl_fit_accumulator_done(&accumulator);
}

static int request_plans(const struct matrix_fit *f, struct orl_error *err)
{
    for (int cell = 0; cell < f->basis->n_cells; cell++)
        for (int i = 0; i < ORL_FIT_CELL_SAMPLES * ORL_FIT_CELL_SAMPLES; i++) {
            struct orl_fit_location location;
            locate_incident(f, incidence(f->basis, cell, i), &location);
            if (!orl_fit_plans_request(&f->model->plans, &location))
                return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for transport plans");
        }
    return orl_fit_plans_make(&f->model->plans, &f->model->mesh, f->env->pool, f->env->cancel, err);
}

/* Returns the mirror image of a cell. */
static int mirrored(const struct orl_basis *basis, int cell, unsigned mirror)
{
    const struct orl_vec3 d = orl_basis_direction(basis, cell, 0.5, 0.5);
    const double sx = mirror & 1 ? -1 : 1, sy = mirror & 2 ? -1 : 1;
    return orl_basis_cell(basis, orl_polar_of(orl_v3(sx * d.x, sy * d.y, d.z)), 0);
}

/* Sets pairs of mirrored cells to their mean value. */
static void symmetrize(const struct matrix_fit *f, unsigned mirror)
{
    const int cells = f->basis->n_cells;
    float *values = f->matrix->values;
    for (int a = 0; a < cells; a++)
        for (int b = 0; b < cells; b++) {
            const size_t here = (size_t)a * (size_t)cells + (size_t)b;
            const size_t there = (size_t)mirrored(f->basis, a, mirror) * (size_t)cells +
                                 (size_t)mirrored(f->basis, b, mirror);
            if (there > here)
                values[here] = values[there] = 0.5F * (values[here] + values[there]);
        }
}

static double diffuse_of(const struct matrix_fit *f)
{
    const int cells = f->basis->n_cells;
    const float *value = f->matrix->values;
    double sum = 0;
    for (int a = 0; a < cells; a++)
        for (int b = 0; b < cells; b++)
            sum += (double)*value++ * orl_basis_ring(f->basis, a)->omega_sr *
                   orl_basis_ring(f->basis, b)->omega_sr;
    return sum / ORL_PI;
}

static int fill_matrix(struct matrix_fit *f, double *ret_diffuse, struct orl_error *err)
{
    const size_t cells = (size_t)f->basis->n_cells;
    unsigned mirrors[3];
    const size_t n_mirrors = orl_fit_mirrors(f->model->symmetry, mirrors);
    int code = orl_matrix_init(f->matrix, f->basis, f->basis, err);
    if (code == 0)
        code = request_plans(f, err);
    if (code < 0)
        return code;
    f->codes = calloc(cells, sizeof *f->codes);
    code = f->codes ? orl_parallel_try(f->env->pool, cells, fill_row, f) : ORL_ERR_NOMEM;
    for (size_t i = 0; i < cells && code == 0; i++)
        code = f->codes[i];
    free(f->codes);
    if (code < 0)
        return orl_error_set(
            err, code, code == ORL_ERR_CANCELLED ? "cancelled" : "out of memory for a matrix");
    for (size_t i = 0; i < n_mirrors; i++)
        symmetrize(f, mirrors[i]);
    *ret_diffuse = diffuse_of(f);
    return 0;
}

int orl_fit_write_klems(const struct orl_bsdf_fit_request *request,
                        const struct orl_bsdf_make_env *env, struct orl_fit_models *models,
                        struct orl_bsdf_fit_result *result, struct orl_error *err)
{
    struct orl_document document = {.structure = ORL_STRUCTURE_MATRIX};
    const struct orl_bsdf_labels labels = {0};
    struct orl_fit_raster raster;
    struct orl_basis basis;
    int code = orl_fit_raster_make(LEVELS, &raster, err);
    if (code < 0)
        return code;
    orl_basis_standard(orl_gonio_klems_name(result->basis), &basis);
    size_t n_shares;
    struct share *shares = assign_shares(&basis, raster.n_cells, &n_shares);
    if (!shares)
        code = orl_error_set(err, ORL_ERR_NOMEM, "out of memory for a matrix");
    for (int i = 0; i < 4 && code == 0; i++) {
        struct orl_component *part = &document.parts[orl_gonio_component_of[i / 2][i % 2]];
        struct matrix_fit f = {
            env, models->of[i / 2][i % 2], &raster, &basis, &part->matrix, shares, n_shares, NULL};
        if (!f.model)
            continue;
        part->present = true;
        code = fill_matrix(&f, &result->diffuse[i / 2][i % 2].value, err);
    }
    if (code == 0)
        code = orl_fit_write_xml(&document, &labels, request, result, err);
    orl_document_done(&document);
    free(shares);
    orl_fit_raster_done(&raster);
    return code;
}
