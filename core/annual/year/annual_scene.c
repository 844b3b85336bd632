#include "annual/year/annual_scene.h"

#include <stdlib.h>

#include "annual/shades/window_parts.h"

/* Photons of the sun map: default totals without and with BSDF panes, and the least per node. */
enum { PHOTONS = 300000, PANEL_PHOTONS = 800000, LEAST_PHOTONS = 512 };

bool orl_annual_has_panels(const struct orl_world *world)
{
    for (size_t i = 0; i < world->n_ports; i++) {
        struct orl_facet own;
        const struct orl_facet *facet = orl_facet_own(world->geometry, world->ports[i].facet, &own);
        if (world->materials[facet->material].kind == ORL_MATERIAL_BSDF)
            return true;
    }
    return false;
}

/* asked: total of photons; 0: a default that depends on the scene. */
static uint32_t photons_of_node(const struct orl_world *world, size_t n_nodes, uint32_t asked)
{
    const double all = asked > 0 ? asked : orl_annual_has_panels(world) ? PANEL_PHOTONS : PHOTONS;
    return (uint32_t)fmax(all / fmax((double)n_nodes, 1), LEAST_PHOTONS);
}

double orl_annual_scene_map_core_s(const struct orl_annual_request *request, size_t n_nodes)
{
    /* Time per photon, to the first surface inside, and with interreflection. Measured in an office
     * through glass and through a panel: 0.6 and 0.64 us, 1.9 and 2.0 us. */
    const double first_s = 0.7e-6, whole_s = 2e-6;
    const double asked = request->photons > 0 ? request->photons : PANEL_PHOTONS;
    const double photons = fmax(asked, (double)LEAST_PHOTONS * (double)n_nodes);
    return photons * (request->technique == ORL_ANNUAL_PRECOMPUTED ? whole_s : first_s);
}

int orl_annual_scene_init(struct orl_annual_scene *scene, const struct orl_world *world,
                          const struct orl_bins *bins, struct orl_turn north,
                          const struct orl_frame *nodes, size_t n_nodes, uint32_t a_circle,
                          struct orl_crew *crew)
{
    *scene = (struct orl_annual_scene){.world = world,
                                       .bins = bins,
                                       .north = north,
                                       .nodes = nodes,
                                       .n_nodes = n_nodes,
                                       .a_circle = a_circle,
                                       .n_parts = 1};
    orl_sobol_init(&scene->sobol);
    int code = orl_aim_init(&scene->aim, world, &scene->sobol, crew);
    if (code == 0)
        code = orl_windows_of_ports(&scene->ports, world);
    if (code == 0)
        code = orl_mirrors_init(&scene->mirrors, world, &scene->ports);
    if (code == 0)
        code = orl_node_lots_init(&scene->lots, nodes, n_nodes, a_circle);
    return code;
}

int orl_annual_scene_split(struct orl_annual_scene *scene, size_t n_groups)
{
    const struct orl_world *world = scene->world;
    scene->n_parts = (uint32_t)n_groups + 1;
    scene->part_of_port = malloc((world->n_ports + 1) * sizeof *scene->part_of_port);
    if (!scene->part_of_port)
        return ORL_ERR_NOMEM;
    for (size_t i = 0; i < world->n_ports; i++)
        scene->part_of_port[i] = orl_part_of_port(world, i, n_groups);
    return 0;
}

struct orl_sun_map_request orl_annual_scene_map_request(const struct orl_annual_scene *scene,
                                                        const struct orl_annual_request *request)
{
    return (struct orl_sun_map_request){
        .world = scene->world,
        .sobol = &scene->sobol,
        .nodes = scene->nodes,
        .n_nodes = scene->n_nodes,
        .seed = request->seed,
        .photons = photons_of_node(scene->world, scene->n_nodes, request->photons),
        .of_beam = scene->part_of_port ? LEAST_PHOTONS : 0,
        .part_of_port = scene->part_of_port,
        .whole = scene->whole_map};
}

void orl_annual_scene_done(struct orl_annual_scene *scene)
{
    orl_aim_done(&scene->aim);
    orl_windows_done(&scene->ports);
    orl_mirrors_done(&scene->mirrors);
    orl_node_lots_done(&scene->lots);
    orl_sun_map_free(scene->map);
    free(scene->part_of_port);
}
