#include "scene/surfaces.h"

#include <stdlib.h>
#include <string.h>

#include "base/memory/memory.h"

static const char black_name[] = "dark window";

/* ---- Materials ------------------------------------------------------------------------------- */

static bool find_material(const struct orl_parsed_scene *d, const char *name, uint32_t *ret_index)
{
    for (size_t i = d->n_materials; i-- > 0;)
        if (d->materials[i].name && strcmp(d->materials[i].name, name) == 0) {
            *ret_index = (uint32_t)i;
            return true;
        }
    return false;
}

/* Adds a plastic that reflects nothing. Surfaces modified by void are treated differently. */
static int add_black(struct orl_parsed_scene *d, uint32_t *ret_index)
{
    const struct orl_material black = {
        .kind = ORL_MATERIAL_PLASTIC,
        .name = orl_arena_copy_text(d->arena, black_name, sizeof black_name - 1),
        .sky = -1};
    return black.name ? orl_parsed_scene_add_material(d, &black, ret_index) : ORL_ERR_NOMEM;
}

/* ---- Surfaces -------------------------------------------------------------------------------- */

/* A name in an override; met: some surface has it. */
struct wanted {
    const char *name;
    bool met;
};

static int compare_names(const void *a, const void *b)
{
    return strcmp(((const struct wanted *)a)->name, ((const struct wanted *)b)->name);
}

static bool is_wanted(struct wanted *names, size_t n, const char *name)
{
    const struct wanted key = {.name = name};
    struct wanted *found = name ? bsearch(&key, names, n, sizeof *names, compare_names) : NULL;
    if (found)
        found->met = true;
    return found != NULL;
}

struct overriding {
    struct orl_parsed_scene *parsed_scene;
    const struct orl_material_overrides *material_overrides;
    uint32_t *modifier;    /* material of each surface as written in the files */
    uint32_t *override_of; /* index + 1 of each surface's override; 0: none */
    struct orl_error *err;
};

/* Returns ORL_ERR_RANGE if a BSDF's up vector is parallel to the surface normal, as the parser
 * does. */
static int check_up(const struct orl_surface *surface, const struct orl_material *m,
                    struct orl_error *err)
{
    if (!orl_bsdf_up_is_undefined(m, surface))
        return 0;
    orl_error_set(err, ORL_ERR_RANGE,
                  "the up vector of BSDF '%.100s' is parallel to the normal of '%.100s'", m->name,
                  surface->name);
    orl_error_at(err, surface->file, surface->line, NULL);
    return ORL_ERR_RANGE;
}

static int assign_to_surface(const struct overriding *s, size_t which, size_t i, uint32_t material)
{
    struct orl_parsed_scene *d = s->parsed_scene;
    const struct orl_material_override *override = &s->material_overrides->at[which];
    if (s->override_of[i] > 0 && s->override_of[i] != which + 1)
        return orl_error_set(s->err, ORL_ERR_INVALID,
                             "the surface '%.100s' is a window of both '%.100s' and '%.100s'",
                             d->surfaces[i].name,
                             s->material_overrides->at[s->override_of[i] - 1].of, override->of);
    s->override_of[i] = (uint32_t)which + 1;
    if (override->kind == ORL_OVERRIDE_NONE)
        return 0;
    d->surfaces[i].material = material;
    return check_up(&d->surfaces[i], &d->materials[material], s->err);
}

/* names: the names of the override, sorted. */
static int assign_material(const struct overriding *s, size_t which, struct wanted *names,
                           uint32_t material)
{
    const struct orl_parsed_scene *d = s->parsed_scene;
    const size_t n = s->material_overrides->at[which].n_names;
    int code = 0;
    for (size_t i = 0; i < d->n_surfaces && code == 0; i++) {
        const bool named = is_wanted(names, n, d->surfaces[i].name);
        if (is_wanted(names, n, d->materials[s->modifier[i]].name) || named)
            code = assign_to_surface(s, which, i, material);
    }
    for (size_t i = 0; i < n && code == 0; i++)
        if (!names[i].met)
            code = orl_error_set(
                s->err, ORL_ERR_NOT_FOUND,
                "'%.100s' has no such window: no surface is named '%.100s' or has that modifier",
                s->material_overrides->at[which].of, names[i].name);
    return code;
}

static int find_new(const struct overriding *s, const struct orl_material_override *override,
                    uint32_t *ret_material)
{
    if (override->kind == ORL_OVERRIDE_BLACK && add_black(s->parsed_scene, ret_material) < 0)
        return orl_error_set(s->err, ORL_ERR_NOMEM, "out of memory");
    if (override->kind == ORL_OVERRIDE_MATERIAL &&
        !find_material(s->parsed_scene, override->material, ret_material))
        return orl_error_set(s->err, ORL_ERR_NOT_FOUND,
                             "the scene has no material '%.100s', which a state of '%.100s' uses",
                             override->material, override->of);
    return 0;
}

static int apply_override(const struct overriding *s, size_t which)
{
    const struct orl_material_override *override = &s->material_overrides->at[which];
    uint32_t material = 0;
    int code = find_new(s, override, &material);
    if (code < 0 || override->n_names == 0)
        return code;
    struct wanted *names = calloc(override->n_names, sizeof *names);
    if (!names)
        return orl_error_set(s->err, ORL_ERR_NOMEM, "out of memory");
    for (size_t i = 0; i < override->n_names; i++)
        names[i].name = override->names[i];
    qsort(names, override->n_names, sizeof *names, compare_names);
    code = assign_material(s, which, names, material);
    free(names);
    return code;
}

/* ---- Window groups --------------------------------------------------------------------------- */

int orl_material_add_group_copy(struct orl_parsed_scene *d, uint32_t material,
                                uint32_t window_group, uint32_t *ret_index)
{
    struct orl_material copy = d->materials[material];
    copy.window_group = window_group;
    copy.copy_of = orl_material_origin(&copy, material) + 1;
    const int code = orl_parsed_scene_add_material(d, &copy, ret_index);
    if (code == 0 && orl_material_bsdf(&copy))
        orl_bsdf_ref(orl_material_bsdf(&copy));
    return code;
}

/* own: for each material, its copy in this window group, or UINT32_MAX. */
static int assign_group_copy(struct orl_parsed_scene *d, size_t surface, uint32_t window_group,
                             uint32_t *copy_of_material)
{
    uint32_t *material = &d->surfaces[surface].material;
    const int code =
        copy_of_material[*material] == UINT32_MAX
            ? orl_material_add_group_copy(d, *material, window_group, &copy_of_material[*material])
            : 0;
    *material = copy_of_material[*material];
    return code;
}

static bool is_of_files(const struct orl_material_override *override,
                        const struct orl_parsed_scene *d, size_t n_names, size_t surface)
{
    if (override->n_files == 0)
        return false;
    const size_t end = override->first_file + override->n_files;
    return surface >= d->source.first_surfaces[override->first_file] &&
           (end == n_names || surface < d->source.first_surfaces[end]);
}

/* Copies only the materials that existed before: `n` excludes the copies. */
static int assign_group_copies(const struct overriding *s, size_t n_names)
{
    struct orl_parsed_scene *d = s->parsed_scene;
    const size_t n = d->n_materials;
    uint32_t *copy_of_material = malloc((n + 1) * sizeof *copy_of_material);
    int code = copy_of_material ? 0 : ORL_ERR_NOMEM;
    for (size_t k = 0; k < s->material_overrides->count && code == 0; k++) {
        memset(copy_of_material, 0xff, (n + 1) * sizeof *copy_of_material);
        for (size_t i = 0; i < d->n_surfaces && code == 0; i++)
            if (s->override_of[i] == k + 1 ||
                (s->override_of[i] == 0 &&
                 is_of_files(&s->material_overrides->at[k], d, n_names, i)))
                code = assign_group_copy(d, i, (uint32_t)k + 1, copy_of_material);
    }
    free(copy_of_material);
    return code < 0 ? orl_error_set(s->err, code, "out of memory") : 0;
}

/* ---- Entry points ---------------------------------------------------------------------------- */

static bool is_named(const struct orl_material_override *override, const struct orl_parsed_scene *d,
                     const struct orl_placement *placement, const struct orl_surface *surface)
{
    const char *const modifier = d->materials[surface->material].name;
    for (size_t i = 0; i < override->n_names; i++)
        if ((modifier && strcmp(modifier, override->names[i]) == 0) ||
            orl_placement_has_name(d, placement, surface->name, override->names[i]))
            return true;
    return false;
}

/* Returns true if an override concerns the surfaces of an instance. */
static bool concerns_placement(const struct orl_material_override *override,
                               const struct orl_parsed_scene *d,
                               const struct orl_placement *placement)
{
    const struct orl_prototype *const prototype = &d->prototypes[placement->prototype];
    if (placement->main_file >= override->first_file &&
        placement->main_file < override->first_file + override->n_files)
        return true;
    for (size_t i = 0; i < prototype->n_surfaces; i++)
        if (is_named(override, d, placement, &prototype->surfaces[i]))
            return true;
    return false;
}

/* Expands all instances if an override concerns one of them, so that it does not change the others.
 * */
static int expand_affected(const struct orl_material_overrides *material_overrides,
                           struct orl_parsed_scene *d, struct orl_error *err)
{
    for (size_t i = 0; i < material_overrides->count; i++)
        for (size_t k = 0; k < d->n_placements; k++)
            if (concerns_placement(&material_overrides->at[i], d, &d->placements[k]))
                return orl_placements_expand(d, ORL_ALL_PLACEMENTS, err);
    return 0;
}

int orl_material_overrides_apply(const struct orl_material_overrides *material_overrides,
                                 size_t n_names, struct orl_parsed_scene *d, struct orl_error *err)
{
    const int expanded = expand_affected(material_overrides, d, err);
    if (expanded < 0)
        return expanded;
    struct overriding s = {.parsed_scene = d,
                           .material_overrides = material_overrides,
                           .modifier = calloc(d->n_surfaces + 1, sizeof *s.modifier),
                           .override_of = calloc(d->n_surfaces + 1, sizeof *s.override_of),
                           .err = err};
    int code = s.modifier && s.override_of ? 0 : ORL_ERR_NOMEM;
    if (code < 0)
        orl_error_set(err, code, "out of memory");
    for (size_t i = 0; s.modifier && i < d->n_surfaces; i++)
        s.modifier[i] = d->surfaces[i].material;
    for (size_t i = 0; i < material_overrides->count && code == 0; i++)
        code = apply_override(&s, i);
    if (code == 0 && material_overrides->by_window_group)
        code = assign_group_copies(&s, n_names);
    free(s.modifier);
    free(s.override_of);
    return code;
}

void orl_material_overrides_digest(const struct orl_material_overrides *material_overrides,
                                   struct orl_sha256 *hash)
{
    for (size_t i = 0; i < material_overrides->count; i++) {
        const struct orl_material_override *override = &material_overrides->at[i];
        for (size_t k = 0; k < override->n_names; k++)
            orl_sha256_add(hash, override->names[k], strlen(override->names[k]) + 1);
        orl_sha256_add(hash, &"-+="[override->kind], 1);
        if (override->kind == ORL_OVERRIDE_MATERIAL)
            orl_sha256_add(hash, override->material, strlen(override->material) + 1);
        if (material_overrides->by_window_group)
            orl_sha256_add(hash, (const size_t[]){override->first_file, override->n_files},
                           2 * sizeof(size_t));
    }
    if (material_overrides->by_window_group)
        orl_sha256_add(hash, "parted", 6);
}
