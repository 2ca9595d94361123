"""The hopper car as a system: every port is driven once, by the body that it belongs to."""

from __future__ import annotations

import pytest

from fmus import BLOCKS
from orchestrator import OrchestratorError
from tracktrain.car.changes import connected_ports
from tracktrain.car.hopper import CARS, HOPPER, TRACKS, hopper_car
from tracktrain.errors import HopperError


def test_every_input_but_the_speed_is_driven_exactly_once() -> None:
    targets = [connection.target for connection in hopper_car().connections]
    expected = {
        f"{instance}.{port.name}"
        for instance, block in HOPPER.blocks.items()
        for port in BLOCKS[block].inputs
        if not port.optional or "rail_az" in port.name
    }
    assert len(targets) == len(set(targets)) == 84
    assert set(targets) == expected - {"track.speed"}


def test_actions_and_reactions_meet_at_every_power_bond() -> None:
    """Two trucks with four bonds each at the centre plate, four wheelsets with two each."""
    car = hopper_car()
    assert car.bonds is not None
    assert len(car.bonds) == 16
    driven_by = {c.source: c.target for c in car.connections}
    for bond in car.bonds:
        body, truck = driven_by[bond.force], driven_by[bond.velocity]
        assert bond.velocity.startswith(body.partition(".")[0])
        assert bond.force.startswith(truck.partition(".")[0])


def test_each_axle_has_its_own_place_on_the_track() -> None:
    source = {c.target: c.source for c in hopper_car().connections}
    axle_of = {"wheelset_11": 1, "wheelset_12": 2, "wheelset_21": 3, "wheelset_22": 4}
    for wheelset, axle in axle_of.items():
        assert source[f"{wheelset}.rail_y_left"] == f"track.axle[{axle}].rail_y_left"
    assert source["truck_rear.axle[1].rail_z_right"] == "track.axle[3].rail_z_right"
    assert source["truck_rear.axle[2].force_y"] == "wheelset_22.force_y"


@pytest.mark.parametrize("car", CARS)
def test_blocks_of_one_car_agree_on_what_they_share(car: str) -> None:
    components = hopper_car(car).components
    for name in ("half_wheelbase", "half_truck_spacing", "half_contact_spacing", "axle_load"):
        values = {c.parameters[name] for c in components.values() if name in c.parameters}
        assert len(values) == 1


def test_empty_car_is_lighter_and_report_linear_has_no_flange() -> None:
    loaded, empty, linear = (hopper_car(car).components for car in CARS)
    mass = [float(c["carbody"].parameters["body_mass"]) for c in (loaded, empty, linear)]
    assert mass == pytest.approx([201_000 * 0.45359237, 41_000 * 0.45359237, mass[0]])
    assert linear["wheelset_11"].parameters["flange_stiffness"] == 0.0
    assert float(loaded["wheelset_11"].parameters["flange_stiffness"]) > 0.0


def test_tracks_of_the_command_are_the_spectra_of_the_block() -> None:
    (spectrum,) = (p for p in BLOCKS["track"].parameters if p.name == "spectrum")
    assert [track.replace("-", "_") for track in TRACKS] == list(spectrum.choices)


def test_ports_that_a_stand_in_needs_are_those_that_are_connected() -> None:
    assert connected_ports(hopper_car(), "wheelset_11") == {
        *("y", "yaw", "vy", "wz", "speed", "load_left", "load_right"),
        *("rail_y_left", "rail_y_right", "force_y", "moment_z"),
    }


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"car": "lodaed"}, "there is no car 'lodaed'; did you mean loaded? choose one of: loaded"),
        (
            {"track": "fra7"},
            "there is no track 'fra7'; did you mean fra6 or fra5 or fra4? choose one of: report",
        ),
        ({"speed": 0.0}, "a speed of 0 m/s cannot be run; give one above zero"),
        ({"speed": float("nan")}, "a speed of nan m/s cannot be run; give one above zero"),
    ],
)
def test_car_that_does_not_exist_is_refused(arguments: dict[str, str], message: str) -> None:
    with pytest.raises(HopperError) as error:
        hopper_car(**arguments)  # type: ignore[arg-type]
    assert message in str(error.value)


def test_speed_may_be_text_with_a_unit() -> None:
    assert hopper_car(speed="60 ft/s") == hopper_car(speed=18.288)
    with pytest.raises(OrchestratorError, match="speed cannot be '60': the unit is missing"):
        hopper_car(speed="60")
    with pytest.raises(HopperError, match="there is no car '3'"):
        hopper_car(3)  # type: ignore[arg-type]
