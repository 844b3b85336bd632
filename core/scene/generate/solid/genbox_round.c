/*
 * A box whose round edges are flat pieces: strips along the edges, and at the corners eighths of a
 * sphere, each recursively divided into four triangles. As in Radiance's program, faces are
 * collected and listed from the last to the first, numbered, without those of zero area.
 */
#include <stdio.h>
#include <stdlib.h>

#include "scene/generate/solid/genbox.h"

struct piece {
    struct orl_vec3 corners[4];
    unsigned n;
};

struct pieces {
    struct piece *items;
    size_t n;
};

static void add_piece(struct pieces *pieces, unsigned n, struct orl_vec3 a, struct orl_vec3 b,
                      struct orl_vec3 c, struct orl_vec3 d)
{
    pieces->items[pieces->n++] = (struct piece){{a, b, c, d}, n};
}

static struct orl_vec3 along(unsigned axis, double length)
{
    return orl_v3(axis == 0 ? length : 0, axis == 1 ? length : 0, axis == 2 ? length : 0);
}

/* Returns the vector out of the box perpendicular to an edge, of the radius' length. */
static struct orl_vec3 outward(const struct orl_genbox *box, struct orl_vec3 point, unsigned axis)
{
    const double at = axis == 0 ? point.x : axis == 1 ? point.y : point.z;
    return along(axis, at < 0.5 * box->size[axis] ? -box->bevel : box->bevel);
}

static void add_edge(struct pieces *pieces, const struct orl_genbox *box, const char *edge)
{
    const struct orl_vec3 from = orl_box_corner(box, edge[0]), to = orl_box_corner(box, edge[1]);
    const unsigned differ = (orl_box_code(edge[0]) ^ orl_box_code(edge[1])) & 7;
    const unsigned axis = differ == 1 ? 0 : differ == 2 ? 1 : 2, n = 1U << box->level;
    const struct orl_vec3 first = outward(box, to, (axis + 2) % 3);
    const struct orl_vec3 last = outward(box, to, (axis + 1) % 3);
    const double step_rad = 0.5 * ORL_PI / n;
    struct orl_vec3 before = first;
    for (unsigned i = 1; i <= n; i++) {
        const struct orl_vec3 now =
            orl_add(orl_scale(first, cos(step_rad * i)), orl_scale(last, sin(step_rad * i)));
        add_piece(pieces, 4, orl_add(from, before), orl_add(to, before), orl_add(to, now),
                  orl_add(from, now));
        before = now;
    }
}

static struct orl_vec3 middle(struct orl_vec3 a, struct orl_vec3 b)
{
    return orl_normalize(orl_add(a, b));
}

/* Adds the part of a sphere between three directions. */
static void add_sphere_part(struct pieces *pieces, struct orl_vec3 center, double radius,
                            const struct orl_vec3 d[3], unsigned level)
{
    if (level == 0) {
        add_piece(pieces, 3, orl_madd(center, d[0], radius), orl_madd(center, d[1], radius),
                  orl_madd(center, d[2], radius), center);
        return;
    }
    const struct orl_vec3 m[3] = {middle(d[0], d[1]), middle(d[1], d[2]), middle(d[2], d[0])};
    for (unsigned i = 0; i < 3; i++)
        add_sphere_part(pieces, center, radius, (struct orl_vec3[3]){d[i], m[i], m[(i + 2) % 3]},
                        level - 1);
    add_sphere_part(pieces, center, radius, m, level - 1);
}

static void add_end(struct pieces *pieces, const struct orl_genbox *box, char letter)
{
    const unsigned code = orl_box_code(letter);
    const bool odd = ((code ^ code >> 1 ^ code >> 2) & 1) != 0;
    struct orl_vec3 d[3];
    for (unsigned axis = 0; axis < 3; axis++)
        d[axis] = along(axis, ((code >> axis & 1) != 0) != box->inverted ? 1 : -1);
    if (!odd) {
        const struct orl_vec3 x = d[0];
        d[0] = d[1];
        d[1] = x;
    }
    add_sphere_part(pieces, orl_box_corner(box, letter), box->bevel, d, box->level);
}

static double area(const struct piece *piece)
{
    struct orl_vec3 sum = {0, 0, 0};
    for (unsigned i = 2; i < piece->n; i++)
        sum = orl_add(sum, orl_cross(orl_sub(piece->corners[i - 1], piece->corners[0]),
                                     orl_sub(piece->corners[i], piece->corners[0])));
    return 0.5 * orl_length(sum);
}

static void write_pieces(const struct pieces *pieces, const struct orl_genbox *box,
                         struct orl_text *text)
{
    const double smallest = 1e-12;
    size_t number = 0;
    char part[24];
    for (size_t i = pieces->n; i-- > 0;) {
        const struct piece *piece = &pieces->items[i];
        if (area(piece) <= smallest)
            continue;
        snprintf(part, sizeof part, "%zu", ++number);
        orl_text_add_head(text, box->material, "polygon", box->name, part, 3 * (size_t)piece->n);
        for (unsigned k = 0; k < piece->n; k++)
            orl_text_add_point(text, piece->corners[k]);
        orl_text_add(text, "\n");
    }
}

int orl_genbox_pieces(const struct orl_genbox *box, struct orl_text *text, struct orl_error *err)
{
    const size_t most = 6 + ((size_t)12 << box->level) + ((size_t)8 << 2 * box->level);
    struct pieces pieces = {.items = malloc(most * sizeof *pieces.items)};
    if (!pieces.items)
        return orl_error_set(err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < 6; i++)
        add_piece(&pieces, 4, orl_box_corner(box, orl_box_inset[i][0]),
                  orl_box_corner(box, orl_box_inset[i][1]),
                  orl_box_corner(box, orl_box_inset[i][2]),
                  orl_box_corner(box, orl_box_inset[i][3]));
    for (size_t i = 0; i < 12; i++)
        add_edge(&pieces, box, orl_box_edges[i]);
    for (size_t i = 0; i < 8; i++)
        add_end(&pieces, box, orl_box_ends[i][0]);
    write_pieces(&pieces, box, text);
    free(pieces.items);
    return 0;
}
