#include <oriel/base/thread_pool.h>

#include <pthread.h>
#include <stdlib.h>

#include <oriel/base/error.h>

struct orl_thread_pool {
    uint32_t size;
    pthread_mutex_t lock; /* guards the fields below except next, which is claimed without it */
    pthread_cond_t work, idle;
    uint64_t round;   /* incremented for each loop, so that a worker thread joins a loop once */
    uint32_t working; /* worker threads inside the current loop */
    bool stopping;
    size_t count;
    orl_loop_body body;
    void *arg;
    atomic_size_t next;
    const atomic_bool *cancel_flag; /* flag for orl_parallel_try; or NULL */
    const atomic_bool *cancel;      /* flag for the current loop; or NULL */
    pthread_t *threads;             /* n_threads threads of orl_thread_pool_start; else NULL */
    uint32_t n_threads;
};

struct orl_thread_pool *orl_thread_pool_new(uint32_t size)
{
    struct orl_thread_pool *pool = calloc(1, sizeof *pool);
    if (!pool)
        return NULL;
    pool->size = size ? size : 1;
    atomic_init(&pool->next, 0);
    if (pthread_mutex_init(&pool->lock, NULL) != 0) {
        free(pool);
        return NULL;
    }
    pthread_cond_init(&pool->work, NULL);
    pthread_cond_init(&pool->idle, NULL);
    return pool;
}

void orl_thread_pool_free(struct orl_thread_pool *pool)
{
    if (!pool)
        return;
    pthread_cond_destroy(&pool->idle);
    pthread_cond_destroy(&pool->work);
    pthread_mutex_destroy(&pool->lock);
    free(pool);
}

uint32_t orl_thread_pool_size(const struct orl_thread_pool *pool)
{
    return pool ? pool->size : 1;
}

static void claim_all(struct orl_thread_pool *pool, size_t count, orl_loop_body body, void *arg,
                      const atomic_bool *cancel, uint32_t member)
{
    size_t i;
    while (!orl_is_cancelled(cancel) &&
           (i = atomic_fetch_add_explicit(&pool->next, 1, memory_order_relaxed)) < count)
        body(arg, i, member);
}

void orl_thread_pool_work(struct orl_thread_pool *pool, uint32_t member)
{
    uint64_t last_round = 0;
    pthread_mutex_lock(&pool->lock);
    while (!pool->stopping) {
        if (pool->round == last_round || !pool->body) {
            pthread_cond_wait(&pool->work, &pool->lock);
            continue;
        }
        last_round = pool->round;
        pool->working++;
        const size_t count = pool->count;
        const orl_loop_body body = pool->body;
        void *const arg = pool->arg;
        const atomic_bool *const cancel = pool->cancel;
        pthread_mutex_unlock(&pool->lock);
        claim_all(pool, count, body, arg, cancel, member);
        pthread_mutex_lock(&pool->lock);
        if (--pool->working == 0)
            pthread_cond_signal(&pool->idle);
    }
    pthread_mutex_unlock(&pool->lock);
}

void orl_thread_pool_dismiss(struct orl_thread_pool *pool)
{
    pthread_mutex_lock(&pool->lock);
    pool->stopping = true;
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->lock);
}

static void run_loop(struct orl_thread_pool *pool, size_t count, orl_loop_body body, void *arg,
                     const atomic_bool *cancel)
{
    if (!pool) {
        for (size_t i = 0; i < count; i++)
            body(arg, i, 0);
        return;
    }
    pthread_mutex_lock(&pool->lock);
    pool->cancel = cancel;
    pool->count = count;
    pool->body = body;
    pool->arg = arg;
    pool->round++;
    atomic_store(&pool->next, 0);
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->lock);

    claim_all(pool, count, body, arg, cancel, 0);

    /* Once body is cleared, no worker thread joins the loop; the lead thread waits for those
     * inside. */
    pthread_mutex_lock(&pool->lock);
    pool->body = NULL;
    while (pool->working > 0)
        pthread_cond_wait(&pool->idle, &pool->lock);
    pthread_mutex_unlock(&pool->lock);
}

void orl_parallel_for(struct orl_thread_pool *pool, size_t count, orl_loop_body body, void *arg)
{
    run_loop(pool, count, body, arg, NULL);
}

void orl_thread_pool_set_cancel(struct orl_thread_pool *pool, const atomic_bool *cancel)
{
    pool->cancel_flag = cancel;
}

bool orl_thread_pool_cancelled(const struct orl_thread_pool *pool)
{
    return pool && orl_is_cancelled(pool->cancel_flag);
}

int orl_parallel_try(struct orl_thread_pool *pool, size_t count, orl_loop_body body, void *arg)
{
    run_loop(pool, count, body, arg, pool ? pool->cancel_flag : NULL);
    return orl_thread_pool_cancelled(pool) ? ORL_ERR_CANCELLED : 0;
}

struct member_start {
    struct orl_thread_pool *pool;
    uint32_t member;
};

static void *member_main(void *arg)
{
    const struct member_start start = *(struct member_start *)arg;
    free(arg);
    orl_thread_pool_work(start.pool, start.member);
    return NULL;
}

struct orl_thread_pool *orl_thread_pool_start(uint32_t size)
{
    struct orl_thread_pool *pool = orl_thread_pool_new(size);
    if (!pool || pool->size == 1)
        return pool;
    pool->threads = calloc(pool->size - 1, sizeof *pool->threads);
    for (uint32_t m = 1; pool->threads && m < pool->size; m++) {
        struct member_start *start = malloc(sizeof *start);
        if (!start)
            break;
        *start = (struct member_start){pool, m};
        if (pthread_create(&pool->threads[pool->n_threads], NULL, member_main, start) != 0) {
            free(start);
            break;
        }
        pool->n_threads++;
    }
    return pool; /* a pool with fewer threads than requested completes all work, too */
}

void orl_thread_pool_stop(struct orl_thread_pool *pool)
{
    if (!pool)
        return;
    orl_thread_pool_dismiss(pool);
    for (uint32_t i = 0; i < pool->n_threads; i++)
        pthread_join(pool->threads[i], NULL);
    free(pool->threads);
    orl_thread_pool_free(pool);
}
