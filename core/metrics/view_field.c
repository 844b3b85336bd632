#include "metrics/glare_sources.h"

#include <stdbool.h>
#include <stdlib.h>

/* Returns the eye's frame: the view's, rotated about its up. */
static struct orl_frame eye_of(const struct orl_view *view, double turned_deg)
{
    const struct orl_vec3 right = orl_normalize(orl_cross(view->direction, view->up));
    const struct orl_vec3 up = orl_cross(right, view->direction);
    if (turned_deg == 0)
        return (struct orl_frame){right, up, view->direction};
    const double angle = turned_deg * ORL_DEG_TO_RAD;
    const struct orl_vec3 axis = orl_normalize(view->up);
    const struct orl_vec3 along = orl_scale(axis, orl_dot(axis, view->direction));
    const struct orl_vec3 level = orl_sub(view->direction, along);
    const struct orl_vec3 turned =
        orl_add(along, orl_add(orl_scale(level, cos(angle)),
                               orl_scale(orl_cross(axis, level), sin(angle))));
    const struct orl_vec3 aside = orl_normalize(orl_cross(turned, axis));
    return (struct orl_frame){aside, orl_cross(aside, turned), turned};
}

/* Computes the direction of a point of the picture, in the eye's axes. Returns false if the view
 * sees nothing there. */
static bool view_direction(const struct orl_view_field *f, double x, double y,
                           struct orl_vec3 *ret_direction)
{
    struct orl_vec3 origin, direction;
    if (!orl_view_ray(&f->view, x / f->width, 1 - y / f->height, &origin, &direction))
        return false;
    *ret_direction = orl_to_local(&f->eye, direction);
    return true;
}

/* Corner of the picture's pixel lattice. */
struct corner {
    struct orl_vec3 direction;
    bool seen;
};

static void compute_corners(const struct orl_view_field *f, uint32_t y, struct corner *row)
{
    for (uint32_t x = 0; x <= f->width; x++)
        row[x].seen = view_direction(f, x, y, &row[x].direction);
}

static void compute_row(struct orl_view_field *f, uint32_t y, const struct corner *above,
                        const struct corner *below)
{
    for (uint32_t x = 0; x < f->width; x++) {
        const size_t at = (size_t)y * f->width + x;
        const struct corner *a = &above[x], *b = &above[x + 1], *c = &below[x + 1], *d = &below[x];
        struct orl_vec3 middle;
        if (!view_direction(f, x + 0.5, y + 0.5, &middle))
            continue;
        f->direction[at][0] = (float)middle.x;
        f->direction[at][1] = (float)middle.y;
        f->direction[at][2] = (float)middle.z;
        if (!(middle.z >= 0) || !a->seen || !b->seen || !c->seen || !d->seen)
            continue;
        const double sr = orl_triangle_sr(a->direction, b->direction, c->direction) +
                          orl_triangle_sr(c->direction, d->direction, a->direction);
        f->solid_angle[at] = (float)sr;
        f->all_sr += sr;
    }
}

int orl_view_field_init(struct orl_view_field *field, const struct orl_view *view, uint32_t width,
                        uint32_t height, double turned_deg, struct orl_error *err)
{
    const size_t count = (size_t)width * height;
    *field = (struct orl_view_field){
        .width = width, .height = height, .view = *view, .eye = eye_of(view, turned_deg)};
    if (view->type == 'l')
        return orl_error_set(err, ORL_ERR_UNSUPPORTED,
                             "glare needs a perspective or fisheye view, not a parallel one");
    struct corner *rows = calloc(2 * ((size_t)width + 1), sizeof *rows);
    field->direction = calloc(count, sizeof *field->direction);
    field->solid_angle = calloc(count, sizeof *field->solid_angle);
    if (!rows || !field->direction || !field->solid_angle) {
        free(rows);
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory for the field of view");
    }
    struct corner *above = rows, *below = rows + width + 1;
    compute_corners(field, 0, above);
    for (uint32_t y = 0; y < height; y++) {
        struct corner *const done = above;
        compute_corners(field, y + 1, below);
        compute_row(field, y, above, below);
        above = below;
        below = done;
    }
    free(rows);
    return 0;
}

void orl_view_field_done(struct orl_view_field *field)
{
    free(field->direction);
    free(field->solid_angle);
    field->direction = NULL;
    field->solid_angle = NULL;
}

struct orl_vec3 orl_view_field_direction_at(const struct orl_view_field *field, double x, double y)
{
    struct orl_vec3 direction;
    return view_direction(field, x, y, &direction) ? direction : orl_v3(0, 0, 1);
}
