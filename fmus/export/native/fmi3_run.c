/* FMI 3.0: what goes on between initialization and the end, for an integrator or step by step. */
#include "fmi3.h"

/* Model exchange. */

EXPORT(fmi3Status, fmi3EnterEventMode)(fmi3Instance c) {
    NEEDS_INSTANCE;
    return core_enter_event_mode(CORE);
}

EXPORT(fmi3Status, fmi3EvaluateDiscreteStates)(fmi3Instance c) {
    return slave_refuse(c, "the memory of this FMU follows at fmi3UpdateDiscreteStates; there is nothing to evaluate before");
}

EXPORT(fmi3Status, fmi3UpdateDiscreteStates)(fmi3Instance c, fmi3Boolean *need_update, fmi3Boolean *terminate,
                                             fmi3Boolean *nominals_changed, fmi3Boolean *values_changed,
                                             fmi3Boolean *next_event_defined, fmi3Float64 *next_event) {
    NEEDS_INSTANCE;
    NEEDS_LISTS(1, need_update && terminate && nominals_changed, values_changed && next_event_defined && next_event);
    *need_update = *terminate = *nominals_changed = *values_changed = *next_event_defined = false;
    return core_new_discrete_states(CORE);
}

EXPORT(fmi3Status, fmi3EnterContinuousTimeMode)(fmi3Instance c) {
    NEEDS_INSTANCE;
    return core_enter_continuous_mode(CORE);
}

EXPORT(fmi3Status, fmi3CompletedIntegratorStep)(fmi3Instance c, fmi3Boolean no_set, fmi3Boolean *event,
                                                fmi3Boolean *terminate) {
    (void)no_set;
    int enter = 0;
    NEEDS_INSTANCE;
    NEEDS_LISTS(1, event, terminate);
    Status status = core_completed_step(CORE, &enter);
    *event = enter;
    *terminate = false;
    return status;
}

EXPORT(fmi3Status, fmi3SetTime)(fmi3Instance c, fmi3Float64 time) {
    NEEDS_INSTANCE;
    return core_set_time(CORE, time);
}

#define STATE_VECTOR(name, function, type)                                    \
    EXPORT(fmi3Status, fmi3##name)(fmi3Instance c, type value[], size_t count) { \
        NEEDS_INSTANCE;                                                       \
        NEEDS_LISTS(count, value, value);                                     \
        return function(CORE, value, count);                                  \
    }
STATE_VECTOR(SetContinuousStates, core_set_continuous_states, const fmi3Float64)
STATE_VECTOR(GetContinuousStates, core_get_continuous_states, fmi3Float64)
STATE_VECTOR(GetContinuousStateDerivatives, core_derivatives, fmi3Float64)
STATE_VECTOR(GetNominalsOfContinuousStates, core_nominals, fmi3Float64)
STATE_VECTOR(GetEventIndicators, core_event_indicators, fmi3Float64)

#define STATE_COUNT(name, number)                                 \
    EXPORT(fmi3Status, fmi3##name)(fmi3Instance c, size_t *count) { \
        NEEDS_INSTANCE;                                           \
        NEEDS_LISTS(1, count, count);                             \
        *count = (number);                                        \
        return OK;                                                \
    }
STATE_COUNT(GetNumberOfContinuousStates, N_CONTINUOUS)
STATE_COUNT(GetNumberOfEventIndicators, N_INDICATORS)

/* Co-simulation. */

/* A step whose inputs the importer sets for the end of each micro step, as the step goes along. */
static Status step_with_updates(Fmu *c, double time, double size, fmi3Boolean *early) {
    long count;
    if (core_plan(c->slave.core, time, size, &count) != OK) return ERROR;
    State *s = &c->slave.core->state;
    c->micro = size / (double)count;
    for (long i = 1; i <= count; i++) {
        double end = i == count ? time + size : time + (double)i * c->micro, until = end;
        fmi3Boolean leave = false;
        c->now = BEFORE_MICRO_STEP;
        c->update(c->environment, end, true, false, false, false, &leave, &until);
        c->now = NO_UPDATE;
        if (core_advance(c->slave.core, time + (double)(i - 1) * c->micro, c->micro, 1) != OK) return ERROR;
        s->time = s->value[0] = end; /* not what the sum of the micro steps is rounded to */
        if (!c->early_return && !c->reads_intermediate) continue;
        c->now = AFTER_MICRO_STEP;
        leave = false;
        c->update(c->environment, end, false, true, true, c->early_return, &leave, &until);
        c->now = NO_UPDATE;
        *early = c->early_return && leave && i < count;
        if (*early) return OK;
    }
    return OK;
}

EXPORT(fmi3Status, fmi3DoStep)(fmi3Instance c, fmi3Float64 time, fmi3Float64 size, fmi3Boolean no_set,
                               fmi3Boolean *event, fmi3Boolean *terminate, fmi3Boolean *early,
                               fmi3Float64 *last_time) {
    (void)no_set;
    NEEDS_INSTANCE;
    NEEDS_NO_UPDATE;
    NEEDS_LISTS(1, event && terminate, early && last_time);
    *event = *terminate = *early = false;
    Status status = slave_check_step(c, time, size);
    if (status == OK)
        status = ((Fmu *)c)->update && size > 0.0 ? step_with_updates(c, time, size, early)
                                                  : core_step(CORE, time, size);
    *last_time = CORE->state.time;
    return status;
}

EXPORT(fmi3Status, fmi3EnterStepMode)(fmi3Instance c) {
    return slave_refuse(c, "this FMU has no event mode in co-simulation to come back from");
}

EXPORT(fmi3Status, fmi3GetOutputDerivatives)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,
                                             const int32_t order[], fmi3Float64 value[], size_t value_count) {
    (void)vr, (void)order, (void)value, (void)value_count;
    return c && count == 0 ? OK : slave_refuse(c, "output derivatives are outputs of their own (attribute derivative)");
}
