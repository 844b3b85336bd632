#include "photon/flight/port_start.h"

#include "base/vectors.h"
#include "photon/flight/table.h"
#include "scene/material/hemisphere.h"

enum { N = ORL_STARTS_AT_ONCE };

/* Data of several starts, in columns. */
struct columns {
    double place[N][2], way[N][2], density[N];
    struct orl_vec3 points[N], out[N];
};

/* Maps points of the square to directions in the outer hemisphere. */
ORL_FOR_WIDE_VECTORS
static void map_to_hemisphere(struct orl_vec3 outward, size_t n, struct columns *c)
{
    for (size_t i = 0; i < n; i++)
        c->out[i] = orl_hemisphere_about(outward, c->way[i][0], c->way[i][1]);
}

static void sample_dome(const struct orl_emission *e, const struct orl_stratum *stratum, size_t n,
                        struct columns *c)
{
    double at[N][2];
    orl_table_sample_many(&e->port_tables[stratum->port], (const double(*)[2])c->way, n, at,
                          c->density);
    for (size_t i = 0; i < n; i++) {
        c->way[i][0] = at[i][0];
        c->way[i][1] = at[i][1];
    }
    map_to_hemisphere(e->world->ports[stratum->port].outward, n, c);
}

static void sample_sun(const struct orl_emission *e, const struct orl_stratum *stratum,
                       bool caustic, size_t n, struct columns *c)
{
    const struct orl_world *world = e->world;
    if (stratum->kind == ORL_STRATUM_PORT_IMAGE)
        for (size_t i = 0; i < n; i++)
            c->out[i] = orl_image_sample(world, &world->images.nodes[stratum->image], c->way[i]);
    else
        orl_sun_sample_many(&world->suns[stratum->sun], (const double(*)[2])c->way, n, c->out);
    if (!caustic || !stratum->place.weight)
        return;
    double place[N][2];
    orl_table_sample_many(&stratum->place, (const double(*)[2])c->place, n, place, c->density);
    for (size_t i = 0; i < n; i++) {
        c->place[i][0] = place[i][0];
        c->place[i][1] = place[i][1];
    }
}

void orl_port_starts(const struct orl_emission *emission, const struct orl_stratum *stratum,
                     bool caustic, const double *const *u, size_t n,
                     struct orl_port_start *ret_starts)
{
    const struct orl_world *world = emission->world;
    struct columns c;
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < 2; k++) {
            c.place[i][k] = u[i][1 + k];
            c.way[i][k] = u[i][3 + k];
        }
        c.density[i] = 1;
    }
    if (stratum->kind == ORL_STRATUM_PORT_DOME)
        sample_dome(emission, stratum, n, &c);
    else if (stratum->kind == ORL_STRATUM_PORT_LAMP)
        for (size_t i = 0; i < n; i++)
            /* the direction depends on the point; port_lamp.c samples it */
            c.out[i] = world->ports[stratum->port].outward;
    else
        sample_sun(emission, stratum, caustic, n, &c);
    orl_facet_sample_many(world->geometry, world->ports[stratum->port].facet,
                          (const double(*)[2])c.place, n, c.points);
    for (size_t i = 0; i < n; i++)
        ret_starts[i] = (struct orl_port_start){c.points[i], c.out[i], c.density[i]};
}
