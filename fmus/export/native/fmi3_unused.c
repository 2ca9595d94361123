/* FMI 3.0: the functions for what this FMU does not have. */
#include "fmi3.h"

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter" /* such a function looks at nothing it is given */
#endif

/* Structural parameters are what these modes are for. */
EXPORT(fmi3Status, fmi3EnterConfigurationMode)(fmi3Instance c) {
    return slave_refuse(c, "this FMU has no structural parameters to configure");
}

EXPORT(fmi3Status, fmi3ExitConfigurationMode)(fmi3Instance c) {
    return slave_refuse(c, "this FMU has no structural parameters to configure");
}

#define NO_VARIABLES(name, type)                                                                             \
    EXPORT(fmi3Status, fmi3Get##name)(fmi3Instance c, const fmi3ValueReference vr[], size_t count, type value[], \
                                      size_t value_count) {                                                  \
        (void)vr, (void)value, (void)value_count;                                                            \
        return c && count == 0 ? OK : slave_refuse(c, "this FMU has no variables of type " #name);           \
    }                                                                                                        \
    EXPORT(fmi3Status, fmi3Set##name)(fmi3Instance c, const fmi3ValueReference vr[], size_t count,           \
                                      const type value[], size_t value_count) {                              \
        (void)vr, (void)value, (void)value_count;                                                            \
        return c && count == 0 ? OK : slave_refuse(c, "this FMU has no variables of type " #name);           \
    }
NO_VARIABLES(Float32, float)
NO_VARIABLES(Int8, int8_t)
NO_VARIABLES(UInt8, uint8_t)
NO_VARIABLES(Int16, int16_t)
NO_VARIABLES(UInt16, uint16_t)
NO_VARIABLES(UInt32, uint32_t)
NO_VARIABLES(UInt64, uint64_t)
NO_VARIABLES(String, fmi3String)

#define NOT_OFFERED(name, what, ...)                                        \
    EXPORT(fmi3Status, fmi3##name)(fmi3Instance c, ##__VA_ARGS__) {         \
        return slave_refuse(c, "this FMU has no " what); \
    }
#define REFERENCES const fmi3ValueReference vr[], size_t count
NOT_OFFERED(GetBinary, "binary variables", REFERENCES, size_t size[], fmi3Binary value[], size_t value_count)
NOT_OFFERED(SetBinary, "binary variables", REFERENCES, const size_t size[], const fmi3Binary value[], size_t value_count)
NOT_OFFERED(GetClock, "clocks", REFERENCES, fmi3Clock value[])
NOT_OFFERED(SetClock, "clocks", REFERENCES, const fmi3Clock value[])
NOT_OFFERED(GetIntervalDecimal, "clocks", REFERENCES, fmi3Float64 interval[], int qualifier[])
NOT_OFFERED(GetIntervalFraction, "clocks", REFERENCES, uint64_t counter[], uint64_t resolution[], int qualifier[])
NOT_OFFERED(GetShiftDecimal, "clocks", REFERENCES, fmi3Float64 shift[])
NOT_OFFERED(GetShiftFraction, "clocks", REFERENCES, uint64_t counter[], uint64_t resolution[])
NOT_OFFERED(SetIntervalDecimal, "clocks", REFERENCES, const fmi3Float64 interval[])
NOT_OFFERED(SetIntervalFraction, "clocks", REFERENCES, const uint64_t counter[], const uint64_t resolution[])
NOT_OFFERED(SetShiftDecimal, "clocks", REFERENCES, const fmi3Float64 shift[])
NOT_OFFERED(SetShiftFraction, "clocks", REFERENCES, const uint64_t counter[], const uint64_t resolution[])
NOT_OFFERED(ActivateModelPartition, "model partitions", fmi3ValueReference clock, fmi3Float64 time)
