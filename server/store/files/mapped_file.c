#include "store/files/mapped_file.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/open.h>

int orl_map_file(const char *path, struct orl_file *ret_file, struct orl_error *err)
{
    struct stat st;
    const int fd = orl_open_regular(path, O_RDONLY);
    if (fd < 0 || fstat(fd, &st) != 0) {
        const int why = errno, code = orl_err_of_errno(why);
        orl_error_set(err, code, "cannot open a stored file: %s", orl_open_reason(why));
        if (fd >= 0)
            close(fd);
        return code;
    }
    int rc = 0;
    if (st.st_size == 0) {
        *ret_file = (struct orl_file){"", 0, NULL};
    } else {
        void *data = mmap(NULL, (size_t)st.st_size, PROT_READ, MAP_PRIVATE, fd, 0);
        if (data == MAP_FAILED)
            rc = orl_error_set(err, orl_err_of_errno(errno), "cannot map a stored file: %s",
                               strerror(errno));
        else
            *ret_file = (struct orl_file){data, (size_t)st.st_size, data};
    }
    close(fd);
    return rc;
}

void orl_unmap_file(struct orl_file *file)
{
    if (file->handle)
        munmap(file->handle, file->size);
    *file = (struct orl_file){0};
}
