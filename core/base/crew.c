#include <oriel/crew.h>

#include <pthread.h>
#include <stdlib.h>

#include <oriel/error.h>

struct orl_crew {
    uint32_t size;
    pthread_mutex_t lock; /* guards the members below except next, which is claimed without it */
    pthread_cond_t work, idle;
    uint64_t round;   /* bumped for each loop, so that a server joins a loop once */
    uint32_t working; /* servers inside the current loop */
    bool dismissed;
    size_t count;
    orl_crew_body body;
    void *arg;
    atomic_size_t next;
    const atomic_bool *heeded; /* flag for orl_crew_try; or NULL */
    const atomic_bool *cancel; /* flag for the current loop; or NULL */
    pthread_t *threads;        /* n_threads threads of orl_crew_start; else NULL */
    uint32_t n_threads;
};

struct orl_crew *orl_crew_new(uint32_t size)
{
    struct orl_crew *crew = calloc(1, sizeof *crew);
    if (!crew)
        return NULL;
    crew->size = size ? size : 1;
    atomic_init(&crew->next, 0);
    if (pthread_mutex_init(&crew->lock, NULL) != 0) {
        free(crew);
        return NULL;
    }
    pthread_cond_init(&crew->work, NULL);
    pthread_cond_init(&crew->idle, NULL);
    return crew;
}

void orl_crew_free(struct orl_crew *crew)
{
    if (!crew)
        return;
    pthread_cond_destroy(&crew->idle);
    pthread_cond_destroy(&crew->work);
    pthread_mutex_destroy(&crew->lock);
    free(crew);
}

uint32_t orl_crew_size(const struct orl_crew *crew)
{
    return crew ? crew->size : 1;
}

static void claim_all(struct orl_crew *crew, size_t count, orl_crew_body body, void *arg,
                      const atomic_bool *cancel, uint32_t member)
{
    size_t i;
    while (!orl_is_cancelled(cancel) &&
           (i = atomic_fetch_add_explicit(&crew->next, 1, memory_order_relaxed)) < count)
        body(arg, i, member);
}

void orl_crew_serve(struct orl_crew *crew, uint32_t member)
{
    uint64_t seen = 0;
    pthread_mutex_lock(&crew->lock);
    while (!crew->dismissed) {
        if (crew->round == seen || !crew->body) {
            pthread_cond_wait(&crew->work, &crew->lock);
            continue;
        }
        seen = crew->round;
        crew->working++;
        const size_t count = crew->count;
        const orl_crew_body body = crew->body;
        void *const arg = crew->arg;
        const atomic_bool *const cancel = crew->cancel;
        pthread_mutex_unlock(&crew->lock);
        claim_all(crew, count, body, arg, cancel, member);
        pthread_mutex_lock(&crew->lock);
        if (--crew->working == 0)
            pthread_cond_signal(&crew->idle);
    }
    pthread_mutex_unlock(&crew->lock);
}

void orl_crew_dismiss(struct orl_crew *crew)
{
    pthread_mutex_lock(&crew->lock);
    crew->dismissed = true;
    pthread_cond_broadcast(&crew->work);
    pthread_mutex_unlock(&crew->lock);
}

static void run_loop(struct orl_crew *crew, size_t count, orl_crew_body body, void *arg,
                     const atomic_bool *cancel)
{
    if (!crew) {
        for (size_t i = 0; i < count; i++)
            body(arg, i, 0);
        return;
    }
    pthread_mutex_lock(&crew->lock);
    crew->cancel = cancel;
    crew->count = count;
    crew->body = body;
    crew->arg = arg;
    crew->round++;
    atomic_store(&crew->next, 0);
    pthread_cond_broadcast(&crew->work);
    pthread_mutex_unlock(&crew->lock);

    claim_all(crew, count, body, arg, cancel, 0);

    /* Clearing body keeps servers from joining late; the lead waits for those that are inside. */
    pthread_mutex_lock(&crew->lock);
    crew->body = NULL;
    while (crew->working > 0)
        pthread_cond_wait(&crew->idle, &crew->lock);
    pthread_mutex_unlock(&crew->lock);
}

void orl_crew_for(struct orl_crew *crew, size_t count, orl_crew_body body, void *arg)
{
    run_loop(crew, count, body, arg, NULL);
}

void orl_crew_heed(struct orl_crew *crew, const atomic_bool *cancel)
{
    crew->heeded = cancel;
}

bool orl_crew_cancelled(const struct orl_crew *crew)
{
    return crew && orl_is_cancelled(crew->heeded);
}

int orl_crew_try(struct orl_crew *crew, size_t count, orl_crew_body body, void *arg)
{
    run_loop(crew, count, body, arg, crew ? crew->heeded : NULL);
    return orl_crew_cancelled(crew) ? ORL_ERR_CANCELLED : 0;
}

struct member_start {
    struct orl_crew *crew;
    uint32_t member;
};

static void *member_main(void *arg)
{
    const struct member_start start = *(struct member_start *)arg;
    free(arg);
    orl_crew_serve(start.crew, start.member);
    return NULL;
}

struct orl_crew *orl_crew_start(uint32_t size)
{
    struct orl_crew *crew = orl_crew_new(size);
    if (!crew || crew->size == 1)
        return crew;
    crew->threads = calloc(crew->size - 1, sizeof *crew->threads);
    for (uint32_t m = 1; crew->threads && m < crew->size; m++) {
        struct member_start *start = malloc(sizeof *start);
        if (!start)
            break;
        *start = (struct member_start){crew, m};
        if (pthread_create(&crew->threads[crew->n_threads], NULL, member_main, start) != 0) {
            free(start);
            break;
        }
        crew->n_threads++;
    }
    return crew; /* also a smaller crew than requested completes all work */
}

void orl_crew_stop(struct orl_crew *crew)
{
    if (!crew)
        return;
    orl_crew_dismiss(crew);
    for (uint32_t i = 0; i < crew->n_threads; i++)
        pthread_join(crew->threads[i], NULL);
    free(crew->threads);
    orl_crew_free(crew);
}
