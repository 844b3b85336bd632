#include <string.h>

#include <oriel/job/run.h>

#include "photon/map/map.h"
#include "run/cache/word_file.h"

int orl_map_verify(const char *kind, const char *path, struct orl_error *err)
{
    struct orl_photon_map *map = NULL;
    if (strcmp(kind, "bsdf") == 0 || strcmp(kind, "scene") == 0)
        return 0;
    if (strcmp(kind, "annual") == 0 || strcmp(kind, "made") == 0) {
        struct orl_word_file_info file_info;
        return orl_word_file_read(path, NULL, &file_info, NULL, NULL, err);
    }
    const int rc = orl_photon_map_open(path, true, &map, err);
    orl_photon_map_free(map);
    return rc < 0 ? rc : 0;
}
