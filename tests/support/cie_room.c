#include "support/cie_room.h"

#include <stdio.h>

const struct cie_face cie_faces[CIE_FACES] = {
    [CIE_FLOOR] = {"floor", {0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {0, 0, 1}},
    [CIE_NORTH] = {"north", {0, 4, 0}, {4, 0, 0}, {0, 0, 3}, {0, -1, 0}},
    [CIE_WEST] = {"west", {0, 0, 0}, {0, 4, 0}, {0, 0, 3}, {1, 0, 0}},
    [CIE_EAST] = {"east", {4, 0, 0}, {0, 4, 0}, {0, 0, 3}, {-1, 0, 0}},
    [CIE_SOUTH] = {"south", {0, 0, 0}, {4, 0, 0}, {0, 0, 3}, {0, 1, 0}},
    [CIE_CEILING] = {"ceiling", {0, 0, 3}, {4, 0, 0}, {0, 4, 0}, {0, 0, -1}}};

void cie_hole_edges(const struct cie_hole *hole, struct orl_vec3 *ret_corner,
                    struct orl_vec3 *ret_a, struct orl_vec3 *ret_b)
{
    const struct cie_face *f = &cie_faces[hole->face];
    const double lu = orl_length(f->u), lv = orl_length(f->v);
    *ret_corner = orl_add(f->corner, orl_add(orl_scale(f->u, 0.5 - 0.5 * hole->w / lu),
                                             orl_scale(f->v, hole->from / lv)));
    *ret_a = orl_scale(f->u, hole->w / lu);
    *ret_b = orl_scale(f->v, hole->h / lv);
}

static size_t add_polygon(char *text, size_t size, size_t at, const char *modifier,
                          const char *name, const struct orl_vec3 *corners, int n)
{
    at += (size_t)snprintf(text + at, size - at, "%s polygon %s 0 0 %d", modifier, name, 3 * n);
    for (int i = 0; i < n; i++)
        at += (size_t)snprintf(text + at, size - at, " %.9g %.9g %.9g", corners[i].x, corners[i].y,
                               corners[i].z);
    at += (size_t)snprintf(text + at, size - at, "\n");
    return at;
}

size_t cie_room_text(char *text, size_t size, size_t at, const struct cie_hole *hole,
                     const char *pane)
{
    struct orl_vec3 p, a, b;
    for (int i = 0; i < CIE_FACES; i++) {
        const struct cie_face *f = &cie_faces[i];
        struct orl_vec3 c[10] = {f->corner, orl_add(f->corner, f->u),
                                 orl_add(orl_add(f->corner, f->u), f->v), orl_add(f->corner, f->v)};
        if (i != hole->face) {
            at = add_polygon(text, size, at, "w", f->name, c, 4);
            continue;
        }
        cie_hole_edges(hole, &p, &a, &b);
        const struct orl_vec3 inner[5] = {p, orl_add(p, b), orl_add(orl_add(p, a), b),
                                          orl_add(p, a), p};
        c[4] = c[0];
        for (int k = 0; k < 5; k++) /* along the seam, and in the opposite sense */
            c[5 + k] = inner[k];
        if (hole->w * hole->h < orl_length(orl_cross(f->u, f->v)) - 1e-9)
            at = add_polygon(text, size, at, "w", f->name, c, 10);
        const double turn = orl_dot(orl_cross(a, b), f->normal);
        const struct orl_vec3 outline[4] = {p, orl_add(p, turn > 0 ? a : b), inner[2],
                                            orl_add(p, turn > 0 ? b : a)};
        if (pane)
            at = add_polygon(text, size, at, pane, "pane", outline, 4);
    }
    return at;
}
