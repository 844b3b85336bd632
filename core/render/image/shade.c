#include "render/image/shade.h"

#include "scene/built/scene.h"
#include "scene/material/patterns/texture.h"

/* Cosine of the largest deflection of a ray that counts as direct: a hundredth of a sun's
 * radius. */
static const double straight = 1 - 1e-9;
enum { MOST_SPLITS = 6, MOST_SPLITS_BY_LOT = 64, MOST_BRANCHES = 16 };

/* A branch of the ray that is still to be followed. */
struct branch {
    struct orl_path path;
    double distance; /* from the eye to the start of the branch */
    bool outside;
    bool straight; /* true if no surface has deflected it */
    uint32_t splits;
};

struct look {
    const struct orl_shader *shader;
    struct orl_random *random;
    struct orl_search *search;
    struct orl_shaded_ray *shaded;
    bool lobes;
    struct orl_vec3 direction; /* direction of the view ray */
    struct branch stack[MOST_BRANCHES];
    uint32_t depth;
};

/* Returns the scene that views see. */
static const struct orl_lit_scene *scene_of(const struct look *look)
{
    return orl_lit_scene_seen(look->shader->lit_scene);
}

static void add_radiance(struct look *look, struct orl_rgb weight, struct orl_rgb radiance)
{
    look->shaded->rest = orl_rgb_add(look->shaded->rest, orl_rgb_mul(weight, radiance));
}

/* Returns true if the view ignores the surface, because it is seen from behind (Radiance's
 * -bv-). */
static bool is_unseen(const struct look *look, const struct orl_hit *hit)
{
    switch (look->shader->backs_unseen && !hit->front
                ? orl_lit_scene_material(scene_of(look), hit)->kind
                : ORL_MATERIAL_VOID) {
    case ORL_MATERIAL_PLASTIC:
    case ORL_MATERIAL_METAL:
    case ORL_MATERIAL_TRANS:
    case ORL_MATERIAL_ASHIKHMIN:
    case ORL_MATERIAL_FUNCTION_LOBES:
        return true;
    default:
        return false;
    }
}

/* Returns true if a branch that starts there is outside. Ports determine that; behind an illum, or
 * a surface seen from behind, the start itself is tested. */
static bool is_outside(const struct look *look, const struct branch *from,
                       const struct orl_hit *hit, struct orl_vec3 start, bool transmitted)
{
    const struct orl_lit_scene *lit_scene = scene_of(look);
    if (transmitted && !lit_scene->open &&
        (orl_lit_scene_material(lit_scene, hit)->kind == ORL_MATERIAL_ILLUM ||
         is_unseen(look, hit)))
        return orl_lit_scene_is_outside(look->shader->lit_scene, start);
    return orl_lit_scene_outside_after(lit_scene, hit, transmitted, from->outside);
}

/* Returns true if a branch is to be followed; with by_lot, applies Russian roulette to dim ones. */
static bool is_followed(struct look *look, struct branch *branch)
{
    const struct orl_shader *shader = look->shader;
    const double share = orl_rgb_max(branch->path.weight);
    const uint32_t most = shader->roulette ? MOST_SPLITS_BY_LOT : MOST_SPLITS;
    if (look->depth >= MOST_BRANCHES || branch->splits > most)
        return false;
    if (share >= shader->least_weight || !shader->roulette)
        return share >= shader->least_weight;
    if (!(orl_random_uniform(look->random) * shader->least_weight < share))
        return false;
    branch->path.weight = orl_rgb_scale(branch->path.weight, shader->least_weight / share);
    return true;
}

/* Pushes a branch in the direction of s, with its weight. */
static void push_branch(struct look *look, const struct branch *from, const struct orl_hit *hit,
                        const struct orl_surface_sample *s, bool undeflected)
{
    const struct orl_lit_scene *lit_scene = scene_of(look);
    struct branch next = {.path = from->path,
                          .distance = from->distance + hit->distance,
                          .straight = from->straight && undeflected,
                          .splits = from->splits + 1};
    next.path.weight = orl_rgb_mul(from->path.weight, s->weight);
    if (!is_followed(look, &next))
        return;
    orl_path_spawn_ray(&next.path, lit_scene, hit, s);
    next.outside = is_outside(look, from, hit, next.path.origin, s->transmitted);
    look->stack[look->depth++] = next;
}

static void add_vertex(struct look *look, const struct branch *at, const struct orl_hit *hit,
                       const struct orl_material *m)
{
    const struct orl_vec3 seen = orl_hit_facing(hit);
    const struct orl_lit_scene *lit_scene = scene_of(look);
    const bool proxied = orl_lit_scene_hides(lit_scene, hit->facet);
    if (look->shaded->n_vertices >= ORL_SHADE_VERTICES)
        return;
    struct orl_vertex *const vertex = &look->shaded->vertices[look->shaded->n_vertices++];
    *vertex = (struct orl_vertex){
        .place = {.point = orl_hit_ray_origin(lit_scene->geometry, hit, seen),
                  .normal = seen,
                  .outside = at->outside || proxied,
                  .proxied = proxied},
        .on_surface = hit->point,
        .weight =
            orl_rgb_scale(orl_rgb_mul(at->path.weight, orl_material_diffuse(m, hit)), 1 / ORL_PI),
        .distance = at->distance + hit->distance};
    if (!m->texture)
        return;
    look->shaded->textured = vertex->place.textured = true;
    vertex->place.shading = orl_texture_normal(m->texture, hit, orl_path_back(&at->path));
}

/* Sums of sample values and of their squared lumas. */
struct samples {
    struct orl_rgb sum;
    double squares;
    uint32_t count;
};

static void add_sample(struct samples *samples, struct orl_rgb value)
{
    samples->sum = orl_rgb_add(samples->sum, value);
    samples->squares += orl_luma(value) * orl_luma(value);
    samples->count++;
}

/* Adds the mean of samples, times weight, to the lobes. */
static void add_mean(struct look *look, struct orl_rgb weight, const struct samples *samples,
                     bool is_gloss)
{
    struct orl_shaded_ray *shaded = look->shaded;
    const double n = samples->count;
    const struct orl_rgb mean = orl_rgb_scale(samples->sum, 1 / n);
    const struct orl_rgb shown = orl_rgb_mul(weight, mean);
    const double luma = orl_luma(mean), share = orl_luma(weight);
    const double variance =
        n > 1 ? share * share * fmax(samples->squares / n - luma * luma, 0) / (n - 1) : 0;
    shaded->lobes = orl_rgb_add(shaded->lobes, shown);
    shaded->lobes_variance += variance;
    if (!is_gloss)
        return;
    shaded->gloss = orl_rgb_add(shaded->gloss, shown);
    shaded->gloss_variance += variance;
}

/* Adds suns and lights in the lobes of a surface, averaged over a few shadow rays. */
static void add_direct_in_lobes(struct look *look, const struct branch *at,
                                const struct orl_hit *hit, const struct orl_material *m,
                                struct orl_vec3 eye)
{
    enum { SAMPLES = 2 };
    const struct orl_lit_scene *lit_scene = scene_of(look);
    struct samples direct = {.count = 0};
    if (!orl_lit_scene_hides(lit_scene, hit->facet))
        lit_scene = look->shader->lit_scene;
    for (int i = 0; i < SAMPLES; i++)
        add_sample(&direct, orl_direct_by_lobes(lit_scene, hit, m, eye, look->random));
    add_mean(look, at->path.weight, &direct, !orl_material_transmits_lobes(m));
}

/* Returns true if all non-diffuse reflection goes one way. Other materials may mirror a share and
 * scatter another. */
static bool only_mirrors(const struct orl_material *m, const struct orl_hit *hit,
                         struct orl_vec3 eye)
{
    return m->kind == ORL_MATERIAL_TRANS && orl_rgb_max(orl_material_mirrored(m, hit, eye)) > 0;
}

/* Draws a sample of the lobes. Mirrored and straight light is followed separately: among samples it
 * counts as nothing, and it is not drawn if it is all there is on that side. */
static struct orl_surface_sample sample_lobes(const struct look *look, const struct orl_hit *hit,
                                              const struct orl_material *m, struct orl_vec3 eye,
                                              uint32_t sample, uint32_t sequence)
{
    const enum orl_lobes lobes = only_mirrors(m, hit, eye)
                                     ? ORL_LOBE_TRANSMITTED
                                     : (enum orl_lobes)(ORL_LOBE_REFLECTED | ORL_LOBE_TRANSMITTED);
    double u[3];
    orl_sobol_point(look->shader->sobol, sample, sequence, 3, u);
    return orl_material_sample_at(m, hit, eye, ORL_TRANSPORT_EYE, lobes, u);
}

/* Returns the radiance along a lobe's ray. */
static struct orl_rgb seen_along(struct look *look, const struct orl_hit *hit, struct orl_vec3 eye,
                                 const struct orl_surface_sample *s, bool outside)
{
    const struct orl_lit_scene *lit_scene = scene_of(look);
    const struct orl_vec3 start = orl_hit_ray_origin(lit_scene->geometry, hit, s->direction);
    const struct orl_mis_pdf mis_pdf =
        orl_mis_pdf_update(lit_scene, hit, eye, s, orl_mis_pdf_zero());
    if (orl_lit_scene_hides(lit_scene, hit->facet))
        return orl_exterior_radiance(lit_scene, start, s->direction, mis_pdf, look->random,
                                     &look->search->health, NULL);
    const struct orl_lobe_ray ray = {start, s->direction, mis_pdf, orl_rgb_max(s->weight), outside};
    return look->shader->radiance(look->shader->ctx, &ray, look->random, look->search);
}

/* Adds the lobes of a surface: lights directly, all else by a few rays. Straight light is followed
 * separately. */
static void add_lobes(struct look *look, const struct branch *at, const struct orl_hit *hit,
                      const struct orl_material *m)
{
    const struct orl_lit_scene *lit_scene = scene_of(look);
    const bool is_gloss = !orl_material_transmits_lobes(m);
    const uint32_t samples = is_gloss ? look->shader->gloss_samples : look->shader->pane_samples;
    const struct orl_vec3 eye = orl_path_back(&at->path);
    struct samples scattered = {.count = 0};
    if (look->shader->only_gloss && !is_gloss)
        return;
    add_direct_in_lobes(look, at, hit, m, eye);
    const uint32_t own = (uint32_t)orl_random_bits(look->random);
    const bool shares = is_gloss && look->shader->sequence != 0;
    const uint32_t sequence = shares ? look->shader->sequence : own;
    const uint32_t first = shares ? look->shader->first_gloss : 0;
    for (uint32_t i = first; i < first + samples; i++) {
        const struct orl_surface_sample s = sample_lobes(look, hit, m, eye, i, sequence);
        struct orl_rgb seen = orl_gray(0);
        const bool outside =
            orl_lit_scene_outside_after(lit_scene, hit, s.transmitted, at->outside);
        if (s.event == ORL_EVENT_GLOSSY)
            seen = orl_rgb_mul(s.weight, seen_along(look, hit, eye, &s, outside));
        add_sample(&scattered, seen);
    }
    add_mean(look, at->path.weight, &scattered, is_gloss);
}

/* Pushes the branches of light that is mirrored, goes straight or is bent. */
static void push_branches(struct look *look, const struct branch *at, const struct orl_hit *hit,
                          const struct orl_material *m)
{
    const struct orl_vec3 eye = orl_path_back(&at->path);
    struct orl_surface_sample bent[ORL_PRISM_RAYS];
    const struct orl_surface_sample on = {.direction = at->path.direction,
                                          .weight = orl_material_straight(m, hit, eye),
                                          .transmitted = true};
    struct orl_surface_sample back = {.direction = orl_mirrored_at(m, hit, eye),
                                      .weight = orl_material_mirrored(m, hit, eye)};
    if (m->kind == ORL_MATERIAL_DIELECTRIC)
        back.medium_transmissivity = orl_interface_of(m)->media[hit->front ? 1 : 0].transmissivity;
    push_branch(look, at, hit, &back, false);
    push_branch(look, at, hit, &on, true);
    for (int i = orl_material_deviated_rays(m, hit, eye, ORL_TRANSPORT_EYE, bent) - 1; i >= 0; i--)
        push_branch(look, at, hit, &bent[i], false);
}

/* Returns the material that a view sees, or NULL if it sees none. An illum appears as another
 * material, and some backs are invisible. */
static const struct orl_material *seen_at(const struct look *look, const struct orl_hit *hit)
{
    const struct orl_lit_scene *lit_scene = scene_of(look);
    const struct orl_material *m = orl_lit_scene_material(lit_scene, hit);
    if (is_unseen(look, hit))
        return NULL;
    if (m->kind != ORL_MATERIAL_ILLUM)
        return m;
    const int32_t seen_as = orl_illum_of(m)->seen_as;
    return seen_as >= 0 ? &lit_scene->materials[seen_as] : NULL;
}

static bool is_straight(const struct look *look, struct orl_vec3 direction)
{
    return orl_dot(direction, look->direction) > straight;
}

/* Returns true if the ray shows the lamp at that facet. */
static bool shows_lamp(const struct look *look, struct orl_vec3 direction, uint32_t facet)
{
    const struct orl_shader *shader = look->shader;
    if (shader->suns == ORL_LAMP_ONLY)
        return facet == shader->lamp && is_straight(look, direction);
    return shader->suns != ORL_SUNS_ONLY &&
           !(shader->excluded_lamps &&
             !orl_facet_is_instanced(look->shader->lit_scene->geometry, facet) &&
             shader->excluded_lamps[facet] && is_straight(look, direction));
}

/* Returns the name of the surfaces met so far and one more. */
static uint64_t name_with(uint64_t name, uint64_t met)
{
    return orl_mix64(name + met + 1);
}

static uint64_t side_met(const struct orl_hit *hit)
{
    return 2 * (uint64_t)hit->facet + hit->front;
}

static void note_signature(struct orl_shaded_ray *shaded, uint64_t met, bool undeflected)
{
    shaded->path_signature = name_with(shaded->path_signature, met);
    if (undeflected)
        shaded->visible_surfaces = name_with(shaded->visible_surfaces, met);
}

/* Handles a surface in an irradiance picture. The irradiance is that of the surface itself; glass
 * is passed as if it were not there. */
static void meet_for_irradiance(struct look *look, const struct branch *at,
                                const struct orl_hit *hit, const struct orl_material *m)
{
    const struct orl_surface_sample on = {
        .direction = at->path.direction, .weight = orl_gray(1), .transmitted = true};
    const bool pane = m->kind == ORL_MATERIAL_GLASS || m->kind == ORL_MATERIAL_GLAZING ||
                      orl_material_deviates(m);
    if (!pane && orl_rgb_max(orl_material_diffuse(m, hit)) > 0)
        add_vertex(look, at, hit, m);
    else if (pane || (m->kind == ORL_MATERIAL_MIXTURE && orl_material_is_window(m)))
        push_branch(look, at, hit, &on, true);
    for (uint32_t i = 0; i < look->shaded->n_vertices; i++)
        look->shaded->vertices[i].weight = orl_gray(1);
}

/* Adds the light scattered by a volume and attenuates the branch. Returns false if the branch ends
 * in the volume; one sampled path then continues it. */
static bool passes_volume(struct look *look, struct branch *at, double distance)
{
    const struct orl_lit_scene *const lit_scene = look->shader->lit_scene;
    const struct orl_volume_event event = orl_volume_sample_event(
        lit_scene->scene, at->path.origin, at->path.direction, distance, look->random);
    at->path.weight = orl_rgb_mul(at->path.weight, event.weight);
    if (!event.scattered)
        return true;
    const struct orl_vec3 point = orl_madd(at->path.origin, at->path.direction, event.distance);
    const struct orl_rgb direct =
        orl_direct_in_volume(lit_scene, point, at->path.direction, event.asymmetry, look->random);
    const double u0 = orl_random_uniform(look->random),
                 u[2] = {u0, orl_random_uniform(look->random)};
    const struct orl_lobe_ray ray = {
        point, orl_phase_function_sample(event.asymmetry, at->path.direction, u),
        orl_mis_pdf_zero(), orl_rgb_max(at->path.weight), at->outside};
    add_radiance(look, at->path.weight,
                 orl_rgb_add(direct, look->shader->radiance(look->shader->ctx, &ray, look->random,
                                                            look->search)));
    return false;
}

static void shade_surface(struct look *look, const struct branch *met, const struct orl_hit *hit)
{
    const struct orl_material *m = seen_at(look, hit);
    struct branch at = *met;
    const bool alone = look->shader->suns >= ORL_SUNS_ONLY;
    note_signature(look->shaded, side_met(hit), at.straight);
    if (!m) {
        const struct orl_surface_sample on = {
            .direction = at.path.direction, .weight = orl_gray(1), .transmitted = true};
        push_branch(look, &at, hit, &on, true);
        return;
    }
    if (look->shader->irradiance) {
        meet_for_irradiance(look, &at, hit, m);
        return;
    }
    orl_path_attenuate(&at.path, m, hit);
    if (!alone && orl_rgb_max(orl_material_diffuse(m, hit)) > 0)
        add_vertex(look, &at, hit, m);
    push_branches(look, &at, hit, m);
    const bool has_lobes = orl_material_has_lobes(m);
    look->shaded->has_lobes = look->shaded->has_lobes || has_lobes;
    if (has_lobes && look->lobes)
        add_lobes(look, &at, hit, m);
    if (shows_lamp(look, at.path.direction, hit->facet))
        add_radiance(look, at.path.weight, orl_material_emission(m, hit, orl_path_back(&at.path)));
}

/* Views ignore the BSDFs that stand for what they see, but must track which side of them they are
 * on. */
static void pass_proxies(const struct orl_lit_scene *lit_scene, double distance, struct branch *at)
{
    const enum orl_port_crossing passed =
        orl_proxies_last_crossing(lit_scene->scene, at->path.origin, at->path.direction, distance);
    if (passed != ORL_CROSSING_NONE && !lit_scene->open)
        at->outside = passed == ORL_CROSSING_OUTWARDS;
}

/* Returns the radiance of the sky, and of the suns that this ray shows. */
static struct orl_rgb seen_beyond(const struct look *look, struct orl_vec3 direction)
{
    const struct orl_lit_scene *lit_scene = scene_of(look);
    const enum orl_sun_visibility shown = look->shader->suns;
    const struct orl_rgb sky =
        shown >= ORL_SUNS_ONLY ? orl_gray(0) : orl_lit_scene_dome_seen(lit_scene, direction);
    const bool suns =
        shown == ORL_SUNS_VISIBLE ||
        (shown != ORL_LAMP_ONLY && (shown == ORL_SUNS_ONLY) == is_straight(look, direction));
    return suns ? orl_rgb_add(sky, orl_lit_scene_sun_radiance(lit_scene, direction)) : sky;
}

void orl_shade_ray(const struct orl_shader *shader, struct orl_vec3 origin,
                   struct orl_vec3 direction, bool outside, bool lobes, struct orl_random *random,
                   struct orl_search *search, struct orl_shaded_ray *ret_shaded)
{
    const struct orl_lit_scene *lit_scene = orl_lit_scene_seen(shader->lit_scene);
    struct look look; /* its stack stays uninitialised, because it is large */
    look.shader = shader;
    look.random = random;
    look.search = search;
    look.shaded = ret_shaded;
    look.lobes = lobes;
    look.direction = direction;
    look.depth = 0;
    ret_shaded->n_vertices = 0;
    ret_shaded->path_signature = ret_shaded->visible_surfaces = 0;
    ret_shaded->rest = ret_shaded->lobes = ret_shaded->gloss = orl_gray(0);
    ret_shaded->lobes_variance = ret_shaded->gloss_variance = 0;
    ret_shaded->has_lobes = ret_shaded->textured = false;
    look.stack[look.depth++] = (struct branch){
        .path = orl_path_from(origin, direction), .outside = outside, .straight = true};
    while (look.depth > 0) {
        struct branch at = look.stack[--look.depth];
        struct orl_hit hit = {.distance = INFINITY};
        search->health.rays++;
        const bool met = orl_path_intersect(lit_scene, &at.path, &hit);
        pass_proxies(lit_scene, hit.distance, &at);
        if (lit_scene->scene->mist && !shader->irradiance &&
            !passes_volume(&look, &at, hit.distance))
            continue;
        if (met) {
            shade_surface(&look, &at, &hit);
            continue;
        }
        note_signature(ret_shaded, UINT32_MAX, at.straight);
        search->health.rays_leaked += !lit_scene->open && !at.outside;
        orl_path_escape(&at.path);
        if (shader->irradiance)
            continue;
        add_radiance(&look, at.path.weight, seen_beyond(&look, at.path.direction));
    }
}

/* Returns the share of light that passes the surface straight on. */
static struct orl_rgb straight_share(const struct look *look, const struct orl_path *path,
                                     const struct orl_hit *hit)
{
    const struct orl_material *m = seen_at(look, hit);
    return m ? orl_material_straight(m, hit, orl_path_back(path)) : orl_gray(1);
}

uint64_t orl_shade_visible_surfaces(const struct orl_shader *shader, struct orl_vec3 origin,
                                    struct orl_vec3 direction, struct orl_health *health)
{
    const struct orl_lit_scene *lit_scene = orl_lit_scene_seen(shader->lit_scene);
    const struct look look = {.shader = shader};
    struct orl_path path = orl_path_from(origin, direction);
    uint64_t name = 0;
    for (int splits = 0; splits <= MOST_SPLITS; splits++) {
        struct orl_hit hit = {.distance = INFINITY};
        health->rays++;
        if (!orl_path_intersect(lit_scene, &path, &hit))
            return name_with(name, UINT32_MAX);
        name = name_with(name, side_met(&hit));
        const struct orl_surface_sample on = {.direction = direction,
                                              .weight = straight_share(&look, &path, &hit),
                                              .transmitted = true};
        path.weight = orl_rgb_mul(path.weight, on.weight);
        if (orl_rgb_max(path.weight) < shader->least_weight)
            break;
        orl_path_spawn_ray(&path, lit_scene, &hit, &on);
    }
    return name;
}
