/* GET /v1/jobs/{id}/document: the submitted document, byte for byte, so that it can be submitted
 * again. */
#include "handlers/handlers.h"

#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include <oriel/base/open.h>

#include "handlers/jobs/job_path.h"
#include "http/response/reply.h"
#include "server.h"

void orl_handle_job_document(struct orl_request *request)
{
    const struct orl_jobs_job *job = orl_job_of_path(request);
    char path[ORL_PATH_MAX];
    struct stat st;
    if (!job || orl_reply_if_none_match(request, job->row.document))
        return;
    orl_blob_path(&request->server->folders, job->row.document, path);
    const int fd = orl_open_regular(path, O_RDONLY | O_NOFOLLOW);
    if (fd < 0 || fstat(fd, &st) != 0) {
        struct orl_error err;
        orl_error_set(&err, ORL_ERR_IO, "the job's document cannot be read: %s",
                      orl_open_reason(errno));
        if (fd >= 0)
            close(fd);
        orl_reply_error(request, &err);
        return;
    }
    orl_reply_file(request, fd, (uint64_t)st.st_size, "application/json");
    orl_reply_etag(request, job->row.document);
    orl_reply_header(request, "Cache-Control", "no-cache");
}
