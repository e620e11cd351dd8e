#include "base/workers.h"

#include <pthread.h>
#include <unistd.h>

#include "base/memory.h"

enum {
    MAX_THREADS = 64
};

struct queue {
    const struct wb_workers *workers;
    pthread_mutex_t lock;
    int next, done;
    bool stopped;
    bool is_guarded;
};

struct step {
    const struct wb_workers *workers;
    int index;
    enum wb_status status; /* of the job */
};

static enum wb_status do_job(void *context)
{
    const struct step *const step = context;
    return step->workers->job(step->workers->context, step->index);
}

static enum wb_status report_done(void *context)
{
    const struct step *const step = context;
    const struct wb_workers *const w = step->workers;
    return !w->done || w->done(w->context, step->index, step->status) ? WB_OK : WB_ERR_DATA;
}

static enum wb_status run(const struct queue *queue, enum wb_status (*function)(void *),
                          struct step *step)
{
    return queue->is_guarded ? wb_memory_try(function, step) : function(step);
}

static int take_next(struct queue *queue)
{
    pthread_mutex_lock(&queue->lock);
    const int i = queue->stopped || queue->next >= queue->workers->n ? -1 : queue->next++;
    pthread_mutex_unlock(&queue->lock);
    return i;
}

static void *work(void *context)
{
    struct queue *const queue = context;
    struct step step = {.workers = queue->workers};
    while ((step.index = take_next(queue)) >= 0) {
        step.status = run(queue, do_job, &step);
        pthread_mutex_lock(&queue->lock);
        queue->done++;
        if (run(queue, report_done, &step) != WB_OK)
            queue->stopped = true;
        pthread_mutex_unlock(&queue->lock);
    }
    return NULL;
}

int wb_workers_run(const struct wb_workers *workers)
{
    struct queue queue = {.workers = workers,
                          .lock = PTHREAD_MUTEX_INITIALIZER,
                          .is_guarded = wb_memory_is_guarded()};
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    const int wanted = workers->n_threads > 0 ? workers->n_threads : (int)processors;
    pthread_t threads[MAX_THREADS];
    int started = 0;
    while (started < wanted - 1 && started < workers->n - 1 && started < MAX_THREADS &&
           pthread_create(&threads[started], NULL, work, &queue) == 0)
        started++;
    work(&queue);
    for (int i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
    return queue.done;
}
