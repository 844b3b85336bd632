/*
 * Classes of light paths, and the sampling strategies by which each technique finds them.
 *
 * The class of a path is its part from the source to the first diffuse or rough scattering. After
 * that it is diffusely reflected light, whatever its beginning. The planner determines the classes
 * of a scene (core/plan/choose_technique.c), and the classes that a technique finds by chance only.
 * It chooses techniques, warnings and checks accordingly. The table of strategies is
 * core/light/path_classes.c; core/light/README.md shows it.
 */
#ifndef ORIEL_JOB_PATHS_H
#define ORIEL_JOB_PATHS_H

#include <stdint.h>

#include <oriel/job/plan.h>

enum orl_path_class {
    ORL_PATHS_SKY,          /* sky, ground and other wide glow sources, directly or through panes */
    ORL_PATHS_DIRECT,       /* suns and lamps, directly or through panes and openings */
    ORL_PATHS_FLAT_MIRRORS, /* suns and lamps by flat mirrors and panes with virtual images */
    ORL_PATHS_LOBES,        /* suns and lamps scattered by BSDFs, rough metal or plastic, trans */
    ORL_PATHS_NARROW_LOBES, /* by function lobes too narrow for sampling to find */
    ORL_PATHS_CURVED,       /* suns and lamps by curved mirrors, lenses, prisms, thick glass */
    ORL_PATHS_SKY_CURVED,   /* skies and glows by curved mirrors, lenses, prisms, thick glass */
    ORL_PATHS_MANY_SUN_MIRRORS,  /* suns by flat mirrors in directions without virtual images */
    ORL_PATHS_MANY_LAMP_MIRRORS, /* lamps by lamp-mirror pairs beyond those with virtual images */
    ORL_PATHS_TWO_LAMP_MIRRORS,  /* lamps by two flat mirrors in succession */
    ORL_PATHS_DIFFUSE,           /* reflected diffusely */
    ORL_PATHS_VOLUME,            /* scattered by mist */
    ORL_PATH_CLASSES
};
const char *orl_path_class_name(enum orl_path_class class);  /* "sky", "flat-mirrors", ... */
const char *orl_path_class_words(enum orl_path_class class); /* "suns and lamps by ..." */
/* Writes the words of all classes of a set (flags 1 << class), joined by ", or ". */
enum { ORL_PATH_CLASSES_TEXT = 1024 };
void orl_path_classes_words(uint32_t classes, char ret_text[ORL_PATH_CLASSES_TEXT]);

/* Sampling strategies, as flags. */
enum orl_path_strategy {
    ORL_PATHS_BY_BSDF_SAMPLING = 1,  /* BSDF and cosine sampling, where it is effective */
    ORL_PATHS_BY_PORT_SAMPLING = 2,  /* rays aimed at windows and openings; combined with the above
                                   by  multiple importance sampling (MIS) */
    ORL_PATHS_BY_SHADOW_RAYS = 4,    /* next-event estimation; MIS with rays that hit lamps */
    ORL_PATHS_BY_VIRTUAL_LIGHTS = 8, /* next-event estimation of virtual images; MIS likewise */
    ORL_PATHS_BY_SUN_LOBES = 16, /* rays aimed along sun lobes behind panes; MIS with the above */
    /* Density on surfaces, or flux of photons past sensors in air. */
    ORL_PATHS_BY_CAUSTIC_PHOTONS = 32,
    ORL_PATHS_BY_GLOBAL_PHOTONS =
        64, /* global photons: density, records, or virtual point lights of paths */
    ORL_PATHS_BY_CHANCE = 128 /* only by rays or photons that happen to hit a small target */
};
enum { ORL_PATH_STRATEGIES = 8 };
const char *orl_path_strategy_name(enum orl_path_strategy strategy); /* "shadow-rays", ... */

/* Receivers of light: a sensor in mid-air, or a surface, with a sensor on it or seen in a view. */
enum orl_path_receiver { ORL_RECEIVER_AIR, ORL_RECEIVER_SURFACE, ORL_RECEIVERS };

/* Returns the strategies by which the technique finds the class. 0: it finds none of it, and jobs
 * with such light are rejected. ORL_TECHNIQUE_AUTO stands for plain path tracing with shadow rays,
 * which checks results (core/run/diagnostics/cross_check.c). */
unsigned orl_path_strategies(enum orl_technique technique, enum orl_path_class class,
                             enum orl_path_receiver receiver);

/* Returns the subset of the classes (flags 1 << class) that the technique finds by chance only, or
 * not at all, at one of the receivers. */
uint32_t orl_paths_missed(enum orl_technique technique, uint32_t classes);
/* Returns the first class of a set, which must not be empty. */
enum orl_path_class orl_paths_first(uint32_t classes);

#endif
