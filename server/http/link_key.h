/*
 * The key of signed links (links.h): 32 random bytes in the data folder's file oriel.key, which
 * only its owner can read. It is not in the database, and a backup does not have it, so
 * copies of these are not enough to sign a link. A data folder without the file, as one restored
 * from a backup, gets a new key, and links that were signed before are no longer good.
 */
#ifndef ORL_SERVER_HTTP_LINK_KEY_H
#define ORL_SERVER_HTTP_LINK_KEY_H

#include "store/folders.h"

enum { ORL_LINK_KEY_BYTES = 32 };

/* Reads the key, or makes one. Where a new one cannot be kept, as on a full disk, it is good until
 * the daemon ends. */
int orl_link_key_open(const struct orl_folders *folders, unsigned char ret_key[ORL_LINK_KEY_BYTES],
                      struct orl_error *err);

#endif
