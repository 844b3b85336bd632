/*
 * The key of signed links (signed_links.h): 32 random bytes in the data folder's file oriel.key,
 * which only its owner can read. It is not in the database or in a backup, so copies of these are
 * not enough to sign a link. A data folder without the file, such as one restored from a backup,
 * gets a new key. Links that were signed before are then invalid.
 */
#ifndef ORL_SERVER_HTTP_ACCESS_LINK_KEY_H
#define ORL_SERVER_HTTP_ACCESS_LINK_KEY_H

#include "store/files/folders.h"

enum { ORL_LINK_KEY_BYTES = 32 };

/* Reads the key, or makes one. If a new key cannot be stored, as on a full disk, it is valid until
 * the daemon ends. */
int orl_link_key_open(const struct orl_folders *folders, unsigned char ret_key[ORL_LINK_KEY_BYTES],
                      struct orl_error *err);

#endif
