/* The table of classes of paths and of the strategies that find them. */
#include <oriel/job/paths.h>

#include <stddef.h>
#include <stdio.h>

enum {
    RAYS = ORL_PATHS_BY_BSDF_SAMPLING,
    PORTS = ORL_PATHS_BY_PORT_SAMPLING,
    SHADOW = ORL_PATHS_BY_SHADOW_RAYS,
    IMAGES = ORL_PATHS_BY_VIRTUAL_LIGHTS,
    BEAMS = ORL_PATHS_BY_SUN_LOBES,
    CAUSTIC = ORL_PATHS_BY_CAUSTIC_PHOTONS,
    GLOBAL = ORL_PATHS_BY_GLOBAL_PHOTONS,
    CHANCE = ORL_PATHS_BY_CHANCE
};

/* A cell whose strategies differ between receivers, and one whose strategies are the same. */
#define AIR_SURFACE(air, surface)                                                                  \
    {                                                                                              \
        air, surface                                                                               \
    }
#define BOTH(found) AIR_SURFACE(found, found)

/*
 * Strategies by class, then technique: plain path tracing, backward, gather, direct, precomputed.
 *
 * RAYS, PORTS, SHADOW, IMAGES and BEAMS sample the same variable, the direction at the receiver. If
 * a cell has several of them they are combined by the balance heuristic (Veach 1997, 9.2). Photons
 * are not combined with them: photons of light that these strategies find are not counted
 * (photon/tracing/trace.c).
 */
static const unsigned char strategies[ORL_PATH_CLASSES][ORL_TECHNIQUE_COUNT][ORL_RECEIVERS] = {
    /* Global photons start at windows with the radiance that arrives there. If the map is read
     * at the receiver itself, they contain the sky. */
    [ORL_PATHS_SKY] = {BOTH(RAYS), BOTH(RAYS | PORTS), BOTH(RAYS | PORTS),
                       AIR_SURFACE(RAYS | PORTS, GLOBAL), AIR_SURFACE(RAYS | PORTS, GLOBAL)},
    [ORL_PATHS_DIRECT] = {BOTH(SHADOW | RAYS), BOTH(SHADOW | RAYS), BOTH(SHADOW | RAYS),
                          BOTH(SHADOW | RAYS), BOTH(SHADOW | RAYS)},
    [ORL_PATHS_FLAT_MIRRORS] = {BOTH(IMAGES | RAYS), BOTH(IMAGES | RAYS),
                                AIR_SURFACE(IMAGES, CAUSTIC), AIR_SURFACE(IMAGES, CAUSTIC),
                                AIR_SURFACE(IMAGES, CAUSTIC)},
    /* Plain paths hit a sun by way of a lobe from few directions only. */
    [ORL_PATHS_LOBES] = {BOTH(CHANCE), BOTH(RAYS | BEAMS), AIR_SURFACE(BEAMS | CAUSTIC, CAUSTIC),
                         AIR_SURFACE(BEAMS | CAUSTIC, CAUSTIC),
                         AIR_SURFACE(BEAMS | CAUSTIC, CAUSTIC)},
    /* Photons would be few and bright. */
    [ORL_PATHS_NARROW_LOBES] = {BOTH(CHANCE), BOTH(SHADOW), BOTH(CHANCE), BOTH(CHANCE),
                                BOTH(CHANCE)},
    [ORL_PATHS_CURVED] = {BOTH(CHANCE), BOTH(CHANCE), BOTH(CAUSTIC), BOTH(CAUSTIC), BOTH(CAUSTIC)},
    /* Plain paths are too few for the image of a window in a lens. */
    [ORL_PATHS_SKY_CURVED] = {BOTH(CHANCE), BOTH(RAYS), BOTH(RAYS), AIR_SURFACE(RAYS, GLOBAL),
                              AIR_SURFACE(RAYS, GLOBAL)},
    [ORL_PATHS_MANY_SUN_MIRRORS] = {BOTH(CHANCE), BOTH(CHANCE), BOTH(CAUSTIC), BOTH(CAUSTIC),
                                    BOTH(CAUSTIC)},
    [ORL_PATHS_MANY_LAMP_MIRRORS] = {BOTH(CHANCE), BOTH(CHANCE), BOTH(CAUSTIC), BOTH(CAUSTIC),
                                     BOTH(CAUSTIC)},
    [ORL_PATHS_TWO_LAMP_MIRRORS] = {BOTH(CHANCE), BOTH(CHANCE), BOTH(CAUSTIC), BOTH(CAUSTIC),
                                    BOTH(CAUSTIC)},
    /* Paths connect to virtual point lights, which are global photons. Rays of a final gather read
     * the photon density where they end. */
    [ORL_PATHS_DIFFUSE] = {BOTH(RAYS), BOTH(RAYS | PORTS | GLOBAL), BOTH(RAYS | PORTS | GLOBAL),
                           AIR_SURFACE(RAYS | PORTS | GLOBAL, GLOBAL),
                           AIR_SURFACE(RAYS | PORTS | GLOBAL, GLOBAL)},
    /* Volumes do not scatter photons. */
    [ORL_PATHS_VOLUME] = {BOTH(RAYS), BOTH(RAYS), BOTH(0), BOTH(0), BOTH(0)},
};

static const struct {
    const char *name, *words;
} classes[ORL_PATH_CLASSES] = {
    [ORL_PATHS_SKY] = {"sky", "skies, ground and glows"},
    [ORL_PATHS_DIRECT] = {"direct", "suns and lamps, straight or through panes"},
    [ORL_PATHS_FLAT_MIRRORS] = {"flat-mirrors", "suns and lamps by way of flat mirrors and panes"},
    [ORL_PATHS_LOBES] = {"lobes", "suns and lamps scattered by BSDFs and other rough materials"},
    [ORL_PATHS_NARROW_LOBES] =
        {"narrow-lobes", "suns and lamps scattered by very narrow lobes of function materials"},
    [ORL_PATHS_CURVED] = {"curved",
                          "suns and lamps by way of curved mirrors, lenses or thick glass"},
    [ORL_PATHS_SKY_CURVED] = {"sky-curved",
                              "skies and glows by way of curved mirrors, lenses or thick glass"},
    [ORL_PATHS_MANY_SUN_MIRRORS] = {"many-sun-mirrors",
                                    "suns by way of flat mirrors in very many directions"},
    [ORL_PATHS_MANY_LAMP_MIRRORS] = {"many-lamp-mirrors", "lamps by way of very many flat mirrors"},
    [ORL_PATHS_TWO_LAMP_MIRRORS] = {"two-lamp-mirrors", "lamps by way of two flat mirrors"},
    [ORL_PATHS_DIFFUSE] = {"diffuse", "light reflected diffusely"},
    [ORL_PATHS_VOLUME] = {"mist", "light scattered by mist"},
};

const char *orl_path_class_name(enum orl_path_class class)
{
    return classes[class].name;
}

const char *orl_path_class_words(enum orl_path_class class)
{
    return classes[class].words;
}

void orl_path_classes_words(uint32_t set, char ret_text[ORL_PATH_CLASSES_TEXT])
{
    size_t length = 0;
    ret_text[0] = '\0';
    for (int i = 0; i < ORL_PATH_CLASSES; i++)
        if (set & 1U << i && length < ORL_PATH_CLASSES_TEXT)
            length += (size_t)snprintf(ret_text + length, ORL_PATH_CLASSES_TEXT - length, "%s%s",
                                       length > 0 ? ", or " : "", classes[i].words);
}

const char *orl_path_strategy_name(enum orl_path_strategy strategy)
{
    static const char *const names[ORL_PATH_STRATEGIES] = {
        "rays",  "port-rays",       "shadow-rays", "images",
        "beams", "caustic-photons", "photons",     "chance"};
    for (size_t i = 0; i < ORL_PATH_STRATEGIES; i++)
        if (strategy == 1U << i)
            return names[i];
    return NULL;
}

unsigned orl_path_strategies(enum orl_technique technique, enum orl_path_class class,
                             enum orl_path_receiver receiver)
{
    return strategies[class][technique][receiver];
}

uint32_t orl_paths_missed(enum orl_technique technique, uint32_t set)
{
    uint32_t missed = 0;
    for (int i = 0; i < ORL_PATH_CLASSES; i++)
        for (int receiver = 0; receiver < ORL_RECEIVERS; receiver++) {
            const unsigned found = strategies[i][technique][receiver];
            if (found == 0 || found == CHANCE)
                missed |= 1U << i;
        }
    return missed & set;
}

enum orl_path_class orl_paths_first(uint32_t set)
{
    int i = 0;
    while (i < ORL_PATH_CLASSES && !(set & 1U << i))
        i++;
    return (enum orl_path_class)i;
}
