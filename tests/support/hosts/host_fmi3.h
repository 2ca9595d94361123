/* The calls of memory_host.c in FMI 3.0, with arrays among the outputs and an intermediate update. */
#include <stdbool.h>

#include "arrays.h"

typedef void Logger(void *, int, const char *, const char *);
typedef void Update(void *, double, bool, bool, bool, bool, bool *, double *);

void *fmi3InstantiateModelExchange(const char *, const char *, const char *, bool, bool, void *, Logger *);
void *fmi3InstantiateCoSimulation(const char *, const char *, const char *, bool, bool, bool, bool,
                                  const unsigned *, size_t, void *, Logger *, Update *);
void fmi3FreeInstance(void *);
int fmi3EnterInitializationMode(void *, bool, double, double, bool, double);
int fmi3ExitInitializationMode(void *);
int fmi3Terminate(void *);
int fmi3Reset(void *);
int fmi3SetFloat64(void *, const unsigned *, size_t, const double *, size_t);
int fmi3GetFloat64(void *, const unsigned *, size_t, double *, size_t);
int fmi3DoStep(void *, double, double, bool, bool *, bool *, bool *, double *);
int fmi3GetFMUState(void *, void **);
int fmi3SetFMUState(void *, void *);
int fmi3FreeFMUState(void *, void **);
int fmi3SerializedFMUStateSize(void *, void *, size_t *);
int fmi3SerializeFMUState(void *, void *, char *, size_t);
int fmi3DeserializeFMUState(void *, const char *, size_t, void **);
int fmi3GetDirectionalDerivative(void *, const unsigned *, size_t, const unsigned *, size_t,
                                 const double *, size_t, double *, size_t);
int fmi3GetAdjointDerivative(void *, const unsigned *, size_t, const unsigned *, size_t,
                             const double *, size_t, double *, size_t);
int fmi3GetNumberOfVariableDependencies(void *, unsigned, size_t *);
int fmi3GetVariableDependencies(void *, unsigned, size_t *, unsigned *, size_t *, int *, size_t);
int fmi3EnterEventMode(void *);
int fmi3UpdateDiscreteStates(void *, bool *, bool *, bool *, bool *, bool *, double *);
int fmi3EnterContinuousTimeMode(void *);
int fmi3CompletedIntegratorStep(void *, bool, bool *, bool *);
int fmi3SetTime(void *, double);
int fmi3SetContinuousStates(void *, const double *, size_t);
int fmi3GetContinuousStates(void *, double *, size_t);
int fmi3GetContinuousStateDerivatives(void *, double *, size_t);
int fmi3GetEventIndicators(void *, double *, size_t);
int fmi3GetNominalsOfContinuousStates(void *, double *, size_t);

#define free_instance fmi3FreeInstance
#define enter_initialization(c) fmi3EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0)
#define terminate fmi3Terminate
#define reset fmi3Reset
#define get_state fmi3GetFMUState
#define set_state fmi3SetFMUState
#define free_state fmi3FreeFMUState
#define serialized_size fmi3SerializedFMUStateSize
#define serialize fmi3SerializeFMUState
#define deserialize fmi3DeserializeFMUState
#define set fmi3SetFloat64
#define get fmi3GetFloat64
#define enter_event_mode fmi3EnterEventMode
#define enter_continuous_mode fmi3EnterContinuousTimeMode
#define set_time fmi3SetTime
#define set_states fmi3SetContinuousStates
#define get_states fmi3GetContinuousStates
#define get_rates fmi3GetContinuousStateDerivatives
#define get_indicators fmi3GetEventIndicators
#define get_nominals fmi3GetNominalsOfContinuousStates

enum { PAST_THE_END = EVENT_INDICATORS + (N_INDICATORS > 0) };

/* Scalars that stand for themselves, then the arrays of outputs; those of other variables too. */
static void list_outputs(void) {
    for (unsigned i = 0; i < N_OUTPUTS; i++)
        if (!IN_ARRAY[FIRST_OUTPUT + i]) output[outputs++] = FIRST_OUTPUT + i;
    values = outputs;
    for (unsigned i = 0; i < N_ARRAYS; i++) {
        output[outputs++] = N_REFERENCES + i;
        values += ARRAY_START[i + 1] - ARRAY_START[i];
    }
}

static void logger(void *refusals, int status, const char *category, const char *message) {
    (void)status, (void)category, (void)message;
    ++*(int *)refusals;
}

static _Thread_local void *stepping;

/* Sets an input for the end of a micro step, or reads the outputs there. */
static void update(void *environment, double time, bool setting, bool getting, bool finished,
                   bool can_leave, bool *leave, double *until) {
    double value[MOST_VALUES];
    (void)environment, (void)finished, (void)can_leave, (void)until;
    if (setting) {
        value[0] = VARIABLE_INFO[FIRST_INPUT - 1].start + 1e-3 * sin(time);
        MUST(set(stepping, input, 1, value, 1));
    }
    if (getting) MUST(get(stepping, output, outputs, value, values));
    *leave = false;
}

static void *new_instance(int *refusals) {
    void *c = exchange ? fmi3InstantiateModelExchange("host", GUID, "", false, false, refusals, logger)
                       : fmi3InstantiateCoSimulation("host", GUID, "", false, false, false, true, output,
                                                     outputs, refusals, logger, update);
    if (!c) fail("no instance");
    return c;
}

static void begin(void *c) {
    MUST(enter_initialization(c));
    MUST(fmi3ExitInitializationMode(c));
}

static int new_discrete_states(void *c) {
    bool flag[5];
    double time;
    return fmi3UpdateDiscreteStates(c, flag, flag + 1, flag + 2, flag + 3, flag + 4, &time);
}

static int completed_step(void *c, int *event) {
    bool enter = false, end;
    int status = fmi3CompletedIntegratorStep(c, true, &enter, &end);
    *event = enter;
    return status;
}

static int do_step(void *c, double time, double size) {
    bool event, end, early;
    double last;
    stepping = c;
    return fmi3DoStep(c, time, size, true, &event, &end, &early, &last);
}

static void derivatives(void *c) {
    double seed[MOST_VALUES], sensitivity[MOST_VALUES];
    unsigned unknown[N_REFERENCES];
    size_t count = 0, total = 0;
    for (int i = 0; i < MOST_VALUES; i++) seed[i] = 1.0;
    for (size_t i = 0; i < outputs; i++) {
        unsigned array = output[i] - N_REFERENCES;
        unsigned first = output[i] < N_REFERENCES ? output[i] : ARRAY_ELEMENT[ARRAY_START[array]];
        if (first >= FIRST_LOCAL) continue; /* memory and constants have no derivatives */
        unknown[count++] = output[i];
        total += output[i] < N_REFERENCES ? 1 : ARRAY_START[array + 1] - ARRAY_START[array];
    }
    MUST(fmi3GetDirectionalDerivative(c, unknown, count, input, N_INPUTS, seed, N_INPUTS, sensitivity, total));
    MUST(fmi3GetAdjointDerivative(c, unknown, count, input, N_INPUTS, seed, total, sensitivity, N_INPUTS));
    for (size_t i = 0; i < count; i++) {
        size_t n, dependent[MOST_VALUES * N_INPUTS], element[MOST_VALUES * N_INPUTS];
        unsigned independent[MOST_VALUES * N_INPUTS];
        int kind[MOST_VALUES * N_INPUTS];
        MUST(fmi3GetNumberOfVariableDependencies(c, unknown[i], &n));
        if (n > MOST_VALUES * N_INPUTS) fail("more dependencies than there can be");
        MUST(fmi3GetVariableDependencies(c, unknown[i], dependent, independent, element, kind, n));
    }
}
