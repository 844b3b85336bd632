#include <oriel/run.h>

int orl_run(const struct orl_job *job, const struct orl_run_env *env, struct orl_result *ret_result,
            struct orl_error *err)
{
    (void)job, (void)env, (void)ret_result;
    return orl_error_set(err, ORL_ERR_UNSUPPORTED, "rendering is being built");
}
int orl_scene_check(const char *const *main_files, size_t n_files, const struct orl_files *files,
                    struct orl_scene_summary *ret_summary, struct orl_error *err)
{
    (void)main_files, (void)n_files, (void)files, (void)ret_summary;
    return orl_error_set(err, ORL_ERR_UNSUPPORTED, "rendering is being built");
}
void orl_scene_summary_done(struct orl_scene_summary *summary)
{
    (void)summary;
}
