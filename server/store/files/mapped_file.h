/* Memory maps of stored files. */
#ifndef ORL_STORE_FILES_MAPPED_FILE_H
#define ORL_STORE_FILES_MAPPED_FILE_H

#include <oriel/base/error.h>
#include <oriel/base/files.h>

/* Maps a whole file read-only; an empty one gives "". Undo it with orl_unmap_file. */
int orl_map_file(const char *path, struct orl_file *ret_file, struct orl_error *err);
void orl_unmap_file(struct orl_file *file);

#endif
