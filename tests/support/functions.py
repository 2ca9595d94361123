"""Names of all functions that a library exports, by version of FMI."""

from __future__ import annotations

import re
from pathlib import Path

import fmpy

FMI2_FUNCTIONS = (
    "GetTypesPlatform",
    "GetVersion",
    "SetDebugLogging",
    "Instantiate",
    "FreeInstance",
    "SetupExperiment",
    "EnterInitializationMode",
    "ExitInitializationMode",
    "Terminate",
    "Reset",
    "GetReal",
    "GetInteger",
    "GetBoolean",
    "GetString",
    "SetReal",
    "SetInteger",
    "SetBoolean",
    "SetString",
    "GetFMUstate",
    "SetFMUstate",
    "FreeFMUstate",
    "SerializedFMUstateSize",
    "SerializeFMUstate",
    "DeSerializeFMUstate",
    "GetDirectionalDerivative",
    "EnterEventMode",
    "NewDiscreteStates",
    "EnterContinuousTimeMode",
    "CompletedIntegratorStep",
    "SetTime",
    "SetContinuousStates",
    "GetDerivatives",
    "GetEventIndicators",
    "GetContinuousStates",
    "GetNominalsOfContinuousStates",
    "SetRealInputDerivatives",
    "GetRealOutputDerivatives",
    "DoStep",
    "CancelStep",
    "GetStatus",
    "GetRealStatus",
    "GetIntegerStatus",
    "GetBooleanStatus",
    "GetStringStatus",
)

HEADER = Path(fmpy.__file__).parent / "c-code" / "fmi3Functions.h"
"""The standard's own header, as FMPy ships it."""

FUNCTIONS = {
    "2.0": {f"fmi2{name}" for name in FMI2_FUNCTIONS},
    "3.0": set(
        re.findall(r"^FMI3_Export\s+fmi3\w+TYPE\s+(fmi3\w+);", HEADER.read_text(), re.MULTILINE)
    ),
}
