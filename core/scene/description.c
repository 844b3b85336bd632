#include "scene/description.h"

#include <stdlib.h>
#include <string.h>

#include "scene/storage.h"

void orl_description_done(struct orl_description *description)
{
    if (!description)
        return;
    for (size_t i = 0; i < description->n_materials; i++)
        orl_bsdf_unref(description->materials[i].bsdf);
    free(description->materials);
    free(description->surfaces);
    free(description->distants);
    free(description->skies);
    free(description->files);
    free(description->warnings);
    orl_storage_free(description->storage);
    memset(description, 0, sizeof *description);
}
