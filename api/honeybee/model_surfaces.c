#include "honeybee/model_objects.h"

#include <stdlib.h>
#include <string.h>

#include "honeybee/modifiers.h"

/* Output files for surfaces of one kind, and for their modifiers. */
struct surface_files {
    struct orl_hb_file mat, rad;
};

struct surfaces {
    struct orl_hb *hb;
    struct orl_hb_groups *groups;
    struct surface_files envelope, apertures, shades;
    struct orl_hb_polygon polygon; /* scratch */
    json_t *seconds;               /* identifiers of objects whose counterpart is already written */
};

/* Context of an object: its room's set (or NULL), and its place between rooms. */
struct context {
    const json_t *set;
    bool inside, in_wall;  /* true if between rooms; true if in a wall */
    bool second;           /* true if the face's counterpart has the openings */
    struct orl_vec3 front; /* direction of the face's front; zero without a face */
};

static int begin_files(struct orl_hb *hb, struct surface_files *surface_files)
{
    const int rc = orl_hb_begin(hb, &surface_files->mat);
    return rc ? rc : orl_hb_begin(hb, &surface_files->rad);
}

static int end_files(struct orl_hb *hb, struct surface_files *surface_files, const char *name)
{
    const int rc = orl_hb_end(hb, &surface_files->mat, "%s.mat", name);
    return rc ? rc : orl_hb_end(hb, &surface_files->rad, "%s.rad", name);
}

static void discard_files(struct surface_files *surface_files)
{
    orl_hb_discard(&surface_files->mat);
    orl_hb_discard(&surface_files->rad);
}

/* Writes the scratch polygon with the object's name. */
static int write_polygon(struct surfaces *s, const json_t *object, size_t modifier,
                         struct surface_files *surface_files)
{
    const char *name = json_string_value(json_object_get(object, "identifier"));
    if (orl_hb_modifier_is_void(s->hb, modifier))
        return 0;
    const int rc = orl_hb_modifier_write(s->hb, modifier, &surface_files->mat);
    return rc ? rc
              : orl_hb_polygon_write(s->hb, &s->polygon, s->hb->modifiers[modifier].identifier,
                                     name ? name : "unnamed", &surface_files->rad);
}

/* Chooses the object's own modifier, or the set's for its use. */
static int choose_modifier(struct surfaces *s, const json_t *object, const struct orl_hb_at *at,
                           const json_t *set, enum orl_hb_surface_use use, size_t *ret_index)
{
    const struct orl_hb_at properties = {at, "properties", 0},
                           radiance = {&properties, "radiance", 0},
                           here = {&radiance, "modifier", 0};
    const json_t *own = orl_hb_get(orl_hb_radiance(object), "modifier");
    return own ? orl_hb_modifier_find(s->hb, own, &here, ret_index)
               : orl_hb_set_modifier(s->hb, set, use, ret_index);
}

/* ---- Shades ---------------------------------------------------------------------------------- */

static int write_shade(struct surfaces *s, const json_t *shade, const struct orl_hb_at *at,
                       const json_t *set, enum orl_hb_surface_use use)
{
    size_t modifier;
    bool is_dynamic;
    int rc = choose_modifier(s, shade, at, set, use, &modifier);
    if (rc == 0)
        rc = orl_hb_groups_add(s->hb, s->groups,
                               &(struct orl_hb_member){.json = shade, .modifier = modifier}, true,
                               use == ORL_HB_SHADE_INSIDE, at, &is_dynamic);
    if (rc || is_dynamic)
        return rc;
    rc = orl_hb_polygon_read(s->hb, json_object_get(shade, "geometry"), at, &s->polygon);
    return rc ? rc : write_polygon(s, shade, modifier, &s->shades);
}

/* Writes the shades of a room, face, aperture or door. */
static int write_shades_of(struct surfaces *s, const json_t *object, const struct orl_hb_at *at,
                           const json_t *set)
{
    static const char *const members[] = {"indoor_shades", "outdoor_shades"};
    int rc = 0;
    for (size_t k = 0; k < 2 && rc == 0; k++) {
        const enum orl_hb_surface_use use = k == 0 ? ORL_HB_SHADE_INSIDE : ORL_HB_SHADE;
        struct orl_hb_walk shades;
        rc = orl_hb_walk(s->hb, object, at, members[k], &shades);
        for (const json_t *shade; rc == 0 && (shade = orl_hb_next(&shades));)
            rc = write_shade(s, shade, &shades.here, set, use);
    }
    return rc;
}

/* ---- Apertures and doors --------------------------------------------------------------------- */

static enum orl_hb_surface_use use_of_aperture(const json_t *aperture,
                                               const struct context *context)
{
    return context->inside                        ? ORL_HB_WINDOW_INSIDE
           : orl_hb_flag(aperture, "is_operable") ? ORL_HB_OPERABLE
           : context->in_wall                     ? ORL_HB_WINDOW
                                                  : ORL_HB_SKYLIGHT;
}

static enum orl_hb_surface_use use_of_door(const json_t *door, const struct context *context)
{
    const bool glass = orl_hb_flag(door, "is_glass");
    if (context->inside)
        return glass ? ORL_HB_GLASS_DOOR_INSIDE : ORL_HB_DOOR_INSIDE;
    return glass ? ORL_HB_GLASS_DOOR : context->in_wall ? ORL_HB_DOOR : ORL_HB_OVERHEAD_DOOR;
}

static int write_opening(struct surfaces *s, const json_t *object, const struct orl_hb_at *at,
                         const struct context *context, bool door)
{
    size_t modifier;
    bool is_dynamic = false;
    int rc = write_shades_of(s, object, at, context->set);
    if (rc || context->second)
        return rc;
    rc = choose_modifier(s, object, at, context->set,
                         door ? use_of_door(object, context) : use_of_aperture(object, context),
                         &modifier);
    if (rc == 0)
        rc = orl_hb_groups_add(s->hb, s->groups,
                               &(struct orl_hb_member){object, modifier, context->front}, false,
                               context->inside, at, &is_dynamic);
    if (rc || is_dynamic)
        return rc;
    rc = orl_hb_polygon_read(s->hb, json_object_get(object, "geometry"), at, &s->polygon);
    if (rc)
        return rc;
    orl_hb_polygon_orient(&s->polygon, context->front);
    return write_polygon(s, object, modifier, context->inside ? &s->envelope : &s->apertures);
}

static int write_openings(struct surfaces *s, const json_t *object, const struct orl_hb_at *at,
                          const char *member, const struct context *context, bool door)
{
    struct orl_hb_walk openings;
    int rc = orl_hb_walk(s->hb, object, at, member, &openings);
    for (const json_t *opening; rc == 0 && (opening = orl_hb_next(&openings));)
        rc = write_opening(s, opening, &openings.here, context, door);
    return rc;
}

/* ---- Faces ----------------------------------------------------------------------------------- */

static const char *word_of(const json_t *object, const char *member, const char *otherwise)
{
    const char *word = json_string_value(json_object_get(object, member));
    return word ? word : otherwise;
}

static int use_of_face(struct surfaces *s, const json_t *face, const char *type,
                       const struct orl_hb_at *at, enum orl_hb_surface_use *ret_use)
{
    const struct orl_hb_at here = {at, "face_type", 0};
    const bool out = strcmp(word_of(orl_hb_get(face, "boundary_condition"), "type", "Outdoors"),
                            "Outdoors") == 0;
    if (strcmp(type, "Wall") == 0)
        *ret_use = out ? ORL_HB_WALL : ORL_HB_WALL_INSIDE;
    else if (strcmp(type, "Floor") == 0)
        *ret_use = out ? ORL_HB_FLOOR : ORL_HB_FLOOR_INSIDE;
    else if (strcmp(type, "RoofCeiling") == 0)
        *ret_use = out ? ORL_HB_ROOF : ORL_HB_ROOF_INSIDE;
    else
        return orl_hb_fail(&here, s->hb->err, ORL_ERR_INVALID,
                           "one of Wall, Floor, RoofCeiling and AirBoundary is expected here");
    return 0;
}

/* Cuts the face's openings out of it. */
static int cut_openings(struct surfaces *s, const json_t *face, const struct orl_hb_at *at)
{
    static const char *const members[] = {"apertures", "doors"};
    int rc = 0;
    for (size_t k = 0; k < 2 && rc == 0; k++) {
        struct orl_hb_walk openings;
        rc = orl_hb_walk(s->hb, face, at, members[k], &openings);
        for (const json_t *opening; rc == 0 && (opening = orl_hb_next(&openings));)
            rc = orl_hb_polygon_add_hole(s->hb, json_object_get(opening, "geometry"),
                                         &openings.here, &s->polygon);
    }
    return rc;
}

/* Notes the second of two faces or orphaned openings that bound each other, when the first is
 * met. */
static int note_pair(struct surfaces *s, const json_t *face, struct context *context)
{
    const json_t *bound = orl_hb_get(face, "boundary_condition");
    const char *own = word_of(face, "identifier", ""),
               *other = json_string_value(
                   json_array_get(json_object_get(bound, "boundary_condition_objects"), 0));
    context->inside = strcmp(word_of(bound, "type", "Outdoors"), "Surface") == 0;
    if (!context->inside)
        return 0;
    context->second = json_object_get(s->seconds, own);
    if (!context->second && other && json_object_set_new(s->seconds, other, json_true()))
        return orl_error_no_memory(s->hb->err);
    return 0;
}

static int write_face_itself(struct surfaces *s, const json_t *face, const char *type,
                             const struct orl_hb_at *at, const struct context *context)
{
    enum orl_hb_surface_use use = ORL_HB_WALL;
    size_t modifier;
    if (strcmp(type, "AirBoundary") == 0)
        return 0;
    int rc = use_of_face(s, face, type, at, &use);
    if (rc == 0)
        rc = choose_modifier(s, face, at, context->set, use, &modifier);
    if (rc == 0)
        rc = orl_hb_polygon_read(s->hb, json_object_get(face, "geometry"), at, &s->polygon);
    if (rc == 0)
        orl_hb_polygon_orient(&s->polygon, context->front);
    if (rc == 0)
        rc = cut_openings(s, face, at);
    if (rc)
        return rc;
    if (context->second)
        orl_hb_polygon_offset(&s->polygon, orl_scale(context->front, -2 * s->hb->tolerance));
    return write_polygon(s, face, modifier, &s->envelope);
}

/* inward: true if the face is to be turned. */
static int write_face(struct surfaces *s, const json_t *face, const struct orl_hb_at *at,
                      const json_t *set, bool inward)
{
    const char *type = word_of(face, "face_type", "");
    struct context context = {.set = set, .in_wall = strcmp(type, "Wall") == 0};
    int rc = orl_hb_polygon_read(s->hb, json_object_get(face, "geometry"), at, &s->polygon);
    if (rc == 0) {
        context.front = orl_scale(orl_hb_polygon_normal(&s->polygon), inward ? -1 : 1);
        rc = note_pair(s, face, &context);
    }
    if (rc == 0)
        rc = write_openings(s, face, at, "apertures", &context, false);
    if (rc == 0)
        rc = write_openings(s, face, at, "doors", &context, true);
    if (rc == 0)
        rc = write_shades_of(s, face, at, set);
    return rc ? rc : write_face_itself(s, face, type, at, &context);
}

/* inward: flags of faces to be turned; NULL: none. */
static int write_faces(struct surfaces *s, const json_t *object, const struct orl_hb_at *at,
                       const char *member, const json_t *set, const bool *inward)
{
    struct orl_hb_walk faces;
    int rc = orl_hb_walk(s->hb, object, at, member, &faces);
    for (const json_t *face; rc == 0 && (face = orl_hb_next(&faces));)
        rc = write_face(s, face, &faces.here, set, inward && inward[faces.here.index]);
    return rc;
}

/* ---- The model ------------------------------------------------------------------------------- */

static int write_rooms(struct surfaces *s)
{
    struct orl_hb_walk rooms;
    int rc = orl_hb_walk(s->hb, s->hb->model, NULL, "rooms", &rooms);
    for (const json_t *room; rc == 0 && (room = orl_hb_next(&rooms));) {
        const json_t *set = NULL;
        bool *inward = NULL;
        rc = orl_hb_set_of_room(s->hb, room, &rooms.here, &set);
        rc = rc ? rc : orl_hb_inward_faces(s->hb, room, &rooms.here, &inward);
        rc = rc ? rc : write_faces(s, room, &rooms.here, "faces", set, inward);
        rc = rc ? rc : write_shades_of(s, room, &rooms.here, set);
        free(inward);
    }
    return rc;
}

static int write_orphaned_shades(struct surfaces *s)
{
    struct orl_hb_walk shades;
    int rc = orl_hb_walk(s->hb, s->hb->model, NULL, "orphaned_shades", &shades);
    for (const json_t *shade; rc == 0 && (shade = orl_hb_next(&shades));)
        rc = write_shade(s, shade, &shades.here, NULL,
                         orl_hb_flag(shade, "is_detached") ? ORL_HB_CONTEXT : ORL_HB_SHADE);
    return rc;
}

/* Writes openings without a face. Two that bound each other are written as one, as in rooms. */
static int write_orphaned_openings(struct surfaces *s, const char *member, bool door)
{
    struct orl_hb_walk openings;
    int rc = orl_hb_walk(s->hb, s->hb->model, NULL, member, &openings);
    json_object_clear(s->seconds);
    for (const json_t *opening; rc == 0 && (opening = orl_hb_next(&openings));) {
        struct context alone = {.in_wall = true};
        rc = note_pair(s, opening, &alone);
        rc = rc ? rc : write_opening(s, opening, &openings.here, &alone, door);
    }
    return rc;
}

static int write_all(struct surfaces *s)
{
    int rc = write_rooms(s);
    if (rc == 0)
        rc = write_faces(s, s->hb->model, NULL, "orphaned_faces", NULL, NULL);
    if (rc == 0)
        rc = write_orphaned_openings(s, "orphaned_apertures", false);
    if (rc == 0)
        rc = write_orphaned_openings(s, "orphaned_doors", true);
    return rc ? rc : write_orphaned_shades(s);
}

int orl_hb_surfaces_write(struct orl_hb *hb, struct orl_hb_groups *groups)
{
    struct surfaces s = {.hb = hb, .groups = groups, .seconds = json_object()};
    int rc = s.seconds ? begin_files(hb, &s.envelope) : orl_error_no_memory(hb->err);
    if (rc == 0)
        rc = begin_files(hb, &s.apertures);
    if (rc == 0)
        rc = begin_files(hb, &s.shades);
    if (rc == 0)
        rc = write_all(&s);
    if (rc == 0)
        rc = end_files(hb, &s.envelope, "model/scene/envelope");
    if (rc == 0)
        rc = end_files(hb, &s.apertures, "model/aperture/aperture");
    if (rc == 0)
        rc = end_files(hb, &s.shades, "model/scene/shades");
    discard_files(&s.envelope);
    discard_files(&s.apertures);
    discard_files(&s.shades);
    orl_hb_polygon_done(&s.polygon);
    json_decref(s.seconds);
    return rc ? rc : orl_hb_meshes_write(hb);
}
