/* Saved states of a coupled system: its own, what changes of the tables, and those of the FMUs. */
#include <stdlib.h>
#include <string.h>

#include "coupled.h"

typedef struct {
    State state;
    Course course;
    double given[N_PARAMETERS + 1];
    uint64_t changing[IMAGE_WORDS - IMAGE_CHANGING];
    void *of[N_WITHIN];
} Saved;

enum { PLAIN = offsetof(Saved, of) };

Status core_save(Instance *instance, void **state) {
    if (bring_along(instance) != OK) return ERROR;
    Coupled *c = instance->within;
    Saved *saved = *state ? *state : calloc(1, sizeof *saved);
    if (!saved) return core_fail(instance, "not enough memory for a state");
    *state = saved;
    saved->state = instance->state;
    saved->course = c->course;
    memcpy(saved->given, c->given, sizeof c->given);
    memcpy(saved->changing, c->image + IMAGE_CHANGING, sizeof saved->changing);
    for (int i = 0; i < N_WITHIN; i++)
        if (fmu_of(i)->get_state(c->component[i], &saved->of[i]) > 1)
            return core_fail(instance, "the state of an FMU within cannot be saved");
    return OK;
}

Status core_load(Instance *instance, const void *state) {
    const Saved *saved = state;
    if (!instance->within && refresh_states(instance) != OK) return ERROR; /* so that there are FMUs */
    if (core_restore(instance, &saved->state) != OK) return ERROR;
    Coupled *c = instance->within;
    c->course = saved->course;
    memcpy(c->given, saved->given, sizeof c->given);
    memcpy(c->image + IMAGE_CHANGING, saved->changing, sizeof saved->changing);
    for (int i = 0; i < N_WITHIN; i++)
        if (fmu_of(i)->set_state(c->component[i], saved->of[i]) > 1) {
            c->course.broken = 1;
            return core_fail(instance, "the state of an FMU within cannot be restored");
        }
    return OK;
}

void core_free_state(Instance *instance, void *state) {
    Saved *saved = state;
    Coupled *c = instance->within;
    for (int i = 0; c && i < N_WITHIN; i++)
        if (saved->of[i]) fmu_of(i)->free_state(c->component[i], &saved->of[i]);
    free(saved);
}

/* As bytes: all but the last member, then by FMU the number of its bytes and these. */
Status core_packed_size(Instance *instance, const void *state, size_t *size) {
    const Saved *saved = state;
    Coupled *c = instance->within;
    *size = PLAIN;
    for (int i = 0; i < N_WITHIN; i++) {
        size_t own;
        if (fmu_of(i)->packed_size(c->component[i], saved->of[i], &own) > 1)
            return core_fail(instance, "the state of an FMU within has no bytes");
        *size += sizeof(uint64_t) + own;
    }
    return OK;
}

Status core_pack(Instance *instance, const void *state, void *bytes) {
    const Saved *saved = state;
    Coupled *c = instance->within;
    char *next = bytes;
    memcpy(next, saved, PLAIN);
    next += PLAIN;
    for (int i = 0; i < N_WITHIN; i++) {
        size_t own;
        if (fmu_of(i)->packed_size(c->component[i], saved->of[i], &own) > 1 ||
            fmu_of(i)->pack(c->component[i], saved->of[i], next + sizeof(uint64_t), own) > 1)
            return core_fail(instance, "the state of an FMU within cannot be written as bytes");
        uint64_t count = own;
        memcpy(next, &count, sizeof count);
        next += sizeof count + own;
    }
    return OK;
}

static Status read_all(Instance *instance, Saved *saved, const char *bytes, size_t size) {
    Coupled *c = instance->within;
    const char *next = bytes + PLAIN, *end = bytes + size;
    for (int i = 0; i < N_WITHIN; i++) {
        uint64_t own;
        if ((size_t)(end - next) < sizeof own) return core_fail(instance, "these bytes are too few for a state");
        memcpy(&own, next, sizeof own);
        next += sizeof own;
        if ((uint64_t)(end - next) < own || fmu_of(i)->unpack(c->component[i], next, (size_t)own, &saved->of[i]) > 1)
            return core_fail(instance, "these bytes are a damaged state of an FMU within");
        next += own;
    }
    const Course *at = &saved->course;
    int inside = at->row >= at->first && at->row - at->first < ROWS && at->step > 0.0;
    return inside && next == end ? core_check_state(instance, &saved->state)
                                 : core_fail(instance, "these bytes are a damaged state");
}

Status core_unpack(Instance *instance, const void *bytes, size_t size, void **state) {
    if (size < PLAIN) return core_fail(instance, "these bytes are no state of this FMU");
    if (!instance->within && refresh_states(instance) != OK) return ERROR;
    Saved *saved = calloc(1, sizeof *saved);
    if (!saved) return core_fail(instance, "not enough memory for a state");
    memcpy(saved, bytes, PLAIN);
    if (read_all(instance, saved, bytes, size) != OK) {
        core_free_state(instance, saved);
        return ERROR;
    }
    if (*state) core_free_state(instance, *state);
    *state = saved;
    return OK;
}
