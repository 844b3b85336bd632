#include "support/data_folder.h"

#include <stdio.h>
#include <stdlib.h>

#include "store/database/db.h"

int data_folder_open(struct data_folder *data, struct orl_error *err)
{
    char path[ORL_PATH_MAX];
    int rc = orl_folders_open(&data->folders, data->root, err);
    orl_folders_path(&data->folders, path, "oriel.db");
    if (rc == 0)
        rc = orl_db_open(&data->db, path, err);
    return rc ? rc : orl_db_migrate_embedded(&data->db, err);
}

int data_folder_make(struct data_folder *data, struct orl_error *err)
{
    snprintf(data->root, sizeof data->root, "/tmp/oriel-test-XXXXXX");
    return mkdtemp(data->root) ? data_folder_open(data, err)
                               : orl_error_set(err, ORL_ERR_IO, "there is no temporary folder");
}

void data_folder_close(struct data_folder *data)
{
    orl_db_close(&data->db);
    orl_folders_close(&data->folders);
}

void data_folder_remove(struct data_folder *data)
{
    orl_remove_tree(data->root, NULL);
}
