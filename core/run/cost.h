/*
 * What work costs: samples, what they are by each technique, how long they take and what they
 * bring.
 *
 * The size of a round (rounds.h) is a number of samples of every sensor, or their mean where
 * sensors get different ones (sample_allocation.h). 4096 of them go with the photons, or virtual
 * lamps, that the planner thinks right for as many (few sensors by themselves: with fewer lamps,
 * which they pay for), and 64 with a sample of every pixel. Variances fall as their inverse.
 *
 * The schedule of rounds is here, since it also says what another digit would cost: a small one to
 * learn from, then one that is to reach the goal, then what is left.
 */
#ifndef ORL_RUN_COST_H
#define ORL_RUN_COST_H

#include "run/percentile.h"
#include "run/stages.h"

/* What is done by how many samples, for one job. */
struct orl_work {
    enum orl_technique technique;
    bool of_views;                    /* some, maybe beside sensors */
    bool shares;                      /* sensors may get different samples: unbiased, no views */
    uint64_t photons[ORL_SHOT_KINDS]; /* the planner's */
    double least, most;               /* samples of a round */
    double by_rays; /* of views by maps: the part of their usual time that goes as samples do,
                       for they have rays by these; 0: every round's are alike */
};

struct orl_work orl_work_of(const struct orl_run_state *state);

/* Photons of a kind, and samples of a pixel, that go with samples of a sensor. */
uint64_t orl_work_photons(const struct orl_work *work, int kind, double samples);
uint32_t orl_work_pixel_samples(double samples);

/* By photon maps a view's own work is the same however many photons there are, unless its rays go
 * by samples, too. */
bool orl_work_renders_alike(const struct orl_work *work);

/* Rays of views in a round of so many samples, as a painting has them (render/image/paint.h). */
double orl_work_view_rays(const struct orl_work *work, double samples);

/* The samples of the round after `done` of them, when `wanted` in all would do: by counts alone. */
double orl_work_next(const struct orl_work *work, double done, double wanted);

/* Areas of kernels in a round of so many samples after others, in terms of what the maps would
 * choose: see rounds.h. */
void orl_work_bandwidths(double samples, double before, double ret_bandwidths[ORL_MAP_KINDS]);

/* Samples in all that a job with a goal may take. */
double orl_work_limit(void);

/* How long it took, so far. */
struct orl_pace {
    double before_s;          /* until the first photon */
    double photons, photon_s; /* traced and put into maps; virtual lamps count */
    double samples, render_s;
    double views_s;          /* of render_s, where rays of views go by samples */
    double rounds, beside_s; /* what is not of the above */
};

/* Seconds of a round, and of a whole run in rounds until so many samples are taken. */
double orl_pace_round_s(const struct orl_pace *pace, const struct orl_work *work, double samples);
double orl_pace_run_s(const struct orl_pace *pace, const struct orl_work *work, double wanted);
/* Of the rounds that are left of it once `done` samples are taken; 0: none. */
double orl_pace_rest_s(const struct orl_pace *pace, const struct orl_work *work, double done,
                       double wanted);
/* Of its stages, from photons on: into foreseen_s, of which the others stay. */
void orl_pace_foresee(const struct orl_pace *pace, const struct orl_work *work, double samples,
                      double foreseen_s[ORL_STAGE_COUNT]);
/* Samples of a round that is to last so long: from the least, to `most` or what rounds may have. */
double orl_pace_samples(const struct orl_pace *pace, const struct orl_work *work, double seconds,
                        double most);

/* Of the parts of a job that have errors, the one that is worst: the parts are borrowed. */
struct orl_parts {
    const struct orl_estimates *parts;
    size_t count;
    double at;
};
double orl_parts_error(const struct orl_parts *parts); /* NaN when one is not known */
/* How many times the work so far it takes; NaN when it is not known. */
double orl_parts_work(const struct orl_parts *parts, double target);

/* Fills the predictions of the result's cost, and its counts, from what it took so far. */
void orl_run_predict(struct orl_run_state *state, const struct orl_pace *pace,
                     const struct orl_work *work, const struct orl_parts *parts);

/* What accuracies would take, from there on. */
void orl_run_draw_curve(const struct orl_run_state *state, const struct orl_pace *pace,
                        const struct orl_work *work, const struct orl_parts *parts,
                        struct orl_curve *ret_curve);

/*
 * The cost of a job that went in one piece. Of its views, some thousand pixels are taken note of as
 * each is finished; a view that there is no memory for is missing from the error.
 */
void orl_run_note_pixels(struct orl_run_state *state, size_t index, const struct orl_film *film);
void orl_run_cost(struct orl_run_state *state);
void orl_run_forget_pixels(struct orl_run_state *state);

#endif
