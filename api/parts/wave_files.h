/*
 * The files of a wave (sharing.h): its parts, each with its pieces, and the note that it has not
 * ended yet. Waves go by their names.
 */
#ifndef ORL_PARTS_WAVE_FILES_H
#define ORL_PARTS_WAVE_FILES_H

#include "parts/limits.h"
#include "parts/sharing.h"

enum { ORL_PART_PATH = 4300 };

/* Writes both. *ret_parts: how many there are: parts without pieces are none. */
int orl_wave_write(const struct orl_sharing *sharing, const char *wave,
                   const struct orl_piece *pieces, size_t n, size_t *ret_parts,
                   struct orl_error *err);

/* The name of a wave in the folder that has not ended; false: there is none. */
bool orl_wave_find(const char *folder, char ret_wave[ORL_WAVE_NAME]);
/* It has; false: that cannot be noted. */
bool orl_wave_forget(const char *folder, const char *wave);
/* The parts of one that has not; 0: that cannot be read. */
size_t orl_wave_parts(const char *folder, const char *wave);
/* What a part is thought to take; all zero where that cannot be read. */
struct orl_part_needs orl_wave_needs(const char *folder, const char *wave, size_t number);
/* Sets ret_made of those of the pieces that its parts are to make. */
void orl_wave_mark(const char *folder, const char *wave, size_t n_parts,
                   const struct orl_piece *pieces, size_t n, bool *ret_made);

/* Whether WAVE-NUMBER.what is there. */
bool orl_part_file(const char *folder, const char *wave, size_t number, const char *what,
                   char ret_path[ORL_PART_PATH]);

/* Whether the folder's disk takes a small file, and its owner's quota. */
bool orl_wave_has_room(const char *folder);

#endif
