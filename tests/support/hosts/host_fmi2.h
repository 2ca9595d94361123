/* The calls of memory_host.c in FMI 2.0. */
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
int fmi2EnterEventMode(void *);
int fmi2NewDiscreteStates(void *, void *);
int fmi2EnterContinuousTimeMode(void *);
int fmi2CompletedIntegratorStep(void *, int, int *, int *);
int fmi2SetTime(void *, double);
int fmi2SetContinuousStates(void *, const double *, size_t);
int fmi2GetContinuousStates(void *, double *, size_t);
int fmi2GetDerivatives(void *, double *, size_t);
int fmi2GetEventIndicators(void *, double *, size_t);
int fmi2GetNominalsOfContinuousStates(void *, double *, size_t);

#define free_instance fmi2FreeInstance
#define enter_initialization fmi2EnterInitializationMode
#define terminate fmi2Terminate
#define reset fmi2Reset
#define get_state fmi2GetFMUstate
#define set_state fmi2SetFMUstate
#define free_state fmi2FreeFMUstate
#define serialized_size fmi2SerializedFMUstateSize
#define serialize fmi2SerializeFMUstate
#define deserialize fmi2DeSerializeFMUstate
#define set(c, reference, count, value, value_count) fmi2SetReal(c, reference, count, value)
#define get(c, reference, count, value, value_count) fmi2GetReal(c, reference, count, value)
#define enter_event_mode fmi2EnterEventMode
#define enter_continuous_mode fmi2EnterContinuousTimeMode
#define set_time fmi2SetTime
#define set_states fmi2SetContinuousStates
#define get_states fmi2GetContinuousStates
#define get_rates fmi2GetDerivatives
#define get_indicators fmi2GetEventIndicators
#define get_nominals fmi2GetNominalsOfContinuousStates
#define do_step(c, time, size) fmi2DoStep(c, time, size, 1)

enum { PAST_THE_END = N_REFERENCES };

static void list_outputs(void) {
    for (unsigned i = 0; i < N_OUTPUTS; i++) output[i] = FIRST_OUTPUT + i;
    outputs = values = N_OUTPUTS;
}

static void logger(void *refusals, const char *name, int status, const char *category,
                   const char *format, ...) {
    (void)name, (void)status, (void)category, (void)format;
    ++*(int *)refusals;
}

static void *new_instance(int *refusals) {
    Callbacks callbacks = {logger, calloc, free, NULL, refusals};
    void *c = fmi2Instantiate("host", !exchange, GUID, "", &callbacks, 0, 0);
    if (!c) fail("no instance");
    return c;
}

static void begin(void *c) {
    MUST(fmi2SetupExperiment(c, 0, 0.0, 0.0, 0, 0.0));
    MUST(fmi2EnterInitializationMode(c));
    MUST(fmi2ExitInitializationMode(c));
}

static int new_discrete_states(void *c) {
    struct {
        int flag[5];
        double time;
    } info;
    return fmi2NewDiscreteStates(c, &info);
}

static int completed_step(void *c, int *event) {
    int end;
    return fmi2CompletedIntegratorStep(c, 1, event, &end);
}

static void derivatives(void *c) {
    double seed[N_INPUTS + 1] = {0.0}, sensitivity[N_OUTPUTS + 1], rate[N_INPUTS + 1];
    int order[N_INPUTS + 1];
    for (int i = 0; i < N_INPUTS; i++) seed[i] = rate[i] = order[i] = 1;
    MUST(fmi2GetDirectionalDerivative(c, output, N_OUTPUTS, input, N_INPUTS, seed, sensitivity));
    if (!exchange) MUST(fmi2SetRealInputDerivatives(c, input, N_INPUTS, order, rate));
}
