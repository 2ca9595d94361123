"""A carbody of one's own: from modal data or its FMU into a car, and back from a run's results."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from fmus.carbody.modal_data import ModalData
from fmus.carbody.modal_files import read_modal_data, write_modal_data
from fmus.carbody.residual import with_residual_modes
from fmus.describe.parameters import parameter_set
from fmus.errors import ParameterError
from orchestrator import Responses, System

from .changes import swapped
from .hopper import layout_of, vehicle
from .kept import keep, place_of

GRAVITY = 9.80665
"""[m/s2]"""

WEIGHT_TOLERANCE = 0.02
"""Part of the weight by which carbody and trucks may differ before it is said."""


def carbody_data(path: Path | str, car: str = "loaded") -> ModalData:
    """Modal data of a file (.toml, .csv, .fmu), ready for a block.

    A residual flexibility is in it as modes. car: of `CARS`, gives what the file does not. Raises
    fmus.ParameterError.
    """
    return with_residual_modes(read_modal_data(path, parameter_set(vehicle(car).parameters)))


def with_carbody(
    system: System, carbody: ModalData | Path | str, car: str = "loaded"
) -> tuple[System, list[str]]:
    """The car with a carbody of modal data, a file of such (.toml, .csv) or its FMU; and notes.

    The numbers of the body are those of the data, not the car's; the FMU of data is built when it
    is first asked for. car: of `CARS`, gives what a file does not. Raises fmus.ParameterError,
    HopperError for an FMU that lacks ports.
    """
    instance = layout_of(system).carbody
    if isinstance(carbody, ModalData):
        data, fmu = with_residual_modes(carbody), None
    else:
        data = carbody_data(carbody, car)
        fmu = Path(carbody) if Path(carbody).suffix.lower() == ".fmu" else None
    path = fmu or _built(data)
    write_modal_data(data, keep(path).with_suffix(".toml"))
    swap, _ = swapped(system, instance, path)
    own = replace(swap.components[instance], parameters={})
    system = replace(swap, components={**swap.components, instance: own})
    said = f"carbody {data.name}: {len(data.modes)} elastic modes, {data.frequencies.min():.4g} "
    said += f"to {data.frequencies.max():.4g} Hz; {'; '.join(data.provenance)}"
    return system, [said, *_weight(system, data)]


def _built(data: ModalData) -> Path:
    """The FMU of modal data: to build it takes CasADi and a compiler."""
    from fmus.export.carbody import carbody_fmu

    return carbody_fmu(data)


def carbody_of(dataset: Responses) -> ModalData | None:
    """Modal data of a run's carbody; None for the default one, or where they are not known here."""
    path = place_of(dataset, layout_of(dataset).carbody).with_suffix(".toml")
    try:
        return read_modal_data(path) if path.exists() else None
    except ParameterError:
        return None


def _weight(system: System, data: ModalData) -> list[str]:
    """What is to be said where the trucks are made for another weight."""
    trucks = [truck.instance for truck in layout_of(system).trucks]
    carried = [system.components[name].parameters.get("centre_plate_weight") for name in trucks]
    plain = [weight for weight in carried if isinstance(weight, float)]
    own, on_trucks = data.body.mass * GRAVITY, sum(plain)
    if len(plain) < len(trucks) or abs(own - on_trucks) <= WEIGHT_TOLERANCE * own:
        return []
    return [
        f"carbody {data.name} weighs {own / 1e3:.4g} kN, and {', '.join(trucks)} carry "
        f"{on_trucks / 1e3:.4g} kN (centre_plate_weight); take another --car, or set "
        "the trucks' centre_plate_weight and axle_load"
    ]
