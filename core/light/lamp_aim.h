/*
 * Points of lamps as shadow rays aim at them: of a sphere uniform over the cone that it fills, of
 * any other surface uniform by area. Directions are unit, places in moved coordinates.
 */
#ifndef ORL_LIGHT_LAMP_AIM_H
#define ORL_LIGHT_LAMP_AIM_H

#include "light/world.h"

/* A point of an emitter as seen from somewhere, and the solid angle that it stands for. */
struct orl_lamp_aim {
    struct orl_vec3 light;  /* unit, towards the point */
    struct orl_vec3 normal; /* there */
    double distance, measure_sr;
};
/* u: two numbers in [0,1). False where the point shows its back, or a sphere its inside. */
bool orl_lamp_aim(const struct orl_world *world, const struct orl_emitter *emitter,
                  struct orl_vec3 from, const double u[2], struct orl_lamp_aim *ret_aim);

/* The density, per steradian, with which that direction is drawn. */
static inline double orl_lamp_aim_pdf(const struct orl_lamp_aim *aim)
{
    return 1 / aim->measure_sr;
}

/* The density, per steradian, with which an aim from there draws the direction to that hit of the
 * lamp. */
double orl_lamp_aim_pdf_of_hit(const struct orl_world *world, const struct orl_hit *hit,
                               struct orl_vec3 from);

#endif
