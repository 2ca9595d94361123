/* A C host of one block's FMU, linked with its sources, to run under the compiler's sanitizers. The
 * calls of a version of FMI are in the file HOST_API.
 *     memory_host lives INTERFACE COUNT     one after the other, every hundredth with all calls
 *     memory_host threads INTERFACE COUNT   side by side, each in a thread of its own
 * COUNT is the number of instances, INTERFACE co_simulation or model_exchange. It exits with 1 and says why if a call fails, or if instances do not give the same as alone. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core.h"
#include "identity.h"

enum { STEPS = 200 };
static const double STEP = 1e-3;

static void fail(const char *what) {
    fprintf(stderr, "%s\n", what);
    exit(1);
}

#define MUST(call) \
    if ((call) != 0) fail("this call failed: " #call)
#define MUST_NOT(call) \
    if ((call) == 0) fail("this call was taken: " #call)

/* The value references of the inputs and of the outputs, and how many values these have. */
static unsigned input[N_INPUTS + 1], output[N_REFERENCES];
static size_t outputs, values;
static int exchange; /* whether instances are for model exchange */
enum { MOST_VALUES = 2 * N_REFERENCES };

#include HOST_API

static double plausible_size(const char *unit) {
    static const struct {
        const char *unit;
        double size;
    } SIZE[] = {{"m", 5e-3}, {"rad", 2e-3}, {"m/s", 0.1}, {"rad/s", 0.05}, {"N", 2e4}, {"N.m", 1e4}};
    for (size_t i = 0; i < sizeof SIZE / sizeof *SIZE; i++)
        if (strcmp(unit, SIZE[i].unit) == 0) return SIZE[i].size;
    return 0.0;
}

/* Inputs around their start values, another set for every seed and step. */
static void excite(double *value, int seed, int step) {
    for (int i = 0; i < N_INPUTS; i++) {
        const VariableInfo *info = &VARIABLE_INFO[FIRST_INPUT - 1 + i];
        value[i] = info->start + plausible_size(info->unit) * sin(1.0 + seed + 3.7 * i + 0.05 * step);
    }
}

static void start(void *c) {
    begin(c);
    if (!exchange) return;
    MUST(new_discrete_states(c));
    MUST(enter_continuous_mode(c));
}

/* Euler's method bears no more than this in the truck's stiff contacts. */
static const double EULER_STEP = 1e-5;

/* A step of Euler's method, after which there is an event. */
static void integrate(void *c, int step) {
    double x[N_CONTINUOUS + 1], rate[N_CONTINUOUS + 1], indicator[N_INDICATORS + 1];
    int event;
    MUST(set_time(c, step * EULER_STEP));
    MUST(get_states(c, x, N_CONTINUOUS));
    MUST(get_rates(c, rate, N_CONTINUOUS));
    for (int i = 0; i < N_CONTINUOUS; i++) x[i] += EULER_STEP * rate[i];
    MUST(set_time(c, (step + 1) * EULER_STEP));
    MUST(set_states(c, x, N_CONTINUOUS));
    MUST(get_indicators(c, indicator, N_INDICATORS));
    MUST(completed_step(c, &event));
    MUST(enter_event_mode(c));
    MUST(new_discrete_states(c));
    MUST(get_nominals(c, x, N_CONTINUOUS));
    MUST(enter_continuous_mode(c));
}

static void advance(void *c, int seed, int step) {
    double value[N_INPUTS + 1];
    excite(value, seed, step);
    MUST(set(c, input, N_INPUTS, value, N_INPUTS));
    if (exchange) integrate(c, step);
    else MUST(do_step(c, step * STEP, STEP));
}

/* Through a state in memory and one in bytes, and back. */
static void save_and_restore(void *c) {
    void *state = NULL, *copy = NULL;
    size_t size;
    MUST(get_state(c, &state));
    MUST(get_state(c, &state)); /* into the same memory */
    MUST(serialized_size(c, state, &size));
    char *bytes = malloc(size);
    MUST_NOT(serialize(c, state, bytes, size - 1));
    MUST(serialize(c, state, bytes, size));
    MUST_NOT(deserialize(c, bytes, size - 1, &copy));
    MUST(deserialize(c, bytes, size, &copy));
    free(bytes);
    advance(c, 1, 2);
    MUST(set_state(c, copy));
    MUST(set_state(c, state));
    MUST(free_state(c, &copy));
    MUST(free_state(c, &state));
    MUST(free_state(c, &state));
}

static void refused(void *c) {
    unsigned wrong[] = {0, PAST_THE_END, (unsigned)-1};
    double value[] = {NAN, 0.0, 0.0}, x[N_CONTINUOUS + 1] = {0.0};
    for (int i = 0; i < 3; i++) MUST_NOT(set(c, wrong + i, 1, value, 1));
    for (int i = 1; i < 3; i++) MUST_NOT(get(c, wrong + i, 1, value, 1));
    MUST_NOT(do_step(c, 0.0, -STEP));
    MUST_NOT(do_step(c, 0.0, NAN));
    MUST_NOT(set_states(c, x, N_CONTINUOUS + 1));
    MUST_NOT(enter_initialization(c));
}

/* All calls, and an end in the midst of a second run. */
static void live(int seed) {
    int refusals = 0;
    double value[MOST_VALUES];
    void *c = new_instance(&refusals);
    for (int life = 1; life <= 2; life++) {
        start(c);
        advance(c, seed, 0);
        derivatives(c);
        advance(c, seed, 1);
        save_and_restore(c);
        refused(c);
        MUST(get(c, output, outputs, value, values));
        if (life == 1) {
            MUST(terminate(c));
            MUST(reset(c));
        }
    }
    free_instance(c);
    if (refusals != 2 * 11) fail("not every refused call was logged once");
}

static void begin_and_end(void) {
    int refusals = 0;
    void *c = new_instance(&refusals);
    start(c);
    free_instance(c);
}

typedef struct {
    int seed;
    double result[STEPS][MOST_VALUES];
} Job;

static void *run(void *argument) {
    Job *job = argument;
    int refusals = 0;
    void *c = new_instance(&refusals);
    start(c);
    for (int k = 0; k < STEPS; k++) {
        advance(c, job->seed, k);
        MUST(get(c, output, outputs, job->result[k], values));
    }
    MUST(terminate(c));
    free_instance(c);
    return NULL;
}

static void side_by_side(int count) {
    Job *alone = calloc((size_t)count, sizeof *alone), *together = calloc((size_t)count, sizeof *together);
    pthread_t *thread = calloc((size_t)count, sizeof *thread);
    for (int i = 0; i < count; i++) {
        alone[i].seed = together[i].seed = i;
        run(&alone[i]);
    }
    for (int i = 0; i < count; i++) MUST(pthread_create(&thread[i], NULL, run, &together[i]));
    for (int i = 0; i < count; i++) MUST(pthread_join(thread[i], NULL));
    if (memcmp(alone, together, (size_t)count * sizeof *alone) != 0)
        fail("instances in threads of their own do not give what they give alone");
    free(thread);
    free(together);
    free(alone);
}

int main(int arguments, char **argument) {
    if (arguments != 4) fail("usage: memory_host lives|threads co_simulation|model_exchange COUNT");
    exchange = strcmp(argument[2], "model_exchange") == 0;
    int count = atoi(argument[3]);
    for (unsigned i = 0; i < N_INPUTS; i++) input[i] = FIRST_INPUT + i;
    list_outputs();
    if (strcmp(argument[1], "threads") == 0)
        side_by_side(count);
    else
        for (int i = 0; i < count; i++) {
            if (i % 100 == 0) live(i);
            else begin_and_end();
        }
    free_instance(NULL);
    return 0;
}
