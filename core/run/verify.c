#include <string.h>

#include <oriel/run.h>

#include "photon/map/map.h"

int orl_map_verify(const char *kind, const char *path, struct orl_error *err)
{
    struct orl_photon_map *map = NULL;
    if (strcmp(kind, "bsdf") == 0)
        return 0;
    const int rc = orl_photon_map_open(path, true, &map, err);
    orl_photon_map_free(map);
    return rc < 0 ? rc : 0;
}
