/* A C host of one block's FMU, linked with its sources, to run under the compiler's sanitizers:
 *     memory_host lives COUNT       instances one after the other, from their creation to their end
 *     memory_host threads COUNT     instances side by side, each in a thread of its own
 * It exits with 1 and says why if a call fails, or if instances do not give the same as alone. */
#include <math.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core.h"

typedef struct {
    void (*logger)(void *, const char *, int, const char *, const char *, ...);
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

void *fmi2Instantiate(const char *, int, const char *, const char *, const Callbacks *, int, int);
void fmi2FreeInstance(void *);
int fmi2SetupExperiment(void *, int, double, double, int, double);
int fmi2EnterInitializationMode(void *);
int fmi2ExitInitializationMode(void *);
int fmi2Terminate(void *);
int fmi2Reset(void *);
int fmi2SetReal(void *, const unsigned *, size_t, const double *);
int fmi2GetReal(void *, const unsigned *, size_t, double *);
int fmi2SetRealInputDerivatives(void *, const unsigned *, size_t, const int *, const double *);
int fmi2DoStep(void *, double, double, int);
int fmi2GetFMUstate(void *, void **);
int fmi2SetFMUstate(void *, void *);
int fmi2FreeFMUstate(void *, void **);
int fmi2SerializedFMUstateSize(void *, void *, size_t *);
int fmi2SerializeFMUstate(void *, void *, char *, size_t);
int fmi2DeSerializeFMUstate(void *, const char *, size_t, void **);
int fmi2GetDirectionalDerivative(void *, const unsigned *, size_t, const unsigned *, size_t,
                                 const double *, double *);

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

static void logger(void *refusals, const char *name, int status, const char *category,
                   const char *format, ...) {
    (void)name, (void)status, (void)category, (void)format;
    ++*(int *)refusals;
}

/* The value references of the inputs and of the outputs. */
static unsigned input[N_INPUTS + 1], output[N_OUTPUTS + 1];

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

static void *new_instance(int *refusals) {
    Callbacks callbacks = {logger, calloc, free, NULL, refusals};
    void *c = fmi2Instantiate("host", 1, GUID, "", &callbacks, 0, 0);
    if (!c) fail("no instance");
    return c;
}

static void begin(void *c) {
    MUST(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0));
    MUST(fmi2EnterInitializationMode(c));
    MUST(fmi2ExitInitializationMode(c));
}

static void advance(void *c, int seed, int step) {
    double value[N_INPUTS + 1];
    excite(value, seed, step);
    MUST(fmi2SetReal(c, input, N_INPUTS, value));
    MUST(fmi2DoStep(c, step * STEP, STEP, 1));
}

/* Through a state in memory and one in bytes, and back. */
static void save_and_restore(void *c) {
    void *state = NULL, *copy = NULL;
    size_t size;
    MUST(fmi2GetFMUstate(c, &state));
    MUST(fmi2GetFMUstate(c, &state)); /* into the same memory */
    MUST(fmi2SerializedFMUstateSize(c, state, &size));
    char *bytes = malloc(size);
    MUST_NOT(fmi2SerializeFMUstate(c, state, bytes, size - 1));
    MUST(fmi2SerializeFMUstate(c, state, bytes, size));
    MUST_NOT(fmi2DeSerializeFMUstate(c, bytes, size - 1, &copy));
    MUST(fmi2DeSerializeFMUstate(c, bytes, size, &copy));
    free(bytes);
    advance(c, 1, 2);
    MUST(fmi2SetFMUstate(c, copy));
    MUST(fmi2SetFMUstate(c, state));
    MUST(fmi2FreeFMUstate(c, &copy));
    MUST(fmi2FreeFMUstate(c, &state));
    MUST(fmi2FreeFMUstate(c, &state));
}

static void derivatives(void *c) {
    double seed[N_INPUTS + 1] = {0.0}, sensitivity[N_OUTPUTS + 1], rate[N_INPUTS + 1];
    int order[N_INPUTS + 1];
    for (int i = 0; i < N_INPUTS; i++) seed[i] = rate[i] = order[i] = 1;
    MUST(fmi2GetDirectionalDerivative(c, output, N_OUTPUTS, input, N_INPUTS, seed, sensitivity));
    MUST(fmi2SetRealInputDerivatives(c, input, N_INPUTS, order, rate));
}

static void refused(void *c) {
    unsigned wrong[] = {0, N_REFERENCES, (unsigned)-1};
    double value[] = {NAN, 0.0, 0.0};
    for (int i = 0; i < 3; i++) MUST_NOT(fmi2SetReal(c, wrong + i, 1, value));
    for (int i = 1; i < 3; i++) MUST_NOT(fmi2GetReal(c, wrong + i, 1, value));
    MUST_NOT(fmi2DoStep(c, 0.0, -STEP, 1));
    MUST_NOT(fmi2DoStep(c, 0.0, NAN, 1));
    MUST_NOT(fmi2EnterInitializationMode(c));
}

/* An instance that is freed in the midst of a run; every tenth has gone through a reset. */
static void live(int seed) {
    int refusals = 0, lives = seed % 10 ? 1 : 2;
    double value[N_OUTPUTS + 1];
    void *c = new_instance(&refusals);
    for (int life = 1; life <= lives; life++) {
        begin(c);
        advance(c, seed, 0);
        derivatives(c);
        advance(c, seed, 1);
        save_and_restore(c);
        refused(c);
        MUST(fmi2GetReal(c, output, N_OUTPUTS, value));
        if (life < lives) {
            MUST(fmi2Terminate(c));
            MUST(fmi2Reset(c));
        }
    }
    fmi2FreeInstance(c);
    if (refusals != 10 * lives) fail("not every refused call was logged once");
}

typedef struct {
    int seed;
    double result[STEPS][N_OUTPUTS + 1];
} Job;

static void *run(void *argument) {
    Job *job = argument;
    int refusals = 0;
    void *c = new_instance(&refusals);
    begin(c);
    for (int k = 0; k < STEPS; k++) {
        advance(c, job->seed, k);
        MUST(fmi2GetReal(c, output, N_OUTPUTS, job->result[k]));
    }
    MUST(fmi2Terminate(c));
    fmi2FreeInstance(c);
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
    if (arguments != 3) fail("usage: memory_host lives|threads COUNT");
    int count = atoi(argument[2]);
    for (unsigned i = 0; i < N_INPUTS; i++) input[i] = FIRST_INPUT + i;
    for (unsigned i = 0; i < N_OUTPUTS; i++) output[i] = FIRST_OUTPUT + i;
    if (strcmp(argument[1], "threads") == 0)
        side_by_side(count);
    else
        for (int i = 0; i < count; i++) live(i);
    fmi2FreeInstance(NULL);
    return 0;
}
