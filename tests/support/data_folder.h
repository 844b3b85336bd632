/*
 * A data folder with its database, opened as by the daemon, for tests of code that uses both. It
 * can be closed and opened again, as by a restart.
 */
#ifndef ORL_TESTS_SUPPORT_DATA_FOLDER_H
#define ORL_TESTS_SUPPORT_DATA_FOLDER_H

#include "store/database/db.h"
#include "store/files/folders.h"

struct data_folder {
    char root[64];
    struct orl_folders folders;
    struct orl_db db;
};

/* Create an empty folder and open it; return 0 or a negative orl_err. */
int data_folder_make(struct data_folder *data, struct orl_error *err);
int data_folder_open(struct data_folder *data, struct orl_error *err);
void data_folder_close(struct data_folder *data);
/* Removes the closed folder and all its files. */
void data_folder_remove(struct data_folder *data);

#endif
