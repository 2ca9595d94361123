/* Model exchange: the modes of an instance, and what an integrator sets and asks for. */
#include "evaluate.h"

#include <string.h>

static const char *const PHASE_NAME[] = {"not yet in initialization", "in initialization mode",
                                         "in step mode", "in event mode", "in continuous-time mode",
                                         "terminated"};

enum {
    EVENTS = 1u << EVENT_MODE,
    CONTINUOUS = 1u << CONTINUOUS_MODE,
    READING = 1u << INITIALIZING | EVENTS | CONTINUOUS | 1u << TERMINATED
};

/* Whether a call is allowed in this phase; `needs` says which it needs. */
static Status allow(Instance *instance, const char *call, unsigned phases, const char *needs) {
    if (instance->interface != MODEL_EXCHANGE)
        return core_fail(instance, "%s is for model exchange, and this instance for co-simulation", call);
    if (!(phases & 1u << instance->state.phase))
        return core_fail(instance, "%s needs %s; the instance is %s", call, needs,
                         PHASE_NAME[instance->state.phase]);
    return OK;
}

static Status allow_reading(Instance *instance, const char *call) {
    return allow(instance, call, READING, "initialization mode or a mode after it");
}

static Status check_count(Instance *instance, const char *what, size_t given, size_t own) {
    if (given == own) return OK;
    return core_fail(instance, "there are %zu %s, and %zu were asked for", own, what, given);
}

static Status check_states(Instance *instance, size_t count) {
    return check_count(instance, "continuous states", count, N_CONTINUOUS);
}

Status core_enter_event_mode(Instance *instance) {
    if (allow(instance, "entering event mode", CONTINUOUS, "continuous-time mode") != OK) return ERROR;
    instance->state.phase = EVENT_MODE;
    return OK;
}

Status core_new_discrete_states(Instance *instance) {
    if (allow(instance, "computing new discrete states", EVENTS, "event mode") != OK) return ERROR;
    return update_memory(instance);
}

Status core_enter_continuous_mode(Instance *instance) {
    if (allow(instance, "entering continuous-time mode", EVENTS, "event mode") != OK) return ERROR;
    instance->state.phase = CONTINUOUS_MODE;
    return OK;
}

Status core_set_time(Instance *instance, double time) {
    State *s = &instance->state;
    if (allow(instance, "setting the time", EVENTS | CONTINUOUS, "event or continuous-time mode") != OK)
        return ERROR;
    if (!finite_number(time)) return core_fail(instance, "the time cannot be %g: it must be finite", time);
    s->time = s->value[0] = time;
    return OK;
}

Status core_set_continuous_states(Instance *instance, const double *x, size_t count) {
    State *s = &instance->state;
    if (allow(instance, "setting continuous states", CONTINUOUS, "continuous-time mode") != OK ||
        check_states(instance, count) != OK)
        return ERROR;
    for (size_t i = 0; i < count; i++)
        if (!finite_number(x[i]))
            return core_fail(instance, "the state %s cannot be %g: a finite number is needed",
                             STATE_NAME[i], x[i]);
    if (count) memcpy(s->x, x, count * sizeof *x);
    s->outputs_stale = s->slopes_stale = 1;
    return OK;
}

Status core_get_continuous_states(Instance *instance, double *x, size_t count) {
    if (allow_reading(instance, "reading continuous states") != OK ||
        check_states(instance, count) != OK || refresh_states(instance) != OK)
        return ERROR;
    if (count) memcpy(x, instance->state.x, count * sizeof *x);
    return OK;
}

Status core_nominals(Instance *instance, double *nominal, size_t count) {
    if (allow_reading(instance, "reading nominals") != OK || check_states(instance, count) != OK)
        return ERROR;
    if (count) memcpy(nominal, STATE_NOMINAL, count * sizeof *nominal);
    return OK;
}

Status core_derivatives(Instance *instance, double *rate, size_t count) {
    if (allow_reading(instance, "reading derivatives") != OK || check_states(instance, count) != OK)
        return ERROR;
    return evaluate_derivatives(instance, rate);
}

Status core_event_indicators(Instance *instance, double *indicator, size_t count) {
    if (allow_reading(instance, "reading event indicators") != OK ||
        check_count(instance, "event indicators", count, N_INDICATORS) != OK)
        return ERROR;
    return evaluate_indicators(instance, indicator);
}

/* Event mode is needed where an indicator changes its sign by the update alone: the integrator
 * would take that for a crossing within its next step. */
Status core_completed_step(Instance *instance, int *event) {
    double before[N_INDICATORS + 1], after[N_INDICATORS + 1];
    *event = 0;
    if (allow(instance, "completing an integrator step", CONTINUOUS, "continuous-time mode") != OK ||
        evaluate_indicators(instance, before) != OK || update_memory(instance) != OK ||
        evaluate_indicators(instance, after) != OK)
        return ERROR;
    for (int i = 0; i < N_INDICATORS; i++)
        if ((before[i] > 0.0) != (after[i] > 0.0)) *event = 1;
    return OK;
}
