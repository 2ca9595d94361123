"""Studies of the hopper car and of its blocks: each a function, a command and a file of its own.

from tracktrain.studies.track import track
outcome = track(spectrum="fra4", seed=7)
outcome.tables["rms"]
"""

from __future__ import annotations

STUDIES = {
    "response": "Response to irregular track, with spectra (Figures 6-1 to 6-6)",
    "hunting": "Nonlinear hunting, limit cycle against speed (Figures 7-1 to 7-12)",
    "hunting-causes": "What turns the hunting: factors alone and in pairs, beside the field",
    "stability": "Eigenvalues of the linearised car against speed (Figures 7-14 to 7-16)",
    "sensitivity": "What drives the hunting: derivatives of growth and critical speed",
    "uncertainty": "How certain: bands, what they come from, what to measure (Sobol's indices)",
    "safety": "Limits against speed, curve, load and profiles; critical speed by conicity",
    "carbody-survey": "Carbody on air springs: modal survey (Table 4-1, Figures 4-8, 4-9)",
    "structure": "Carbody by finite elements: modes, survey, scaling, FMU, car (Tables 4-2 to 4-4)",
    "truck-hysteresis": "Truck on a rig: loops of every element (Figure 4-20)",
    "truck-joints": "Truck of five bodies and joints beside its analog (Table 4-5, Figure 4-14)",
    "identify": "Analog parameters of a truck element from a measured loop (Table 4-5)",
    "wheelset": "Wheelset alone: Klingel's wave, critical speed of a restrained one",
    "track": "Track alone: histogram, spectrum, realisation (Figures 5-3 to 5-5)",
    "tracks": "All tracks: rms and waves over many seeds, gauge against 49 CFR 213",
}
"""Name of each study, whose module is called the same with underscores, and what it shows."""
