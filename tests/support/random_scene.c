#include "support/random_scene.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/sampling/sampling.h"

struct writer {
    struct random_scene *scene;
    struct orl_random random;
    size_t used;
};

static void put_text(struct writer *w, const char *format, ...)
    __attribute__((format(printf, 2, 3)));
static void put_text(struct writer *w, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    const int n =
        vsnprintf(w->scene->text + w->used, sizeof w->scene->text - w->used, format, args);
    va_end(args);
    w->used += n > 0 ? (size_t)n : 0;
}

static double between(struct writer *w, double low, double high)
{
    return low + (high - low) * orl_random_uniform(&w->random);
}

static bool happens(struct writer *w, double chance)
{
    return orl_random_uniform(&w->random) < chance;
}

/* Reflectances: all black, all gray, or some with a tint. */
static void put_walls(struct writer *w)
{
    static const char *const names[6] = {"floor", "ceiling", "west", "east", "north", "south"};
    static const char *const shapes[6] = {
        "12 0 0 0 4 0 0 4 5 0 0 5 0",
        "12 0 0 3 0 5 3 4 5 3 4 0 3",
        "12 0 0 0 0 5 0 0 5 3 0 0 3",
        "12 4 0 0 4 0 3 4 5 3 4 5 0",
        "12 0 5 0 4 5 0 4 5 3 0 5 3",
        "30 0 0 0 0 0 3 4 0 3 4 0 0 0 0 0 1 0 1 3 0 1 3 0 2.5 1 0 2.5 1 0 1",
    };
    const bool tinted = happens(w, 0.4);
    w->scene->black = happens(w, 0.15);
    for (int i = 0; i < 6; i++) {
        const double rho = w->scene->black ? 0 : between(w, 0, 0.8);
        const double red = tinted ? rho * between(w, 0.5, 1) : rho;
        put_text(w, "void plastic m%d 0 0 5 %.3f %.3f %.3f 0 0\nm%d polygon %s 0 0 %s\n", i, red,
                 rho, rho, i, names[i], shapes[i]);
    }
}

static void put_window(struct writer *w)
{
    static const char pane[] = "p polygon pane 0 0 12 1 0 1 1 0 2.5 3 0 2.5 3 0 1\n";
    const double kind = orl_random_uniform(&w->random);
    w->scene->bsdf = kind < 0.35;
    if (w->scene->bsdf)
        put_text(w, "void BSDF p 6 0 pane.xml 0 0 1 . 0 0\n%s", pane);
    else if (kind < 0.85)
        put_text(w, "void glass p 0 0 3 .9 .9 .9\n%s", pane);
}

static void put_lights(struct writer *w)
{
    w->scene->sky = happens(w, 0.7);
    w->scene->sun = happens(w, 0.6);
    if (w->scene->sky)
        put_text(w, "void glow g 0 0 4 %g %g %g 0\ng source sky 0 0 4 0 0 1 180\n", 10.0,
                 happens(w, 0.5) ? 10.0 : 8.0, 10.0);
    if (w->scene->sun) {
        const double brightness = happens(w, 0.15) ? 1e-3 : 2e6;
        put_text(w, "void light l 0 0 3 %g %g %g\nl source sun 0 0 4 %.3f %.3f %.3f .533\n",
                 brightness, brightness, brightness, between(w, -0.7, 0.7), between(w, -1, 0.6),
                 between(w, 0.2, 1));
    }
    w->scene->lamp = happens(w, 0.3) || (!w->scene->sky && !w->scene->sun);
    if (w->scene->lamp) {
        const double radiance = happens(w, 0.3) ? 1e-7 : 100;
        put_text(w, "void light b 0 0 3 %g %g %g\nb sphere bulb 0 0 4 2 4.5 2.7 .05\n", radiance,
                 radiance, radiance);
    }
}

/* Adds objects that are easily missed. */
static void put_things(struct writer *w)
{
    w->scene->mirror = happens(w, 0.4);
    if (w->scene->mirror) {
        const double x = between(w, 0.5, 3), y = between(w, 0.3, 3), side = between(w, 0.05, 0.3);
        put_text(w,
                 "void mirror r 0 0 3 .9 .9 .9\n"
                 "r polygon glint 0 0 12 %.3f %.3f .02 %.3f %.3f .02 %.3f %.3f .02 %.3f %.3f .02\n",
                 x, y, x + side, y, x + side, y + side, x, y + side);
    }
    w->scene->red = happens(w, 0.3);
    if (w->scene->red) /* hidden from the window by a white screen */
        put_text(
            w, "void plastic s 0 0 5 .8 .8 .8 0 0\ns polygon screen 0 0 12 .5 3 0 3.5 3 0 3.5 3 2 "
               ".5 3 2\nvoid plastic q 0 0 5 .8 .05 .05 0 0\n"
               "q polygon behind 0 0 12 .5 3.01 0 .5 3.01 2 3.5 3.01 2 3.5 3.01 0\n");
    w->scene->opposite = happens(w, 0.4);
    if (w->scene->opposite)
        put_text(w, "void plastic o 0 0 5 .7 .7 .6 0 0\n"
                    "o polygon opposite 0 0 12 -5 -8 -4 9 -8 -4 9 -8 6 -5 -8 6\n"
                    "o polygon street 0 0 12 -9 -9 -4 9 -9 -4 9 -.5 -4 -9 -.5 -4\n");
    w->scene->glossy = happens(w, 0.3);
    if (w->scene->glossy)
        put_text(w,
                 "void plastic t 0 0 5 .3 .3 .3 %.3f .1\n"
                 "t polygon table 0 0 12 2.2 1 .75 3.4 1 .75 3.4 2 .75 2.2 2 .75\n",
                 happens(w, 0.3) ? 0.001 : 0.05);
    w->scene->block = happens(w, 0.1);
    if (w->scene->block)
        put_text(w, "void dielectric d 0 0 5 .9 .9 .9 1.5 0\nd sphere block 0 0 4 1 1.2 .3 .2\n");
}

void random_scene(uint32_t index, struct random_scene *ret_scene)
{
    struct writer w = {.scene = ret_scene,
                       .random = orl_random_stream(index, ORL_PURPOSE_BENCH, 171)};
    memset(ret_scene, 0, sizeof *ret_scene);
    put_walls(&w);
    put_window(&w);
    put_lights(&w);
    put_things(&w);
    for (int i = 0; i < RANDOM_SENSORS; i++) {
        const double z = i < 2 ? 0.001 : between(&w, 0.3, 2.7);
        const struct orl_vec3 up = orl_v3(0, 0, 1), any = orl_v3(between(&w, -1, 1), -1, 0.2);
        ret_scene->sensors[i] = (struct orl_sensor){
            orl_v3(between(&w, 0.2, 3.8), between(&w, 0.2, 4.8), z), i < 3 ? up : any};
    }
}
