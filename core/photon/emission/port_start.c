#include "photon/emission/port_start.h"

#include "base/multiversion.h"
#include "photon/emission/distribution_2d.h"
#include "scene/material/hemisphere.h"

enum { N = ORL_STARTS_AT_ONCE };

/* Data of several starts, in columns. */
struct columns {
    double place[N][2], direction_u[N][2], pdf[N];
    struct orl_vec3 points[N], out[N];
};

/* Maps points of the square to directions in the outer hemisphere. */
ORL_FOR_WIDE_VECTORS
static void map_to_hemisphere(struct orl_vec3 outward, size_t n, struct columns *c)
{
    for (size_t i = 0; i < n; i++)
        c->out[i] = orl_hemisphere_about(outward, c->direction_u[i][0], c->direction_u[i][1]);
}

static void sample_dome(const struct orl_emission *e, const struct orl_stratum *stratum, size_t n,
                        struct columns *c)
{
    double at[N][2];
    orl_distribution_2d_sample_many(&e->port_distributions[stratum->port],
                                    (const double(*)[2])c->direction_u, n, at, c->pdf);
    for (size_t i = 0; i < n; i++) {
        c->direction_u[i][0] = at[i][0];
        c->direction_u[i][1] = at[i][1];
    }
    map_to_hemisphere(e->lit_scene->ports[stratum->port].outward, n, c);
}

static void sample_sun(const struct orl_emission *e, const struct orl_stratum *stratum,
                       bool caustic, size_t n, struct columns *c)
{
    const struct orl_lit_scene *lit_scene = e->lit_scene;
    if (stratum->kind == ORL_STRATUM_PORT_IMAGE)
        for (size_t i = 0; i < n; i++)
            c->out[i] = orl_virtual_sun_sample(lit_scene, &lit_scene->images.nodes[stratum->image],
                                               c->direction_u[i]);
    else
        orl_sun_sample_many(&lit_scene->suns[stratum->sun], (const double(*)[2])c->direction_u, n,
                            c->out);
    if (!caustic || !stratum->place.weight)
        return;
    double place[N][2];
    orl_distribution_2d_sample_many(&stratum->place, (const double(*)[2])c->place, n, place,
                                    c->pdf);
    for (size_t i = 0; i < n; i++) {
        c->place[i][0] = place[i][0];
        c->place[i][1] = place[i][1];
    }
}

void orl_port_starts(const struct orl_emission *emission, const struct orl_stratum *stratum,
                     bool caustic, const double *const *u, size_t n,
                     struct orl_port_start *ret_starts)
{
    const struct orl_lit_scene *lit_scene = emission->lit_scene;
    struct columns c;
    for (size_t i = 0; i < n; i++) {
        for (int k = 0; k < 2; k++) {
            c.place[i][k] = u[i][1 + k];
            c.direction_u[i][k] = u[i][3 + k];
        }
        c.pdf[i] = 1;
    }
    if (stratum->kind == ORL_STRATUM_PORT_DOME)
        sample_dome(emission, stratum, n, &c);
    else if (stratum->kind == ORL_STRATUM_PORT_LAMP)
        for (size_t i = 0; i < n; i++)
            /* the direction depends on the point; port_lamp.c samples it */
            c.out[i] = lit_scene->ports[stratum->port].outward;
    else
        sample_sun(emission, stratum, caustic, n, &c);
    orl_facet_sample_many(lit_scene->geometry, lit_scene->ports[stratum->port].facet,
                          (const double(*)[2])c.place, n, c.points);
    for (size_t i = 0; i < n; i++)
        ret_starts[i] = (struct orl_port_start){c.points[i], c.out[i], c.pdf[i]};
}
