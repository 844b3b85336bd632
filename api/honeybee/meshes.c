#include "honeybee/model_objects.h"

#include <stdlib.h>

#include "honeybee/modifiers.h"

int orl_hb_mesh_corners(struct orl_hb *hb, const json_t *mesh, const struct orl_hb_at *at,
                        struct orl_vec3 **ret_corners, size_t *ret_count)
{
    const struct orl_hb_at list = {at, "vertices", 0};
    const json_t *vertices = NULL;
    int rc = orl_hb_array(hb, mesh, at, "vertices", &vertices);
    const size_t n = json_array_size(vertices);
    struct orl_vec3 *corners = malloc((n + 1) * sizeof *corners);
    if (rc == 0 && !corners)
        rc = orl_error_no_memory(hb->err);
    for (size_t i = 0; i < n && rc == 0; i++) {
        const struct orl_hb_at here = {&list, NULL, i};
        rc = orl_hb_point(hb, json_array_get(vertices, i), &here, &corners[i]);
    }
    if (rc) {
        free(corners);
        return rc;
    }
    *ret_corners = corners;
    *ret_count = n;
    return 0;
}

int orl_hb_mesh_face(struct orl_hb *hb, const json_t *face, const struct orl_hb_at *at,
                     const struct orl_vec3 *corners, size_t count, struct orl_vec3 ret_face[4],
                     size_t *ret_n)
{
    const size_t n = json_array_size(face);
    if (n != 3 && n != 4)
        return orl_hb_fail(at, hb->err, ORL_ERR_INVALID, "three or four numbers are expected here");
    for (size_t i = 0; i < n; i++) {
        const json_t *corner = json_array_get(face, i);
        const json_int_t index = json_integer_value(corner);
        if (!json_is_integer(corner) || index < 0 || (size_t)index >= count)
            return orl_hb_fail(at, hb->err, ORL_ERR_RANGE, "the mesh has corners 0 to %zu",
                               count > 0 ? count - 1 : 0);
        ret_face[i] = corners[index];
    }
    *ret_n = n;
    return 0;
}

static void put_face(const char *modifier, const char *name, size_t number,
                     const struct orl_vec3 face[4], size_t n, FILE *stream)
{
    fprintf(stream, "%s polygon ", modifier);
    orl_hb_put_name(name, stream);
    fprintf(stream, "_%zu\n0\n0\n%zu", number, 3 * n);
    for (size_t i = 0; i < n; i++)
        orl_hb_put_point(face[i], stream);
    fputs("\n\n", stream);
}

static int put_faces(struct orl_hb *hb, const json_t *shade, const struct orl_hb_at *at,
                     size_t modifier, struct orl_hb_file *file)
{
    const struct orl_hb_at mesh = {at, "geometry", 0}, list = {&mesh, "faces", 0};
    const json_t *geometry = json_object_get(shade, "geometry"), *faces = NULL;
    const char *name = json_string_value(json_object_get(shade, "identifier"));
    struct orl_vec3 *corners = NULL, face[4];
    size_t count = 0, n = 0;
    int rc = orl_hb_mesh_corners(hb, geometry, &mesh, &corners, &count);
    if (rc == 0)
        rc = orl_hb_array(hb, geometry, &mesh, "faces", &faces);
    for (size_t i = 0; i < json_array_size(faces) && rc == 0; i++) {
        const struct orl_hb_at here = {&list, NULL, i};
        rc = orl_hb_mesh_face(hb, json_array_get(faces, i), &here, corners, count, face, &n);
        if (rc == 0)
            put_face(hb->modifiers[modifier].identifier, name ? name : "mesh", i, face, n,
                     file->stream);
        rc = rc ? rc : orl_hb_check(hb, file);
    }
    free(corners);
    return rc;
}

static int write_mesh(struct orl_hb *hb, const json_t *shade, const struct orl_hb_at *at,
                      struct orl_hb_file *mat, struct orl_hb_file *rad)
{
    const struct orl_hb_at properties = {at, "properties", 0},
                           radiance = {&properties, "radiance", 0},
                           here = {&radiance, "modifier", 0};
    const json_t *own = orl_hb_get(orl_hb_radiance(shade), "modifier");
    const enum orl_hb_surface_use use =
        json_is_false(json_object_get(shade, "is_detached")) ? ORL_HB_SHADE : ORL_HB_CONTEXT;
    size_t modifier;
    int rc = own ? orl_hb_modifier_find(hb, own, &here, &modifier)
                 : orl_hb_set_modifier(hb, NULL, use, &modifier);
    if (rc || orl_hb_modifier_is_void(hb, modifier))
        return rc;
    rc = orl_hb_modifier_write(hb, modifier, mat);
    return rc ? rc : put_faces(hb, shade, at, modifier, rad);
}

static int write_meshes(struct orl_hb *hb, struct orl_hb_file *mat, struct orl_hb_file *rad)
{
    struct orl_hb_walk meshes;
    int rc = orl_hb_walk(hb, hb->model, NULL, "shade_meshes", &meshes);
    for (const json_t *mesh; rc == 0 && (mesh = orl_hb_next(&meshes));)
        rc = write_mesh(hb, mesh, &meshes.here, mat, rad);
    return rc;
}

int orl_hb_meshes_write(struct orl_hb *hb)
{
    struct orl_hb_file mat = {0}, rad = {0};
    int rc = orl_hb_begin(hb, &mat);
    if (rc == 0)
        rc = orl_hb_begin(hb, &rad);
    if (rc == 0)
        rc = write_meshes(hb, &mat, &rad);
    if (rc == 0)
        rc = orl_hb_end(hb, &mat, "model/scene/shade_meshes.mat");
    if (rc == 0)
        rc = orl_hb_end(hb, &rad, "model/scene/shade_meshes.rad");
    orl_hb_discard(&mat);
    orl_hb_discard(&rad);
    return rc;
}
