#include "handlers/jobs/job_path.h"

#include <stdio.h>

#include "http/context.h"
#include "http/response/reply.h"
#include "server.h"

const struct orl_jobs_job *orl_job_of_path(struct orl_request *request)
{
    bool several = false;
    const struct orl_jobs_job *job =
        orl_jobs_find_prefix(request->server->jobs, request->params[0], &several);
    if (several)
        orl_reply_problem(request, 404, "ambiguous", "Several jobs are meant",
                          "the ids of several jobs begin with %.40s", request->params[0]);
    else if (!job)
        orl_reply_not_found(request, "job");
    else
        snprintf(request->job, sizeof request->job, "%s", job->row.id);
    return job;
}

void orl_job_reply_when_ended(struct orl_request *request, const struct orl_jobs_job *job)
{
    if (job->row.state >= ORL_JOB_SUCCEEDED)
        orl_reply_when_commit_durable(request, job->commit);
}
