/* A gate that a writer's thread passes before each round: tests can stop the thread there and wait
 * until it has reached the gate. */
#ifndef WB_TESTS_DAQ_GATE_H
#define WB_TESTS_DAQ_GATE_H

#include <pthread.h>
#include <stdbool.h>

struct gate {
    pthread_mutex_t lock;
    pthread_cond_t changed;
    bool shut;
    int arrived;
};

#define GATE(is_shut)                                                                              \
    {                                                                                              \
        .lock = PTHREAD_MUTEX_INITIALIZER, .changed = PTHREAD_COND_INITIALIZER, .shut = (is_shut), \
    }

/* `context` is the gate. */
static inline void gate_pass(void *context)
{
    struct gate *const gate = context;
    pthread_mutex_lock(&gate->lock);
    gate->arrived++;
    pthread_cond_broadcast(&gate->changed);
    while (gate->shut)
        pthread_cond_wait(&gate->changed, &gate->lock);
    pthread_mutex_unlock(&gate->lock);
}

static inline void gate_set(struct gate *gate, bool shut)
{
    pthread_mutex_lock(&gate->lock);
    gate->shut = shut;
    pthread_cond_broadcast(&gate->changed);
    pthread_mutex_unlock(&gate->lock);
}

static inline int gate_arrived(struct gate *gate)
{
    pthread_mutex_lock(&gate->lock);
    const int arrived = gate->arrived;
    pthread_mutex_unlock(&gate->lock);
    return arrived;
}

/* Waits until the thread has reached the gate this many times in total. */
static inline void gate_await(struct gate *gate, int arrived)
{
    pthread_mutex_lock(&gate->lock);
    while (gate->arrived < arrived)
        pthread_cond_wait(&gate->changed, &gate->lock);
    pthread_mutex_unlock(&gate->lock);
}

/* Waits for the second round from now; entries pushed before have then been written or have failed.
 * The gate must be open. */
static inline void gate_await_rounds(struct gate *gate)
{
    gate_await(gate, gate_arrived(gate) + 2);
}

#endif
