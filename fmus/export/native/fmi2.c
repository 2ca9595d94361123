/* FMI 2.0, co-simulation and model exchange: the standard's functions over the core. */
#include "fmi2.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core.h"

#if defined(_WIN32)
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef struct {
    Instance *core;
    char *name;
    fmi2CallbackFunctions callbacks;
    fmi2Real start, stop;
} Slave;

static void report(void *environment, Status status, const char *message) {
    Slave *slave = environment;
    if (slave->callbacks.logger)
        slave->callbacks.logger(slave->callbacks.componentEnvironment, slave->name,
                                status == ERROR ? FMI2_ERROR : FMI2_WARNING,
                                status == ERROR ? "logStatusError" : "logStatusWarning", "%s", message);
}

#define CORE (((Slave *)c)->core)
#define NEEDS_INSTANCE if (!c) return FMI2_ERROR
#define NEEDS_LISTS(count, one, other) \
    if ((count) != 0 && (!(one) || !(other))) return refuse(c, "a list of the call is missing: it is NULL")
#define NEEDS_SETTABLE                   \
    if (CORE->state.phase == TERMINATED) \
    return refuse(c, "the run has ended: fmi2Reset or fmi2SetFMUstate comes before new values")

static fmi2Status refuse(fmi2Component c, const char *what) {
    if (c) core_fail(CORE, "%s", what);
    return FMI2_ERROR;
}

static void forget_experiment(Slave *slave) {
    slave->start = 0.0;
    slave->stop = DBL_MAX;
}

EXPORT const char *fmi2GetTypesPlatform(void) { return "default"; }
EXPORT const char *fmi2GetVersion(void) { return "2.0"; }

EXPORT fmi2Status fmi2SetDebugLogging(fmi2Component c, fmi2Boolean on, size_t count,
                                      const fmi2String categories[]) {
    (void)on, (void)count, (void)categories; /* errors are always told, and there is nothing else */
    return c ? FMI2_OK : FMI2_ERROR;
}

EXPORT fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid,
                                     fmi2String resources, const fmi2CallbackFunctions *callbacks,
                                     fmi2Boolean visible, fmi2Boolean logging) {
    (void)resources, (void)visible, (void)logging;
    Slave *slave = calloc(1, sizeof *slave);
    if (!slave) return NULL;
    if (callbacks) slave->callbacks = *callbacks;
    forget_experiment(slave);
    slave->name = calloc(1, (name ? strlen(name) : 0) + 1);
    if (slave->name && name) memcpy(slave->name, name, strlen(name));
    const char *problem = NULL;
    if (!slave->name || !name || !*name) problem = "an instance needs a name";
    else if (type != MODEL_EXCHANGE && type != CO_SIMULATION)
        problem = "an instance is for model exchange (0) or for co-simulation (1)";
    else if (!guid || strcmp(guid, GUID) != 0)
        problem = "the GUID differs from the model description's: binary and description do not belong together";
    else if (!(slave->core = core_create((Interface)type, report, slave))) problem = "not enough memory";
    if (!problem) return slave;
    if (slave->name) report(slave, ERROR, problem);
    free(slave->name);
    free(slave);
    return NULL;
}

EXPORT void fmi2FreeInstance(fmi2Component c) {
    if (!c) return;
    core_free(CORE);
    free(((Slave *)c)->name);
    free(c);
}

EXPORT fmi2Status fmi2SetupExperiment(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                      fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop) {
    (void)tolerance_defined, (void)tolerance;
    NEEDS_INSTANCE;
    if (CORE->state.phase != INSTANTIATED) return refuse(c, "fmi2SetupExperiment comes before initialization");
    if (stop_defined && !(stop >= start)) return refuse(c, "the stop time lies before the start time");
    ((Slave *)c)->start = start;
    ((Slave *)c)->stop = stop_defined ? stop : DBL_MAX;
    return FMI2_OK;
}

EXPORT fmi2Status fmi2EnterInitializationMode(fmi2Component c) {
    NEEDS_INSTANCE;
    if (CORE->state.phase != INSTANTIATED)
        return refuse(c, "fmi2EnterInitializationMode comes once, after fmi2Instantiate or fmi2Reset");
    return (fmi2Status)core_start(CORE, ((Slave *)c)->start);
}

EXPORT fmi2Status fmi2ExitInitializationMode(fmi2Component c) {
    NEEDS_INSTANCE;
    if (CORE->state.phase != INITIALIZING)
        return refuse(c, "fmi2ExitInitializationMode needs fmi2EnterInitializationMode before it");
    return (fmi2Status)core_finish_initialization(CORE);
}

EXPORT fmi2Status fmi2Terminate(fmi2Component c) {
    NEEDS_INSTANCE;
    return (fmi2Status)core_terminate(CORE);
}

EXPORT fmi2Status fmi2Reset(fmi2Component c) {
    NEEDS_INSTANCE;
    core_reset(CORE);
    forget_experiment(c);
    return FMI2_OK;
}

EXPORT fmi2Status fmi2GetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[]) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(count, vr, value);
    return (fmi2Status)core_get(CORE, vr, count, value);
}

EXPORT fmi2Status fmi2SetReal(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                              const fmi2Real value[]) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(count, vr, value);
    NEEDS_SETTABLE;
    return (fmi2Status)core_set(CORE, vr, count, value);
}

#define WHOLE_NUMBERS(name, kind)                                                                          \
    EXPORT fmi2Status fmi2Get##name(fmi2Component c, const fmi2ValueReference vr[], size_t count,          \
                                    fmi2Integer value[]) {                                                 \
        NEEDS_INSTANCE;                                                                                    \
        NEEDS_LISTS(count, vr, value);                                                                     \
        for (size_t i = 0; i < count; i++) {                                                               \
            double number;                                                                                 \
            if (core_get_kind(CORE, vr[i], kind, &number) != OK) return FMI2_ERROR;                        \
            value[i] = (fmi2Integer)number;                                                                \
        }                                                                                                  \
        return FMI2_OK;                                                                                    \
    }                                                                                                      \
    EXPORT fmi2Status fmi2Set##name(fmi2Component c, const fmi2ValueReference vr[], size_t count,          \
                                    const fmi2Integer value[]) {                                           \
        NEEDS_INSTANCE;                                                                                    \
        NEEDS_LISTS(count, vr, value);                                                                     \
        NEEDS_SETTABLE;                                                                                    \
        for (size_t i = 0; i < count; i++)                                                                 \
            if (core_set_kind(CORE, vr[i], kind, (double)value[i]) != OK) return FMI2_ERROR;               \
        return FMI2_OK;                                                                                    \
    }
WHOLE_NUMBERS(Integer, INTEGER)
WHOLE_NUMBERS(Boolean, BOOLEAN)

EXPORT fmi2Status fmi2GetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                fmi2String value[]) {
    (void)vr, (void)value;
    return c && count == 0 ? FMI2_OK : refuse(c, "this FMU has no strings");
}

EXPORT fmi2Status fmi2SetString(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                const fmi2String value[]) {
    (void)vr, (void)value;
    return c && count == 0 ? FMI2_OK : refuse(c, "this FMU has no strings");
}

EXPORT fmi2Status fmi2GetFMUstate(fmi2Component c, fmi2FMUstate *state) {
    NEEDS_INSTANCE;
    if (!state) return refuse(c, "fmi2GetFMUstate needs a place for the state");
    if (!*state && !(*state = malloc(sizeof(State)))) return refuse(c, "not enough memory for a state");
    memcpy(*state, &CORE->state, sizeof(State));
    return FMI2_OK;
}

EXPORT fmi2Status fmi2SetFMUstate(fmi2Component c, fmi2FMUstate state) {
    NEEDS_INSTANCE;
    if (!state) return refuse(c, "fmi2SetFMUstate needs a state");
    return (fmi2Status)core_restore(CORE, state);
}

EXPORT fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    NEEDS_INSTANCE;
    if (state) {
        free(*state);
        *state = NULL;
    }
    return FMI2_OK;
}

/* Serialized: the GUID, then the state's bytes; another build's bytes are refused. */
enum { SERIALIZED_SIZE = sizeof GUID + sizeof(State) };

EXPORT fmi2Status fmi2SerializedFMUstateSize(fmi2Component c, fmi2FMUstate state, size_t *size) {
    NEEDS_INSTANCE;
    if (!state || !size) return refuse(c, "fmi2SerializedFMUstateSize needs a state");
    *size = SERIALIZED_SIZE;
    return FMI2_OK;
}

EXPORT fmi2Status fmi2SerializeFMUstate(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    NEEDS_INSTANCE;
    if (!state || !bytes || size < SERIALIZED_SIZE) return refuse(c, "too few bytes to serialize the state into");
    memcpy(bytes, GUID, sizeof GUID);
    memcpy(bytes + sizeof GUID, state, sizeof(State));
    return FMI2_OK;
}

EXPORT fmi2Status fmi2DeSerializeFMUstate(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                          fmi2FMUstate *state) {
    NEEDS_INSTANCE;
    if (!bytes || !state || size < SERIALIZED_SIZE || memcmp(bytes, GUID, sizeof GUID) != 0)
        return refuse(c, "these bytes are no state of this FMU, or of another build of it");
    if (!*state && !(*state = malloc(sizeof(State)))) return refuse(c, "not enough memory for a state");
    memcpy(*state, bytes + sizeof GUID, sizeof(State));
    return FMI2_OK;
}

EXPORT fmi2Status fmi2GetDirectionalDerivative(fmi2Component c, const fmi2ValueReference unknown[],
                                               size_t unknown_count, const fmi2ValueReference known[],
                                               size_t known_count, const fmi2Real seed[],
                                               fmi2Real sensitivity[]) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(unknown_count, unknown, sensitivity);
    NEEDS_LISTS(known_count, known, seed);
    return (fmi2Status)core_directional(CORE, unknown, unknown_count, known, known_count, seed, sensitivity);
}

EXPORT fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                              const fmi2Integer order[], const fmi2Real value[]) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(count, vr, order && value);
    NEEDS_SETTABLE;
    for (size_t i = 0; i < count; i++) {
        if (order[i] != 1) return refuse(c, "inputs vary linearly over a step: only derivatives of order 1 are taken");
        if (core_set_rate(CORE, vr[i], value[i]) != OK) return FMI2_ERROR;
    }
    return FMI2_OK;
}

EXPORT fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                               const fmi2Integer order[], fmi2Real value[]) {
    (void)vr, (void)order, (void)value;
    return c && count == 0 ? FMI2_OK
                           : refuse(c, "output derivatives are outputs of their own (attribute derivative)");
}

EXPORT fmi2Status fmi2DoStep(fmi2Component c, fmi2Real time, fmi2Real size, fmi2Boolean no_return) {
    (void)no_return;
    NEEDS_INSTANCE;
    fmi2Real stop = ((Slave *)c)->stop;
    if (time + size > stop + 1e-9 * fabs(stop) + 1e-6 * size) /* what masters lose by rounding */
        return core_fail(CORE, "doStep from t = %.17g s by %g s goes past the stop time of %g s", time,
                         size, stop);
    return (fmi2Status)core_step(CORE, time, size);
}

EXPORT fmi2Status fmi2CancelStep(fmi2Component c) { return refuse(c, "no step runs in the background"); }

EXPORT fmi2Status fmi2GetStatus(fmi2Component c, fmi2StatusKind kind, fmi2Status *value) {
    (void)kind, (void)value;
    return c ? FMI2_DISCARD : FMI2_ERROR;
}

EXPORT fmi2Status fmi2GetRealStatus(fmi2Component c, fmi2StatusKind kind, fmi2Real *value) {
    NEEDS_INSTANCE;
    if (kind != FMI2_LAST_SUCCESSFUL_TIME) return FMI2_DISCARD;
    *value = CORE->state.time;
    return FMI2_OK;
}

EXPORT fmi2Status fmi2GetIntegerStatus(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value) {
    (void)kind, (void)value;
    return c ? FMI2_DISCARD : FMI2_ERROR;
}

EXPORT fmi2Status fmi2GetBooleanStatus(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value) {
    NEEDS_INSTANCE;
    if (kind != FMI2_TERMINATED) return FMI2_DISCARD;
    *value = 0;
    return FMI2_OK;
}

EXPORT fmi2Status fmi2GetStringStatus(fmi2Component c, fmi2StatusKind kind, fmi2String *value) {
    (void)kind, (void)value;
    return c ? FMI2_DISCARD : FMI2_ERROR;
}

#define NEEDS_PLACE(place) \
    if (!(place)) return refuse(c, "a place for the result is missing: it is NULL")

EXPORT fmi2Status fmi2EnterEventMode(fmi2Component c) {
    NEEDS_INSTANCE;
    return (fmi2Status)core_enter_event_mode(CORE);
}

EXPORT fmi2Status fmi2NewDiscreteStates(fmi2Component c, fmi2EventInfo *info) {
    NEEDS_INSTANCE;
    NEEDS_PLACE(info);
    *info = (fmi2EventInfo){0}; /* memory follows at once, and there are no time events */
    return (fmi2Status)core_new_discrete_states(CORE);
}

EXPORT fmi2Status fmi2EnterContinuousTimeMode(fmi2Component c) {
    NEEDS_INSTANCE;
    return (fmi2Status)core_enter_continuous_mode(CORE);
}

EXPORT fmi2Status fmi2CompletedIntegratorStep(fmi2Component c, fmi2Boolean no_return, fmi2Boolean *event,
                                              fmi2Boolean *terminate) {
    (void)no_return;
    NEEDS_INSTANCE;
    NEEDS_PLACE(event && terminate);
    *terminate = 0;
    return (fmi2Status)core_completed_step(CORE, event);
}

EXPORT fmi2Status fmi2SetTime(fmi2Component c, fmi2Real time) {
    NEEDS_INSTANCE;
    return (fmi2Status)core_set_time(CORE, time);
}

EXPORT fmi2Status fmi2SetContinuousStates(fmi2Component c, const fmi2Real x[], size_t count) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(count, x, x);
    return (fmi2Status)core_set_continuous_states(CORE, x, count);
}

#define READ_LIST(name, function)                                                   \
    EXPORT fmi2Status fmi2##name(fmi2Component c, fmi2Real value[], size_t count) { \
        NEEDS_INSTANCE;                                                             \
        NEEDS_LISTS(count, value, value);                                           \
        return (fmi2Status)function(CORE, value, count);                            \
    }
READ_LIST(GetDerivatives, core_derivatives)
READ_LIST(GetEventIndicators, core_event_indicators)
READ_LIST(GetContinuousStates, core_get_continuous_states)
READ_LIST(GetNominalsOfContinuousStates, core_nominals)
