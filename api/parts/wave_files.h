/*
 * The files of a wave (sharing.h): its parts with their pieces, and a marker that it has not
 * ended. Waves are identified by name.
 */
#ifndef ORL_PARTS_WAVE_FILES_H
#define ORL_PARTS_WAVE_FILES_H

#include "parts/limits.h"
#include "parts/sharing.h"

enum { ORL_PART_PATH = 4300 };

/* Writes parts and marker. *ret_parts: number of parts; parts without pieces are not written. */
int orl_wave_write(const struct orl_sharing *sharing, const char *wave,
                   const struct orl_piece *pieces, size_t n, size_t *ret_parts,
                   struct orl_error *err);

/* Finds a wave in the folder that has not ended. Returns false if there is none. */
bool orl_wave_find(const char *folder, char ret_wave[ORL_WAVE_NAME]);
/* Removes the marker of a wave that has ended. Returns false if that fails. */
bool orl_wave_forget(const char *folder, const char *wave);
/* Returns the number of parts of a wave that has not ended; 0 if it cannot be read. */
size_t orl_wave_parts(const char *folder, const char *wave);
/* Returns the estimated needs of a part; all zero if they cannot be read. */
struct orl_part_needs orl_wave_needs(const char *folder, const char *wave, size_t number);
/* Sets ret_made for those pieces that belong to the wave's parts. */
void orl_wave_mark(const char *folder, const char *wave, size_t n_parts,
                   const struct orl_piece *pieces, size_t n, bool *ret_made);

/* Returns true if the file WAVE-NUMBER.what exists. */
bool orl_part_file(const char *folder, const char *wave, size_t number, const char *what,
                   char ret_path[ORL_PART_PATH]);

/* Returns true if a small file can be written in the folder: its disk and the owner's quota
 * have room. */
bool orl_wave_has_room(const char *folder);

#endif
