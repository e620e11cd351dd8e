#include "base/workers.h"

#include <pthread.h>
#include <unistd.h>

enum {
    MOST_THREADS = 64
};

struct queue {
    const struct wb_workers *workers;
    pthread_mutex_t lock;
    int next, done;
    bool stopped;
};

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
    const struct wb_workers *const w = queue->workers;
    for (int i = take_next(queue); i >= 0; i = take_next(queue)) {
        const enum wb_status status = w->job(w->context, i);
        pthread_mutex_lock(&queue->lock);
        queue->done++;
        if (w->done && !w->done(w->context, i, status))
            queue->stopped = true;
        pthread_mutex_unlock(&queue->lock);
    }
    return NULL;
}

int wb_workers_run(const struct wb_workers *workers)
{
    struct queue queue = {.workers = workers, .lock = PTHREAD_MUTEX_INITIALIZER};
    const long processors = sysconf(_SC_NPROCESSORS_ONLN);
    const int wanted = workers->n_threads > 0 ? workers->n_threads : (int)processors;
    pthread_t threads[MOST_THREADS];
    int started = 0;
    while (started < wanted - 1 && started < workers->n - 1 && started < MOST_THREADS &&
           pthread_create(&threads[started], NULL, work, &queue) == 0)
        started++;
    work(&queue);
    for (int i = 0; i < started; i++)
        pthread_join(threads[i], NULL);
    return queue.done;
}
