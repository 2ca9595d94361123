/* FMI 2.0, co-simulation and model exchange: the standard's functions over the core. */
#include "fmi2.h"

#include <stdlib.h>

#include "slave.h"

typedef struct {
    Slave slave;
    fmi2CallbackFunctions callbacks;
} Fmu;

static void report(void *environment, Status status, const char *message) {
    Fmu *fmu = environment;
    if (fmu->callbacks.logger)
        fmi2_log(&fmu->callbacks, fmu->slave.name, status == ERROR ? FMI2_ERROR : FMI2_WARNING,
                 status == ERROR ? "logStatusError" : "logStatusWarning", message);
}

#define CORE (((Slave *)c)->core)
#define NEEDS_PLACE(place) \
    if (!(place)) return slave_refuse(c, "a place for the result is missing: it is NULL")

EXPORT(const char *, fmi2GetTypesPlatform)(void) { return "default"; }
EXPORT(const char *, fmi2GetVersion)(void) { return "2.0"; }

EXPORT(fmi2Status, fmi2SetDebugLogging)(fmi2Component c, fmi2Boolean on, size_t count,
                                        const fmi2String categories[]) {
    (void)on, (void)count, (void)categories; /* errors are always told, and there is nothing else */
    return c ? FMI2_OK : FMI2_ERROR;
}

EXPORT(fmi2Component, fmi2Instantiate)(fmi2String name, fmi2Type type, fmi2String guid,
                                       fmi2String resources, const fmi2CallbackFunctions *callbacks,
                                       fmi2Boolean visible, fmi2Boolean logging) {
    (void)resources, (void)visible, (void)logging;
    Fmu *fmu = calloc(1, sizeof *fmu);
    if (!fmu) return NULL;
    if (callbacks) fmu->callbacks = *callbacks;
    const char *wrong = type != MODEL_EXCHANGE && type != CO_SIMULATION
                            ? "an instance is for model exchange (0) or for co-simulation (1)"
                            : NULL;
    const char *problem = slave_create(&fmu->slave, (Interface)type, name, guid, report, fmu, wrong);
    if (!problem) return fmu;
    report(fmu, ERROR, problem);
    slave_clear(&fmu->slave);
    free(fmu);
    return NULL;
}

EXPORT(void, fmi2FreeInstance)(fmi2Component c) {
    if (!c) return;
    slave_clear(c);
    free(c);
}

EXPORT(fmi2Status, fmi2SetupExperiment)(fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance,
                                        fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop) {
    (void)tolerance_defined, (void)tolerance;
    NEEDS_INSTANCE;
    return slave_experiment(c, start, stop_defined, stop);
}

EXPORT(fmi2Status, fmi2EnterInitializationMode)(fmi2Component c) {
    NEEDS_INSTANCE;
    return slave_enter_initialization(c);
}

EXPORT(fmi2Status, fmi2ExitInitializationMode)(fmi2Component c) {
    NEEDS_INSTANCE;
    return slave_exit_initialization(c);
}

EXPORT(fmi2Status, fmi2Terminate)(fmi2Component c) {
    NEEDS_INSTANCE;
    return (fmi2Status)core_terminate(CORE);
}

EXPORT(fmi2Status, fmi2Reset)(fmi2Component c) {
    NEEDS_INSTANCE;
    return slave_reset(c);
}

EXPORT(fmi2Status, fmi2GetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t count, fmi2Real value[]) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(count, vr, value);
    return (fmi2Status)core_get(CORE, vr, count, value);
}

EXPORT(fmi2Status, fmi2SetReal)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                const fmi2Real value[]) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(count, vr, value);
    NEEDS_SETTABLE;
    return (fmi2Status)core_set(CORE, vr, count, value);
}

#define WHOLE_NUMBERS(name, kind)                                                                          \
    EXPORT(fmi2Status, fmi2Get##name)(fmi2Component c, const fmi2ValueReference vr[], size_t count,        \
                                      fmi2Integer value[]) {                                               \
        NEEDS_INSTANCE;                                                                                    \
        NEEDS_LISTS(count, vr, value);                                                                     \
        for (size_t i = 0; i < count; i++) {                                                               \
            double number;                                                                                 \
            if (core_get_kind(CORE, vr[i], kind, &number) != OK) return FMI2_ERROR;                        \
            value[i] = (fmi2Integer)number;                                                                \
        }                                                                                                  \
        return FMI2_OK;                                                                                    \
    }                                                                                                      \
    EXPORT(fmi2Status, fmi2Set##name)(fmi2Component c, const fmi2ValueReference vr[], size_t count,        \
                                      const fmi2Integer value[]) {                                         \
        NEEDS_INSTANCE;                                                                                    \
        NEEDS_LISTS(count, vr, value);                                                                     \
        NEEDS_SETTABLE;                                                                                    \
        for (size_t i = 0; i < count; i++)                                                                 \
            if (core_set_kind(CORE, vr[i], kind, (double)value[i]) != OK) return FMI2_ERROR;               \
        return FMI2_OK;                                                                                    \
    }
WHOLE_NUMBERS(Integer, WHOLE)
WHOLE_NUMBERS(Boolean, BOOLEAN)

EXPORT(fmi2Status, fmi2GetString)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                  fmi2String value[]) {
    (void)vr, (void)value;
    return c && count == 0 ? FMI2_OK : slave_refuse(c, "this FMU has no strings");
}

EXPORT(fmi2Status, fmi2SetString)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                  const fmi2String value[]) {
    (void)vr, (void)value;
    return c && count == 0 ? FMI2_OK : slave_refuse(c, "this FMU has no strings");
}

EXPORT(fmi2Status, fmi2GetFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    NEEDS_INSTANCE;
    return slave_save(c, state);
}

EXPORT(fmi2Status, fmi2SetFMUstate)(fmi2Component c, fmi2FMUstate state) {
    NEEDS_INSTANCE;
    return slave_restore(c, state);
}

EXPORT(fmi2Status, fmi2FreeFMUstate)(fmi2Component c, fmi2FMUstate *state) {
    NEEDS_INSTANCE;
    return slave_free_state(c, state);
}

EXPORT(fmi2Status, fmi2SerializedFMUstateSize)(fmi2Component c, fmi2FMUstate state, size_t *size) {
    NEEDS_INSTANCE;
    return slave_serialized_size(c, state, size);
}

EXPORT(fmi2Status, fmi2SerializeFMUstate)(fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size) {
    NEEDS_INSTANCE;
    return slave_serialize(c, state, bytes, size);
}

EXPORT(fmi2Status, fmi2DeSerializeFMUstate)(fmi2Component c, const fmi2Byte bytes[], size_t size,
                                            fmi2FMUstate *state) {
    NEEDS_INSTANCE;
    return slave_deserialize(c, bytes, size, state);
}

EXPORT(fmi2Status, fmi2GetDirectionalDerivative)(fmi2Component c, const fmi2ValueReference unknown[],
                                                 size_t unknown_count, const fmi2ValueReference known[],
                                                 size_t known_count, const fmi2Real seed[],
                                                 fmi2Real sensitivity[]) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(unknown_count, unknown, sensitivity);
    NEEDS_LISTS(known_count, known, seed);
    return (fmi2Status)core_directional(CORE, unknown, unknown_count, known, known_count, seed, sensitivity);
}

EXPORT(fmi2Status, fmi2SetRealInputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                                const fmi2Integer order[], const fmi2Real value[]) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(count, vr, order && value);
    NEEDS_SETTABLE;
    int others = 0;
    for (size_t i = 0; i < count; i++) others |= order[i] ^ 1;
    if (others) return slave_refuse(c, "inputs vary linearly over a step: only derivatives of order 1 are taken");
    return (fmi2Status)core_set_rates(CORE, vr, count, value);
}

EXPORT(fmi2Status, fmi2GetRealOutputDerivatives)(fmi2Component c, const fmi2ValueReference vr[], size_t count,
                                                 const fmi2Integer order[], fmi2Real value[]) {
    (void)vr, (void)order, (void)value;
    return c && count == 0 ? FMI2_OK
                           : slave_refuse(c, "output derivatives are outputs of their own (attribute derivative)");
}

EXPORT(fmi2Status, fmi2DoStep)(fmi2Component c, fmi2Real time, fmi2Real size, fmi2Boolean no_return) {
    (void)no_return;
    NEEDS_INSTANCE;
    if (slave_check_step(c, time, size) != OK) return FMI2_ERROR;
    return (fmi2Status)core_step(CORE, time, size);
}

EXPORT(fmi2Status, fmi2CancelStep)(fmi2Component c) { return slave_refuse(c, "no step runs in the background"); }

EXPORT(fmi2Status, fmi2GetStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Status *value) {
    (void)kind, (void)value;
    return c ? FMI2_DISCARD : FMI2_ERROR;
}

EXPORT(fmi2Status, fmi2GetRealStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Real *value) {
    NEEDS_INSTANCE;
    if (kind != FMI2_LAST_SUCCESSFUL_TIME) return FMI2_DISCARD;
    NEEDS_PLACE(value);
    *value = CORE->state.time;
    return FMI2_OK;
}

EXPORT(fmi2Status, fmi2GetIntegerStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Integer *value) {
    (void)kind, (void)value;
    return c ? FMI2_DISCARD : FMI2_ERROR;
}

EXPORT(fmi2Status, fmi2GetBooleanStatus)(fmi2Component c, fmi2StatusKind kind, fmi2Boolean *value) {
    NEEDS_INSTANCE;
    if (kind != FMI2_TERMINATED) return FMI2_DISCARD;
    NEEDS_PLACE(value);
    *value = 0;
    return FMI2_OK;
}

EXPORT(fmi2Status, fmi2GetStringStatus)(fmi2Component c, fmi2StatusKind kind, fmi2String *value) {
    (void)kind, (void)value;
    return c ? FMI2_DISCARD : FMI2_ERROR;
}

EXPORT(fmi2Status, fmi2EnterEventMode)(fmi2Component c) {
    NEEDS_INSTANCE;
    return (fmi2Status)core_enter_event_mode(CORE);
}

EXPORT(fmi2Status, fmi2NewDiscreteStates)(fmi2Component c, fmi2EventInfo *info) {
    NEEDS_INSTANCE;
    NEEDS_PLACE(info);
    *info = (fmi2EventInfo){0}; /* memory follows at once, and there are no time events */
    return (fmi2Status)core_new_discrete_states(CORE);
}

EXPORT(fmi2Status, fmi2EnterContinuousTimeMode)(fmi2Component c) {
    NEEDS_INSTANCE;
    return (fmi2Status)core_enter_continuous_mode(CORE);
}

EXPORT(fmi2Status, fmi2CompletedIntegratorStep)(fmi2Component c, fmi2Boolean no_return, fmi2Boolean *event,
                                                fmi2Boolean *terminate) {
    (void)no_return;
    NEEDS_INSTANCE;
    NEEDS_PLACE(event && terminate);
    *terminate = 0;
    return (fmi2Status)core_completed_step(CORE, event);
}

EXPORT(fmi2Status, fmi2SetTime)(fmi2Component c, fmi2Real time) {
    NEEDS_INSTANCE;
    return (fmi2Status)core_set_time(CORE, time);
}

EXPORT(fmi2Status, fmi2SetContinuousStates)(fmi2Component c, const fmi2Real x[], size_t count) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(count, x, x);
    return (fmi2Status)core_set_continuous_states(CORE, x, count);
}

#define READ_LIST(name, function)                                                   \
    EXPORT(fmi2Status, fmi2##name)(fmi2Component c, fmi2Real value[], size_t count) { \
        NEEDS_INSTANCE;                                                             \
        NEEDS_LISTS(count, value, value);                                           \
        return (fmi2Status)function(CORE, value, count);                            \
    }
READ_LIST(GetDerivatives, core_derivatives)
READ_LIST(GetEventIndicators, core_event_indicators)
READ_LIST(GetContinuousStates, core_get_continuous_states)
READ_LIST(GetNominalsOfContinuousStates, core_nominals)
