#include <math.h>
#include <stdlib.h>

#include "scene/geometry/instances.h"
#include "scene/material/patterns/pattern.h"

/* Even-odd rule: counts the edges that a ray to the right crosses. */
static bool is_inside(const struct orl_glyph *glyph, double x, double y)
{
    bool inside = false;
    if (x < glyph->left || x > glyph->right || y < glyph->bottom || y > glyph->top)
        return false;
    for (int i = 0, last = glyph->n - 1; i < glyph->n; last = i++) {
        const unsigned char *const from = glyph->corners + 2 * (size_t)last;
        const unsigned char *const to = glyph->corners + 2 * (size_t)i;
        const double ax = from[0], ay = from[1], bx = to[0], by = to[1];
        if ((ay > y) != (by > y) && x < ax + (y - ay) / (by - ay) * (bx - ax))
            inside = !inside;
    }
    return inside;
}

/* Returns true if a place lies in one of the letters. */
static bool lettering_covers(const struct orl_lettering *text, struct orl_vec3 place)
{
    const struct orl_vec3 from = orl_sub(place, text->origin);
    const double x = orl_dot(from, text->right) * text->unit, y = orl_dot(from, text->down);
    if (!(x >= 0) || !(y >= 0) || !(y < (double)text->n_lines))
        return false;
    const struct orl_lettering_line *const line = &text->lines[(size_t)y];
    const double up = ((double)(size_t)y + 1 - y) * ORL_GLYPH_SIDE;
    for (size_t i = 0; i < line->n && x < line->width; i++)
        if (is_inside(line->letters[i].glyph, x - line->letters[i].at, up))
            return true;
    return false;
}

enum { LANES = ORL_FUNCTION_LANES };

void orl_pattern_free(struct orl_pattern *pattern)
{
    if (!pattern)
        return;
    orl_function_free(pattern->program.function);
    orl_function_free(pattern->program.values);
    if (pattern->role == ORL_PATTERN_LOBES) {
        const struct orl_pattern_lobes *const lobes = orl_lobe_functions_of(pattern);
        for (uint32_t i = 0; i < lobes->n_tables; i++)
            free(lobes->tables[i].values);
        free(lobes->tables);
    }
    free(pattern);
}

size_t orl_patterns_of(const struct orl_material *material,
                       struct orl_pattern *ret_patterns[ORL_MATERIAL_PATTERNS])
{
    enum { OWN = 4 };
    const struct orl_material *const mixed = orl_material_mixed(material);
    struct orl_pattern *const own[OWN] = {material->pattern, material->texture,
                                          mixed ? orl_mixture_of(material)->share : NULL,
                                          orl_material_roughness_pattern(material)};
    size_t n = 0;
    for (size_t i = 0; i < OWN; i++)
        if (own[i])
            ret_patterns[n++] = own[i];
    for (int i = 0; mixed && i < 2; i++)
        n += orl_patterns_of(&mixed[i], ret_patterns + n);
    return n;
}

static struct orl_vec3 turned(const struct orl_pattern *pattern, struct orl_vec3 v)
{
    return orl_v3(orl_dot(pattern->row[0], v), orl_dot(pattern->row[1], v),
                  orl_dot(pattern->row[2], v));
}

static void take_vector(double *inputs, enum orl_ray_input first, struct orl_vec3 v)
{
    inputs[first] = v.x;
    inputs[first + 1] = v.y;
    inputs[first + 2] = v.z;
}

enum orl_pattern_validity orl_pattern_run(const struct orl_function *function, const double *inputs,
                                          double *ret)
{
    const struct orl_function_outcome outcome =
        orl_function_at(function, orl_function_scratch_of_thread(), inputs, ret);
    return outcome.exceeded    ? ORL_PATTERN_TOO_LONG
           : outcome.undefined ? ORL_PATTERN_UNDEFINED
                               : ORL_PATTERN_VALID;
}

/* Reads all grids at a place. */
static void look_up(const struct orl_pattern *pattern, const double *place, double *ret_held)
{
    orl_grid_at(pattern->program.grids[0], place, ret_held);
    for (uint32_t i = 1; i < pattern->program.n_grids; i++) {
        double own[ORL_GRID_CHANNELS] = {ret_held[0]};
        if (pattern->program.grids[i] != pattern->program.grids[0])
            orl_grid_at(pattern->program.grids[i], place, own);
        ret_held[i] = own[0];
    }
}

static const uint32_t no_facet = UINT32_MAX; /* facet of hits on distant light */

/* Returns NULL if the surface's corners were not stored. */
const struct orl_surface *orl_pattern_surface(const struct orl_pattern *pattern,
                                              const struct orl_hit *hit)
{
    const struct orl_geometry *const g = pattern->geometry;
    const struct orl_parsed_scene *const d = pattern->parsed_scene;
    if (!g || hit->facet == no_facet)
        return NULL;
    const struct orl_surface *const surfaces =
        orl_facet_is_instanced(g, hit->facet)
            ? d->prototypes[orl_instance_of(g, hit->facet)->number].surfaces
            : d->surfaces;
    return surfaces ? &surfaces[orl_facet_surface(g, hit->facet)] : NULL;
}

void orl_pattern_corners(const struct orl_pattern *pattern, const struct orl_hit *hit,
                         double *ret_b, double *ret_c)
{
    const struct orl_surface *s = orl_pattern_surface(pattern, hit);
    const struct orl_vec3 ab = orl_sub(s->vertices[1], s->vertices[0]);
    const struct orl_vec3 ac = orl_sub(s->vertices[2], s->vertices[0]), n = orl_cross(ab, ac);
    const struct orl_vec3 ap = orl_sub(orl_add(hit->point, pattern->center), s->vertices[0]);
    const double n2 = orl_dot(n, n);
    *ret_b = orl_dot(orl_cross(ap, ac), n) / n2;
    *ret_c = orl_dot(orl_cross(ab, ap), n) / n2;
}

/* Returns the (u, v) that a mesh gives the place; 0 for other surfaces. */
static void find_place(const struct orl_pattern *pattern, const struct orl_hit *hit,
                       double ret_place[2])
{
    const struct orl_surface *const s = orl_pattern_surface(pattern, hit);
    const double *const at = s ? orl_surface_uv(s) : NULL;
    ret_place[0] = ret_place[1] = 0;
    if (!at)
        return;
    double b, c;
    orl_pattern_corners(pattern, hit, &b, &c);
    for (int k = 0; k < 2; k++)
        ret_place[k] = (1 - b - c) * at[k] + b * at[2 + k] + c * at[4 + k];
}

/* Mixes two colours by the first's share. The recursion is at most ORL_PATTERN_STEPS deep. */
static enum orl_pattern_validity mix_colors(const struct orl_pattern *pattern,
                                            const struct orl_hit *hit, struct orl_vec3 towards,
                                            double share, struct orl_rgb *ret_color)
{
    const struct orl_mixed *const mixed = orl_blend_of(pattern)->mixed;
    enum orl_pattern_validity validity = ORL_PATTERN_VALID;
    const double shares[2] = {share, 1 - share};
    *ret_color = orl_gray(0);
    for (int i = 0; i < 2; i++) {
        struct orl_rgb factor = orl_gray(1);
        if (mixed[i].pattern && shares[i] > 0) {
            const enum orl_pattern_validity own =
                orl_pattern_factor(mixed[i].pattern, hit, towards, &factor);
            validity = own > validity ? own : validity;
        }
        const struct orl_rgb color = orl_rgb_mul(mixed[i].color, factor);
        *ret_color = orl_rgb_add(*ret_color, orl_rgb_scale(color, shares[i]));
    }
    return validity;
}

void orl_pattern_set_direction(const struct orl_pattern *pattern, double *inputs,
                               enum orl_ray_input first, struct orl_vec3 direction)
{
    take_vector(inputs, first, orl_scale(turned(pattern, direction), pattern->scale));
}

void orl_pattern_inputs(const struct orl_pattern *pattern, const struct orl_hit *hit,
                        struct orl_vec3 towards, double inputs[ORL_RAY_INPUTS])
{
    take_vector(inputs, ORL_RAY_PX,
                orl_add(turned(pattern, orl_add(hit->point, pattern->center)), pattern->offset));
    orl_pattern_set_direction(pattern, inputs, ORL_RAY_NX, hit->normal);
    orl_pattern_set_direction(pattern, inputs, ORL_RAY_DX, orl_neg(towards));
    inputs[ORL_RAY_RDOT] = orl_dot(towards, hit->normal);
    if (pattern->uses_mesh_uv)
        find_place(pattern, hit, inputs + ORL_RAY_LU);
}

/* Evaluates the pattern's function, and its values function on what the grids hold. */
static enum orl_pattern_validity values_at(const struct orl_pattern *pattern,
                                           const struct orl_hit *hit, struct orl_vec3 towards,
                                           double values[ORL_GRID_AXES])
{
    double inputs[ORL_RAY_INPUTS];
    orl_pattern_inputs(pattern, hit, towards, inputs);
    enum orl_pattern_validity validity = orl_pattern_run(pattern->program.function, inputs, values);
    if (validity == ORL_PATTERN_VALID && pattern->program.values) {
        look_up(pattern, values, inputs + ORL_RAY_DATA);
        validity = orl_pattern_run(pattern->program.values, inputs, values);
    }
    return validity;
}

bool orl_pattern_values(const struct orl_pattern *pattern, const struct orl_hit *hit,
                        struct orl_vec3 towards, double ret_values[3])
{
    double values[ORL_GRID_AXES];
    if (values_at(pattern, hit, towards, values) != ORL_PATTERN_VALID)
        return false;
    for (int i = 0; i < (pattern->is_rgb ? 3 : 1); i++)
        ret_values[i] = values[i];
    return true;
}

/* Evaluates eight bands at once; the function takes the wavelength and the grid's value of each. */
static enum orl_pattern_validity add_bands(const struct orl_pattern *pattern, const double *inputs,
                                           double *place, uint32_t first,
                                           struct orl_tristimulus *seen)
{
    struct orl_function_lanes columns[ORL_RAY_INPUTS], values;
    double held[ORL_GRID_CHANNELS];
    const struct orl_pattern_spectrum *const spectrum = orl_spectrum_of(pattern);
    const uint32_t left = spectrum->n_bands - first, n = left < LANES ? left : LANES;
    for (uint32_t l = 0; l < n; l++) {
        const struct orl_spectral_band *const band = &spectrum->bands[first + l];
        for (int i = 0; i < ORL_RAY_DATA; i++)
            columns[i].at[l] = inputs[i];
        columns[ORL_RAY_DATA].at[l] = band->nm;
        if (pattern->program.n_grids > 0) {
            place[pattern->program.grids[0]->n_axes - 1] = band->nm;
            orl_grid_at(pattern->program.grids[0], place, held);
            columns[ORL_RAY_DATA_2].at[l] = held[0];
        }
    }
    const struct orl_function_outcome outcome = orl_function_evaluate(
        pattern->program.values, orl_function_scratch_of_thread(), columns, (1U << n) - 1, &values);
    for (uint32_t l = 0; l < n; l++) {
        const struct orl_tristimulus w = spectrum->bands[first + l].weight;
        seen->x += w.x * values.at[l];
        seen->y += w.y * values.at[l];
        seen->z += w.z * values.at[l];
    }
    return outcome.exceeded    ? ORL_PATTERN_TOO_LONG
           : outcome.undefined ? ORL_PATTERN_UNDEFINED
                               : ORL_PATTERN_VALID;
}

/* Returns a spectrum's factor. The function gives all coordinates of the grid except the last,
 * which is the wavelength. */
static enum orl_pattern_validity spectral_factor(const struct orl_pattern *pattern,
                                                 const struct orl_hit *hit, struct orl_vec3 towards,
                                                 struct orl_rgb *ret_factor)
{
    const uint32_t n_bands = orl_spectrum_of(pattern)->n_bands;
    double inputs[ORL_RAY_INPUTS], place[ORL_GRID_AXES];
    struct orl_tristimulus seen = {0, 0, 0};
    orl_pattern_inputs(pattern, hit, towards, inputs);
    enum orl_pattern_validity validity =
        pattern->program.function ? orl_pattern_run(pattern->program.function, inputs, place)
                                  : ORL_PATTERN_VALID;
    for (uint32_t i = 0; i < n_bands && validity == ORL_PATTERN_VALID; i += LANES)
        validity = add_bands(pattern, inputs, place, i, &seen);
    if (validity != ORL_PATTERN_VALID)
        return validity;
    if (!isfinite(seen.x) || !isfinite(seen.y) || !isfinite(seen.z))
        return ORL_PATTERN_UNDEFINED;
    *ret_factor = orl_tristimulus_rgb(seen);
    return ORL_PATTERN_VALID;
}

bool orl_pattern_of_angle(const struct orl_pattern *pattern, double cosine,
                          double ret_values[ORL_PATTERN_ANGLES])
{
    double inputs[ORL_RAY_INPUTS];
    inputs[ORL_RAY_RDOT] = cosine;
    inputs[ORL_RAY_RDOTP] = fabs(cosine);
    bool valued =
        orl_pattern_run(pattern->program.function, inputs, ret_values) == ORL_PATTERN_VALID;
    for (int i = 0; i < ORL_PATTERN_ANGLES; i++)
        valued = valued && isfinite(ret_values[i]);
    return valued;
}

void orl_pattern_make_constant(struct orl_pattern *pattern)
{
    const uint64_t own = ((uint64_t)1 << ORL_RAY_DATA) - 1;
    const struct orl_hit hit = {.normal = {0, 0, 1}, .front = true};
    if ((pattern->program.function && orl_function_inputs(pattern->program.function) & own) ||
        orl_function_inputs(pattern->program.values) & own)
        return;
    struct orl_rgb factor;
    if (spectral_factor(pattern, &hit, hit.normal, &factor) != ORL_PATTERN_VALID)
        return;
    pattern->source = ORL_PATTERN_CONSTANT;
    pattern->as_source.constant = factor;
}

/* Blends by the first's share, which is 1 where the function has no value. */
static enum orl_pattern_validity blend(const struct orl_pattern *pattern, const struct orl_hit *hit,
                                       struct orl_vec3 towards, enum orl_pattern_validity validity,
                                       double value, struct orl_rgb *ret_factor)
{
    const bool valued = validity == ORL_PATTERN_VALID && isfinite(value);
    const double share = valued ? fmin(fmax(value, 0), 1) : 1;
    const enum orl_pattern_validity other = mix_colors(pattern, hit, towards, share, ret_factor);
    validity = valued                             ? ORL_PATTERN_VALID
               : validity > ORL_PATTERN_UNDEFINED ? validity
                                                  : ORL_PATTERN_UNDEFINED;
    return other > validity ? other : validity;
}

/* The factor that the program's values give. */
static enum orl_pattern_validity function_factor(const struct orl_pattern *pattern,
                                                 const struct orl_hit *hit, struct orl_vec3 towards,
                                                 struct orl_rgb *ret_factor)
{
    double values[ORL_GRID_AXES];
    const enum orl_pattern_validity validity = values_at(pattern, hit, towards, values);
    if (pattern->role == ORL_PATTERN_TEXTURE)
        return validity;
    if (pattern->role == ORL_PATTERN_BLEND)
        return blend(pattern, hit, towards, validity, values[0], ret_factor);
    if (validity != ORL_PATTERN_VALID)
        return validity;
    if (!pattern->is_rgb)
        values[1] = values[2] = values[0];
    if (!isfinite(values[0]) || !isfinite(values[1]) || !isfinite(values[2]))
        return ORL_PATTERN_UNDEFINED;
    *ret_factor = (struct orl_rgb){fmax(values[0], 0), fmax(values[1], 0), fmax(values[2], 0)};
    return ORL_PATTERN_VALID;
}

static enum orl_pattern_validity text_factor(const struct orl_pattern *pattern,
                                             const struct orl_hit *hit, struct orl_vec3 towards,
                                             struct orl_rgb *ret_factor)
{
    const struct orl_pattern_text *const text = orl_text_of(pattern);
    const bool covered = lettering_covers(text->lettering, orl_add(hit->point, pattern->center));
    if (pattern->role == ORL_PATTERN_BLEND)
        return blend(pattern, hit, towards, ORL_PATTERN_VALID, covered ? 1 : 0, ret_factor);
    *ret_factor = covered ? text->inside : text->around;
    return ORL_PATTERN_VALID;
}

/* The pattern's own factor, without the patterns under it; 1 where it has no value. */
static enum orl_pattern_validity own_factor(const struct orl_pattern *pattern,
                                            const struct orl_hit *hit, struct orl_vec3 towards,
                                            struct orl_rgb *ret_factor)
{
    *ret_factor = orl_gray(1);
    switch (pattern->source) {
    case ORL_PATTERN_FUNCTION:
        return function_factor(pattern, hit, towards, ret_factor);
    case ORL_PATTERN_CONSTANT:
        *ret_factor = orl_constant_of(pattern);
        break;
    case ORL_PATTERN_SPECTRUM:
        return spectral_factor(pattern, hit, towards, ret_factor);
    case ORL_PATTERN_TEXT:
        return text_factor(pattern, hit, towards, ret_factor);
    case ORL_PATTERN_MESH_NORMALS:
        break;
    }
    return ORL_PATTERN_VALID;
}

enum orl_pattern_validity orl_pattern_factor(const struct orl_pattern *pattern,
                                             const struct orl_hit *hit, struct orl_vec3 towards,
                                             struct orl_rgb *ret_factor)
{
    if (hit->instance > 0 && pattern->geometry && orl_hit_is_instanced(pattern->geometry, hit)) {
        const struct orl_hit read = orl_instance_to_prototype(pattern->geometry, hit);
        const struct orl_vec3 there = orl_instance_direction_in(pattern->geometry, hit, towards);
        return orl_pattern_factor(pattern, &read, there, ret_factor);
    }
    enum orl_pattern_validity validity = own_factor(pattern, hit, towards, ret_factor);
    for (const struct orl_pattern *p = pattern->under; p; p = p->under) {
        struct orl_rgb factor;
        const enum orl_pattern_validity other = own_factor(p, hit, towards, &factor);
        *ret_factor = orl_rgb_mul(*ret_factor, factor);
        validity = other > validity ? other : validity;
    }
    return validity;
}

struct orl_rgb orl_pattern_towards(const struct orl_pattern *pattern, const struct orl_hit *hit,
                                   struct orl_vec3 towards)
{
    struct orl_rgb factor = pattern->mean;
    if (!orl_hit_is_surface_mean(hit))
        orl_pattern_factor(pattern, hit, towards, &factor);
    return factor;
}

struct orl_hit orl_pattern_hit_of_sky(struct orl_vec3 direction)
{
    const double far = 1e10;
    return (struct orl_hit){.point = orl_scale(direction, far),
                            .normal = orl_neg(direction),
                            .facet = no_facet,
                            .front = true};
}

struct orl_rgb orl_pattern_of_sky(const struct orl_pattern *pattern, struct orl_vec3 direction)
{
    const struct orl_hit hit = orl_pattern_hit_of_sky(direction);
    return orl_pattern_towards(pattern, &hit, hit.normal);
}
